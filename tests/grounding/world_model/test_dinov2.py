"""The published state dict of DINOv2's ViT-S/14 loads as it is, and the network computes what its formulas say."""

import math

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from grounding.world_model.dinov2 import PLACE, VisionTransformer
from grounding.world_model.encoder import encoder
from onto_compiler.problems import OntoError

WIDTH, DEPTH, HEADS, GRID = 384, 12, 6, 37


def layout():
    """Names and shapes of ``dinov2_vits14_pretrain.pth``, in its order."""
    shapes = {
        "cls_token": (1, 1, WIDTH),
        "pos_embed": (1, 1 + GRID * GRID, WIDTH),
        "mask_token": (1, WIDTH),
        "patch_embed.proj.weight": (WIDTH, 3, 14, 14),
        "patch_embed.proj.bias": (WIDTH,),
    }
    for index in range(DEPTH):
        name = f"blocks.{index}"
        shapes |= {
            f"{name}.norm1.weight": (WIDTH,),
            f"{name}.norm1.bias": (WIDTH,),
            f"{name}.attn.qkv.weight": (3 * WIDTH, WIDTH),
            f"{name}.attn.qkv.bias": (3 * WIDTH,),
            f"{name}.attn.proj.weight": (WIDTH, WIDTH),
            f"{name}.attn.proj.bias": (WIDTH,),
            f"{name}.ls1.gamma": (WIDTH,),
            f"{name}.norm2.weight": (WIDTH,),
            f"{name}.norm2.bias": (WIDTH,),
            f"{name}.mlp.fc1.weight": (4 * WIDTH, WIDTH),
            f"{name}.mlp.fc1.bias": (4 * WIDTH,),
            f"{name}.mlp.fc2.weight": (WIDTH, 4 * WIDTH),
            f"{name}.mlp.fc2.bias": (WIDTH,),
            f"{name}.ls2.gamma": (WIDTH,),
        }
    return shapes | {"norm.weight": (WIDTH,), "norm.bias": (WIDTH,)}


def stated_again(weights, pictures):
    """Normalised last tokens (B, 1 + P, WIDTH), written out from the formulas of the paper, one head at a time."""
    side = pictures.shape[1] // 14
    mean, deviation = torch.tensor([0.485, 0.456, 0.406]), torch.tensor([0.229, 0.224, 0.225])
    values = (torch.from_numpy(pictures).double() / 255 - mean.double()) / deviation.double()
    kernel = weights["patch_embed.proj.weight"].permute(2, 3, 1, 0).reshape(-1, WIDTH)
    cut = values.reshape(-1, side, 14, side, 14, 3).permute(0, 1, 3, 2, 4, 5).reshape(-1, side * side, 14 * 14 * 3)
    patches = cut @ kernel + weights["patch_embed.proj.bias"]
    grid = weights["pos_embed"][0, 1:].reshape(GRID, GRID, WIDTH)
    places = grid if side == GRID else resampled(resampled(grid, side).transpose(0, 1), side).transpose(0, 1)
    tokens = torch.cat([weights["cls_token"][0].expand(len(patches), 1, -1), patches], dim=1)
    tokens = tokens + torch.cat([weights["pos_embed"][0, :1], places.reshape(-1, WIDTH)])

    def normalised(tokens, name):
        centred = tokens - tokens.mean(-1, keepdim=True)
        scaled = centred / torch.sqrt((centred**2).mean(-1, keepdim=True) + 1e-6)
        return scaled * weights[f"{name}.weight"] + weights[f"{name}.bias"]

    def layer(tokens, name):
        return tokens @ weights[f"{name}.weight"].T + weights[f"{name}.bias"]

    head = WIDTH // HEADS
    for index in range(DEPTH):
        name = f"blocks.{index}"
        three = layer(normalised(tokens, f"{name}.norm1"), f"{name}.attn.qkv")
        found = []
        for first in range(0, WIDTH, head):
            query, key, value = (three[..., part + first : part + first + head] for part in (0, WIDTH, 2 * WIDTH))
            found.append(torch.softmax(query @ key.transpose(1, 2) / math.sqrt(head), dim=-1) @ value)
        tokens = tokens + weights[f"{name}.ls1.gamma"] * layer(torch.cat(found, dim=-1), f"{name}.attn.proj")
        hidden = layer(normalised(tokens, f"{name}.norm2"), f"{name}.mlp.fc1")
        hidden = hidden * 0.5 * (1 + torch.erf(hidden / math.sqrt(2)))
        tokens = tokens + weights[f"{name}.ls2.gamma"] * layer(hidden, f"{name}.mlp.fc2")
    return normalised(tokens, "norm")


def resampled(rows, count):
    """``rows`` (GRID, ...) at ``count`` places, by Keys' cubic with a = -0.75, edges repeated; places as upstream's."""
    step = GRID / (count + 0.1)

    def weight(distance):
        near, far, a = abs(distance), abs(distance), -0.75
        if near <= 1:
            return (a + 2) * near**3 - (a + 3) * near**2 + 1
        return a * far**3 - 5 * a * far**2 + 8 * a * far - 4 * a if far < 2 else 0.0

    found = []
    for index in range(count):
        place = (index + 0.5) * step - 0.5
        around = range(math.floor(place) - 1, math.floor(place) + 3)
        found.append(sum(weight(place - each) * rows[min(max(each, 0), GRID - 1)] for each in around))
    return torch.stack(found)


