from __future__ import annotations

import os
import pickle
import zipfile

import numpy as np
import pytest

from onto_compiler.problems import OntoError
from runtime.worlds.libero.simulator.state_files import load_states

STATES = np.arange(24, dtype=np.float64).reshape(4, 6) / 7


def archive(path, data, **storages):
    """A file laid out as ``torch.save`` does: NAME/data.pkl, NAME/byteorder, NAME/data/KEY."""
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("states/data.pkl", data)
        file.writestr("states/byteorder", "little")
        for key, raw in storages.items():
            file.writestr(f"states/data/{key.removeprefix('s')}", raw)
    return path


def inner(value):
    """The opcodes that push ``value``, without the frame of a whole pickle."""
    return pickle.dumps(value, 2)[2:-1]


def tensor(storage=b"ctorch\nDoubleStorage\n", offset=0, size=(4, 6), stride=(6, 1), count=24):
    """The pickle of a tensor, opcode by opcode, since torch is not there to write it."""
    persistent = b"(" + inner("storage") + storage + inner("0") + inner("cpu") + inner(count) + b"tQ"
    hooks = b"ccollections\nOrderedDict\n)R"
    arguments = b"(" + persistent + inner(offset) + inner(size) + inner(stride) + b"\x89" + hooks + b"t"
    return b"\x80\x02ctorch._utils\n_rebuild_tensor_v2\n" + arguments + b"R."


class Hostile:
    def __init__(self, target):
        self.target = target

    def __reduce__(self):
        return os.system, (f"touch {self.target}",)


def refusal(path):
    with pytest.raises(OntoError) as caught:
        load_states(path)
    (problem,) = caught.value.problems
    assert problem.code == "SIM014"
    assert problem.file == str(path)
    return problem.message


def test_reads_an_npz(tmp_path):
    np.savez_compressed(tmp_path / "a.pruned_init.npz", states=STATES)
    assert np.array_equal(load_states(tmp_path / "a.pruned_init.npz"), STATES)


@pytest.mark.parametrize("order", ["C", "F"])
def test_reads_an_array_that_torch_pickled(tmp_path, order):
    path = archive(tmp_path / "a.pruned_init", pickle.dumps(np.array(STATES, order=order), 2))
    assert np.array_equal(load_states(path), STATES)


def test_reads_a_big_endian_array(tmp_path):
    path = archive(tmp_path / "a.pruned_init", pickle.dumps(STATES.astype(">f8"), 2))
    assert np.array_equal(load_states(path), STATES)


def test_reads_an_array_as_older_numpy_named_it(tmp_path):
    data = pickle.dumps(STATES, 2).replace(b"cnumpy._core.multiarray", b"cnumpy.core.multiarray")
    assert b"numpy.core.multiarray" in data
    assert np.array_equal(load_states(archive(tmp_path / "a.pruned_init", data)), STATES)


def test_reads_a_tensor(tmp_path):
    path = archive(tmp_path / "a.pruned_init", tensor(), s0=STATES.tobytes())
    assert np.array_equal(load_states(path), STATES)


def test_reads_a_strided_float_tensor(tmp_path):
    raw = STATES.astype(np.float32)
    data = tensor(b"ctorch\nFloatStorage\n", offset=1, size=(2, 3), stride=(12, 2))
    assert np.array_equal(load_states(archive(tmp_path / "a.pruned_init", data, s0=raw.tobytes())), raw[::2, 1::2])


def test_reads_a_list_of_rows(tmp_path):
    path = archive(tmp_path / "a.pruned_init", pickle.dumps(list(STATES), 2))
    assert np.array_equal(load_states(path), STATES)


def test_refuses_a_pickle_that_calls_a_function_and_does_not_call_it(tmp_path):
    mark = tmp_path / "called"
    for value in (Hostile(mark), [Hostile(mark)], np.array([Hostile(mark)], dtype=object)):
        message = refusal(archive(tmp_path / "a.pruned_init", pickle.dumps(value, 2)))
        assert "system" in message
    assert not mark.exists()
    pickle.loads(pickle.dumps(Hostile(mark), 2))  # noqa: S301  the test's own pickle: it would have been called
    assert mark.exists()


@pytest.mark.parametrize(
    ("data", "word"),
    [
        (pickle.dumps(STATES.astype(complex), 2), "numbers"),
        (pickle.dumps(np.array(["a", "b"]), 2), "numbers"),
        (pickle.dumps(np.array([1.0, None], dtype=object), 2), "objects"),
        (pickle.dumps({"states": [1.0]}, 2), "dict"),
        (b"\x80\x02cbuiltins\neval\n.", "builtins.eval"),
        (tensor(b"ctorch\nBoolStorage\n"), "torch.BoolStorage"),
        (tensor(size=(4, 7)), "outside"),
        (tensor(offset=-1), "outside"),
        (tensor(stride=(6, -1)), "outside"),
        (b"no pickle", "refused"),
        (b"", "refused"),
    ],
)
def test_refuses_anything_but_numbers(tmp_path, data, word):
    assert word in refusal(archive(tmp_path / "a.pruned_init", data, s0=STATES.tobytes()))


def test_refuses_values_that_are_not_finite(tmp_path):
    states = STATES.copy()
    states[1, 1] = np.nan
    assert "finite" in refusal(archive(tmp_path / "a.pruned_init", pickle.dumps(states, 2)))


def test_refuses_a_file_that_is_no_archive(tmp_path):
    (tmp_path / "a.pruned_init").write_bytes(pickle.dumps(STATES, 2))
    refusal(tmp_path / "a.pruned_init")


def test_refuses_an_npz_with_other_arrays(tmp_path):
    np.savez(tmp_path / "a.npz", qpos=STATES)
    assert "qpos" in refusal(tmp_path / "a.npz")
