"""The extension for Visual Studio Code: its own tests, where Node is present and its packages can be had."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXTENSION = ROOT / "editors/vscode"
NEEDED = ("vscode-languageclient", "vscode-oniguruma", "vscode-textmate")  # by the tests; not what packages it
LEFT_OUT = ("node_modules", "dist", "*.vsix", "package-lock.json")
INSTALLING, TESTING = 8, 14  # s
NODE, NPM = shutil.which("node") or "", shutil.which("npm") or ""
PROGRAM = "import sys; from runtime.cli import main; sys.exit(main(sys.argv[1:]))"


def test_the_lock_file_names_no_other_place_than_the_public_registry():
    lock = json.loads((EXTENSION / "package-lock.json").read_text())
    manifest = json.loads((EXTENSION / "package.json").read_text())
    assert lock["packages"][""]["devDependencies"] == manifest["devDependencies"]
    assert len(lock["packages"]) > 100
    for name, package in lock["packages"].items():
        assert package.get("resolved", "https://registry.npmjs.org/").startswith("https://registry.npmjs.org/"), name
        assert not name or package.get("integrity"), name


def installed(folder):
    """A copy of the extension with what its tests need; None where that cannot be had."""
    copy = folder / "editors/vscode"
    shutil.copytree(EXTENSION, copy, ignore=shutil.ignore_patterns(*LEFT_OUT))
    shutil.copytree(ROOT / "docs/examples", folder / "docs/examples")
    if (EXTENSION / "node_modules").is_dir():
        (copy / "node_modules").symlink_to(EXTENSION / "node_modules")
        return copy
    manifest = json.loads((copy / "package.json").read_text())
    manifest["devDependencies"] = {name: manifest["devDependencies"][name] for name in NEEDED}
    (copy / "package.json").write_text(json.dumps(manifest))
    options = ("--no-package-lock", "--no-audit", "--no-fund", "--prefer-offline", "--fetch-retries=0")
    try:
        done = subprocess.run(
            [NPM, "install", *options], cwd=copy, timeout=INSTALLING, capture_output=True, check=False
        )
    except subprocess.TimeoutExpired:
        return None
    return copy if done.returncode == 0 else None


@pytest.mark.skipif(not (NODE and NPM), reason="Node is not installed")
def test_grammars_manifest_and_a_session_with_the_server(tmp_path):
    pytest.importorskip("pygls")
    version = subprocess.run([NODE, "--version"], capture_output=True, text=True, check=True).stdout
    if int(version[1:].partition(".")[0]) < 20:
        pytest.skip("node --test needs Node 20")
    extension = installed(tmp_path)
    if extension is None:
        pytest.skip("the packages of the tests cannot be installed here")
    program = tmp_path / "onto"
    program.write_text(f"#!/bin/sh\nexec '{sys.executable}' -c '{PROGRAM}' \"$@\"\n")
    program.chmod(0o755)
    environment = os.environ | {"ONTO": str(program), "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [NPM, "test"], cwd=extension, env=environment, capture_output=True, text=True, timeout=TESTING, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "\n# pass 11\n" in done.stdout
