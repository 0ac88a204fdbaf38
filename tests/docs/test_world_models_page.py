"""The programs of docs/world_models.md print what the page shows, and its table lists what is registered."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from grounding.world_model import encoder as registry
from grounding.world_model.encoder import encoder, registered

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/world_models.md").read_text()
EXAMPLES = re.findall(r"(?s)```python\n(.*?)```\n\n```text\n(.*?)```", PAGE)


def test_the_page_has_its_examples():
    assert len(EXAMPLES) == len(re.findall("```python", PAGE)) == 4


@pytest.mark.parametrize(("program", "printed"), EXAMPLES)
def test_an_example_prints_what_the_page_shows(program, printed, tmp_path):
    path = tmp_path / "example.py"
    path.write_text(program)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, path], capture_output=True, text=True, check=False, cwd=tmp_path, env=environment
    )
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout == printed


def test_the_table_lists_the_packaged_encoders_with_their_sizes():
    rows = re.findall(r"^\| `(\w+)\[.*\| (\d+) \| [^|]*\|$", PAGE, re.MULTILINE)
    ours = {name for name, point in registered().items() if point.value.startswith("grounding.")}
    assert {name for name, _ in rows} == ours
    assert {name: size for name, size in rows if name != "dinov2"} == {
        name: str(encoder(name).size) for name in ours - {"dinov2"}
    }


def test_an_encoder_registered_as_the_page_says_is_found(tmp_path, monkeypatch):
    (block,) = re.findall(r"(?s)```toml\n(.*?)```", PAGE)
    ((name, place),) = tomllib.loads(block)["project"]["entry-points"][registry.GROUP].items()
    module = place.partition(":")[0].split(".")
    folder = tmp_path.joinpath(*module[:-1])
    folder.mkdir(parents=True)
    (folder / f"{module[-1]}.py").write_text(EXAMPLES[-1][0])
    (tmp_path / "my_package-1.dist-info").mkdir()
    (tmp_path / "my_package-1.dist-info" / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: my_package\nVersion: 1\n"
    )
    (tmp_path / "my_package-1.dist-info" / "entry_points.txt").write_text(f"[{registry.GROUP}]\n{name} = {place}\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    registered.cache_clear()
    try:
        assert encoder(f"{name}:32").shape == (32,)
    finally:
        registered.cache_clear()
        sys.modules.pop(".".join(module), None)
