"""A checkpoint comes back as it was saved, or with an error that says what is wrong with it."""

import json
import stat
import struct

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.torch import save_file

from grounding.world_model import checkpoint
from grounding.world_model.checkpoint import Card, checksum, load, read_card, restore, save
from onto_compiler.problems import OntoError


def line(width):
    """A network of one layer that maps 3 numbers to ``width``."""
    return torch.nn.Sequential(torch.nn.Linear(3, width))


CARD = Card(
    "line",
    {"width": 4},
    encoder="pixels",
    facts=("at_target", "free_of"),
    data={"trajectories": 2000},
    sees="pixels",
    seed=7,
    command="onto train line --seed 7",
    commit="0" * 40,
    metrics={"error_m": 0.25},
)


@pytest.fixture
def saved(tmp_path):
    torch.manual_seed(0)
    module = line(4)
    path = tmp_path / "deep" / "line.safetensors"
    save(path, module.state_dict(), CARD)
    return path, module


def codes(error):
    return [problem.code for problem in error.value.problems]


def rewritten(path, change):
    """Replace the header of ``path`` by what ``change`` makes of it."""
    data = path.read_bytes()
    (length,) = struct.unpack_from("<Q", data)
    header = json.loads(data[8 : 8 + length])
    about = json.loads(header["__metadata__"]["onto-evwm"])
    change(about)
    header["__metadata__"]["onto-evwm"] = json.dumps(about)
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 8)
    path.write_bytes(struct.pack("<Q", len(text)) + text + data[8 + length :])


def test_weights_and_card_come_back_as_they_were_saved(saved):
    path, module = saved
    found = load(path, "line")
    assert found.card == CARD == read_card(path)
    assert set(found.tensors) == {"0.weight", "0.bias"}
    assert all(torch.equal(found.tensors[name], value) for name, value in module.state_dict().items())
    assert found.identity == checksum(module.state_dict())


def test_a_restored_network_is_frozen_and_computes_the_same(saved):
    path, module = saved
    again, found = restore(path, "line", line)
    given = torch.arange(6.0).reshape(2, 3)
    assert torch.equal(again(given), module(given))
    assert not again.training
    assert not any(weight.requires_grad for weight in again.parameters())
    assert found.card.metrics == {"error_m": 0.25}


def test_the_same_weights_and_card_make_the_same_bytes_and_leave_nothing_else(saved, tmp_path):
    path, module = saved
    first = path.read_bytes()
    save(path, module.state_dict(), CARD)
    assert path.read_bytes() == first
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_views_and_networks_of_several_types_are_saved(tmp_path):
    tensors = {
        "turned": torch.arange(6.0).reshape(2, 3).T,
        "half": torch.ones(2, dtype=torch.float16),
        "brain": torch.ones(2, dtype=torch.bfloat16),
        "count": torch.tensor(3),
        "mask": torch.tensor([True, False]),
        "none": torch.zeros(0, 3),
    }
    tensors |= {"first": tensors["half"][:1], "tied": tensors["half"]}
    save(tmp_path / "mixed.safetensors", tensors, Card("mixed"))
    found = load(tmp_path / "mixed.safetensors", "mixed").tensors
    assert set(found) == set(tensors)
    assert all(torch.equal(found[name], value) and found[name].dtype == value.dtype for name, value in tensors.items())


def test_any_change_of_a_weight_changes_the_identity():
    one = {"a": torch.zeros(2, 3), "b": torch.zeros(6)}
    others = [
        {"a": torch.zeros(3, 2), "b": torch.zeros(6)},
        {"a": torch.zeros(2, 3), "c": torch.zeros(6)},
        {"a": torch.zeros(2, 3), "b": torch.zeros(6, dtype=torch.float64)},
        {"a": torch.zeros(2, 3), "b": torch.zeros(6) - 0.0},
        {"a": torch.zeros(2, 3), "b": torch.full((6,), 1e-30)},
    ]
    assert len({checksum(tensors) for tensors in [one, *others]}) == 5  # subtracting zero changes nothing


@settings(max_examples=200, deadline=None)
@given(data=st.binary(max_size=200), length=st.integers(0, 2**64 - 1), header=st.text(max_size=60))
def test_whatever_the_bytes_there_is_an_error_and_no_traceback(tmp_path_factory, data, length, header):
    path = tmp_path_factory.getbasetemp() / "any.safetensors"
    text = header.encode()
    for whole in (data, struct.pack("<Q", length) + data, struct.pack("<Q", len(text)) + text + data):
        path.write_bytes(whole)
        with pytest.raises(OntoError) as error:
            load(path, "line")
        assert codes(error) == ["WM002"]


def test_a_missing_file_is_said_to_be_missing(tmp_path):
    with pytest.raises(OntoError, match="there is no checkpoint here") as error:
        load(tmp_path / "none.safetensors", "line")
    assert codes(error) == ["WM001"]
    assert error.value.problems[0].file == str(tmp_path / "none.safetensors")


def test_a_folder_is_no_checkpoint(tmp_path):
    with pytest.raises(OntoError) as error:
        load(tmp_path, "line")
    assert codes(error) == ["WM001"]


@pytest.mark.parametrize("kept", [0, 5, 8, 40, 200, -1])
def test_a_file_that_was_cut_off_is_damaged(saved, kept):
    path, _ = saved
    path.write_bytes(path.read_bytes()[:kept])
    with pytest.raises(OntoError) as error:
        load(path, "line")
    assert codes(error) == ["WM002"]