@pytest.fixture(scope="module")
def weights():
    generator = torch.Generator().manual_seed(0)
    made = {name: 0.05 * torch.randn(shape, generator=generator) for name, shape in layout().items()}
    for name in made:  # scales near one, so that every part has its say in the result
        if name.endswith(("norm1.weight", "norm2.weight", "norm.weight", "gamma")):
            made[name] += 1
    return made


@pytest.fixture(scope="module")
def file(weights, tmp_path_factory):
    path = tmp_path_factory.mktemp("weights") / "dinov2_vits14_pretrain.pth"
    torch.save(weights, path)
    return path


@pytest.fixture(scope="module")
def pictures():
    return np.random.default_rng(0).integers(0, 256, (2, 42, 42, 3), dtype=np.uint8)


def test_the_network_has_the_names_and_shapes_of_the_published_file():
    mine = {name: tuple(value.shape) for name, value in VisionTransformer().state_dict().items()}
    assert mine == layout()
    assert len(mine) == 175


@pytest.mark.parametrize("folder", [False, True])
def test_features_are_what_the_formulas_say(monkeypatch, weights, file, pictures, folder):
    monkeypatch.setenv(PLACE, str(file.parent if folder else file))
    expected = stated_again({name: value.double() for name, value in weights.items()}, pictures).numpy()
    patch, token = encoder("dinov2:42"), encoder("dinov2:cls:42")
    assert (patch.name, patch.shape) == ("dinov2:patch:42", (3, 3, WIDTH))
    assert (token.name, token.shape) == ("dinov2:cls:42", (WIDTH,))
    assert np.allclose(patch.encode(pictures), expected[:, 1:].reshape(2, -1), atol=2e-4)
    assert np.allclose(token.encode(pictures), expected[:, 0], atol=2e-4)


def test_positions_at_the_size_of_the_training_are_those_of_the_file(weights):
    network = VisionTransformer()
    network.load_state_dict(weights)
    assert torch.equal(network.positions(GRID), weights["pos_embed"])


@pytest.mark.parametrize("side", [1, 14, 36])
def test_positions_are_interpolated_as_upstream_interpolates_them(weights, side):
    network = VisionTransformer()
    network.load_state_dict(weights)
    grid = weights["pos_embed"][0, 1:].reshape(GRID, GRID, WIDTH).double()
    expected = resampled(resampled(grid, side).transpose(0, 1), side).transpose(0, 1)
    found = network.positions(side)
    assert found.shape == (1, 1 + side * side, WIDTH)
    assert torch.equal(found[:, 0], weights["pos_embed"][:, 0])
    assert torch.allclose(found[0, 1:].double(), expected.reshape(-1, WIDTH), atol=1e-4)


def test_the_size_is_dino_wms_unless_it_is_named(monkeypatch, file):
    monkeypatch.setenv(PLACE, str(file))
    found = encoder("dinov2")
    assert (found.name, found.size, found.shape) == ("dinov2:patch:196", 196, (14, 14, WIDTH))


def test_a_safetensors_file_serves_as_well(monkeypatch, weights, file, pictures, tmp_path):
    path = tmp_path / "dinov2_vits14_pretrain.safetensors"
    save_file(weights, path)
    found = []
    for place in (file, tmp_path):
        monkeypatch.setenv(PLACE, str(place))
        found.append(encoder("dinov2:cls:14"))
    assert found[0].identity == found[1].identity
    small = np.ascontiguousarray(pictures[:, :14, :14])
    assert np.array_equal(found[0].encode(small), found[1].encode(small))


def test_weights_in_the_cache_are_found_without_a_word(monkeypatch, weights, tmp_path):
    monkeypatch.delenv(PLACE, raising=False)
    monkeypatch.setattr("grounding.world_model.dinov2.cache_folder", lambda: tmp_path)
    (tmp_path / "weights").mkdir()
    save_file(weights, tmp_path / "weights" / "dinov2_vits14_pretrain.safetensors")
    assert encoder("dinov2:cls:14").shape == (WIDTH,)


def test_without_weights_the_error_says_where_to_get_them(monkeypatch, tmp_path):
    for place in (tmp_path / "none.pth", tmp_path):
        monkeypatch.setenv(PLACE, str(place))
        with pytest.raises(OntoError) as error:
            encoder("dinov2")
        (problem,) = error.value.problems
        assert problem.code == "WM008"
        assert str(place) in problem.message
        assert "dinov2_vits14_pretrain.pth" in problem.hint
        assert PLACE in problem.hint
    monkeypatch.delenv(PLACE)
    monkeypatch.setattr("grounding.world_model.dinov2.cache_folder", lambda: None)
    with pytest.raises(OntoError, match="WM008"):
        encoder("dinov2")


def test_weights_of_a_larger_model_are_refused_by_name(monkeypatch, weights, tmp_path):
    path = tmp_path / "dinov2_vitb14_pretrain.pth"
    torch.save({**weights, "cls_token": torch.zeros(1, 1, 768)}, path)
    monkeypatch.setenv(PLACE, str(path))
    with pytest.raises(
        OntoError, match=r"`cls_token` is float32 \(1, 1, 768\), float32 \(1, 1, 384\) expected"
    ) as error:
        encoder("dinov2")
    assert [problem.code for problem in error.value.problems] == ["WM004"]


@pytest.mark.parametrize("name", ["dinov2:64", "dinov2:0", "dinov2:528", "dinov2:tokens"])
def test_sizes_that_are_no_whole_patches_are_refused(monkeypatch, file, name):
    monkeypatch.setenv(PLACE, str(file))
    with pytest.raises(OntoError, match="is not an option of the encoder `dinov2`") as error:
        encoder(name)
    assert "14, 28, … 518 pixels" in error.value.problems[0].hint