def test_every_flipped_bit_is_found(saved):
    path, _ = saved
    whole = path.read_bytes()
    found = []
    for place in range(0, len(whole), 3):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        with pytest.raises(OntoError) as error:
            load(path, "line")
        found += codes(error)
    assert len(found) > 200
    assert set(found) == {"WM002", "WM003"}  # in the name of the architecture, it is another one


@pytest.mark.parametrize("text", [b"", b"not a checkpoint at all", b"\x80\x04\x95" + b"x" * 100])
def test_other_files_are_no_checkpoints(tmp_path, text):
    path = tmp_path / "other.safetensors"
    path.write_bytes(text)
    with pytest.raises(OntoError) as error:
        read_card(path)
    assert codes(error) == ["WM002"]


def test_weights_without_a_card_are_no_checkpoint(tmp_path):
    path = tmp_path / "bare.safetensors"
    save_file({"a": torch.zeros(2)}, path)
    with pytest.raises(OntoError, match="no model card") as error:
        load(path, "line")
    assert codes(error) == ["WM002"]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda about: about["card"].pop("facts"), "a model card has the entries"),
        (lambda about: about["card"].update(seed="seven"), "seed"),
        (lambda about: about.update(card=[]), "a model card has the entries"),
        (lambda about: about.update(sha256="0" * 64), "the header says 000000000000"),
    ],
)
def test_a_card_that_was_edited_is_damaged(saved, change, said):
    path, _ = saved
    rewritten(path, change)
    with pytest.raises(OntoError, match=said) as error:
        load(path, "line")
    assert codes(error) == ["WM002"]


def test_another_architecture_is_refused_and_the_command_that_made_it_named(saved):
    path, _ = saved
    with pytest.raises(OntoError, match="holds a `line`, where a `curve` is expected") as error:
        load(path, "curve")
    assert codes(error) == ["WM003"]
    assert "onto train line --seed 7" in error.value.problems[0].hint


def test_parameters_that_the_architecture_does_not_take_are_refused(saved):
    path, _ = saved
    with pytest.raises(OntoError, match="width") as error:
        restore(path, "line", lambda height: torch.nn.Linear(3, height))
    assert codes(error) == ["WM003"]


def test_weights_of_other_shapes_are_named_with_both_forms(saved):
    path, _ = saved
    with pytest.raises(OntoError) as error:
        load(path, "line").fill(line(5))
    assert codes(error) == ["WM004", "WM004"]
    assert "`0.weight` is float32 (4, 3), float32 (5, 3) expected" in str(error.value)


def test_weights_that_are_missing_or_left_over_are_named(saved):
    path, _ = saved
    with pytest.raises(OntoError) as error:
        load(path, "line").fill(torch.nn.Linear(3, 4))
    assert sorted(problem.message for problem in error.value.problems) == [
        "`0.bias` float32 (4,) is not part of the network",
        "`0.weight` float32 (4, 3) is not part of the network",
        "`bias` is missing, float32 (4,) expected",
        "`weight` is missing, float32 (4, 3) expected",
    ]


def test_many_differences_are_counted_not_listed(saved):
    path, _ = saved
    deep = torch.nn.Sequential(*(torch.nn.Linear(3, 3) for _ in range(20)))
    with pytest.raises(OntoError) as error:
        load(path, "line").fill(deep)
    assert len(error.value.problems) == 6
    assert "35 more weights differ" in str(error.value)


def test_numbers_of_numpy_and_metrics_that_are_undefined_become_json(tmp_path):
    card = Card(
        "line",
        {"widths": (np.int64(3), 4)},
        data={"share": np.float32(0.5)},
        metrics={"auroc": float("nan"), "error_m": np.float32(0.25), "steps": 3},
    )
    save(tmp_path / "line.safetensors", {"a": torch.zeros(1)}, card)
    found = load(tmp_path / "line.safetensors", "line").card
    assert (found.parameters, found.data) == ({"widths": [3, 4]}, {"share": 0.5})
    assert found.metrics == {"auroc": None, "error_m": 0.25, "steps": 3.0}


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_weights_that_are_not_finite_are_neither_saved_nor_loaded(tmp_path, monkeypatch, value):
    path = tmp_path / "diverged.safetensors"
    tensors = {"a": torch.zeros(2), "b": torch.tensor([1.0, value])}
    with pytest.raises(OntoError, match="`b` holds values that are not finite") as error:
        save(path, tensors, Card("line"))
    assert codes(error) == ["WM005"]
    assert not path.exists()
    with monkeypatch.context() as patch:
        patch.setattr(checkpoint, "_require_finite", lambda tensors, path: None)
        save(path, tensors, Card("line"))
    with pytest.raises(OntoError) as error:
        load(path, "line")
    assert codes(error) == ["WM005"]


def test_a_checkpoint_that_cannot_be_written_leaves_the_old_one(saved, monkeypatch):
    path, module = saved
    before = path.read_bytes()

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    with pytest.raises(OntoError, match="No space left on device") as error:
        save(path, module.state_dict(), CARD)
    assert codes(error) == ["WM006"]
    assert path.read_bytes() == before
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_a_file_in_the_place_of_the_folder_is_reported(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(OntoError) as error:
        save(tmp_path / "taken" / "line.safetensors", {"a": torch.zeros(1)}, Card("line"))
    assert codes(error) == ["WM006"]


def test_others_may_read_a_checkpoint_as_the_umask_says(saved):
    path, _ = saved
    assert stat.S_IMODE(path.stat().st_mode) & 0o600 == 0o600
    plain = path.parent / "plain"
    plain.write_text("")
    assert path.stat().st_mode == plain.stat().st_mode
