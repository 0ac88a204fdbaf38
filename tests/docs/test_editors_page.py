"""The page about editors lists what the server can do, and its settings are what the programs read."""

import json
import re
import shutil
import tomllib
from pathlib import Path

import pytest

from onto_compiler.command import Command
from onto_compiler.lsp.client import Client
from onto_compiler.lsp.command import LSP

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/editors.md").read_text()
ABILITIES = {
    "quick fixes": "codeActionProvider",
    "completion": "completionProvider",
    "hover": "hoverProvider",
    "definition": "definitionProvider",
    "references": "referencesProvider",
    "rename": "renameProvider",
    "symbols": "workspaceSymbolProvider",
    "semantic tokens": "semanticTokensProvider",
    "formatting": "documentFormattingProvider",
}


def block(language):
    return re.search(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)[1]


def test_the_table_lists_what_the_server_says_that_it_can():
    pytest.importorskip("pygls")
    with Client() as client:
        said = {name for name, given in client.capabilities.items() if name.endswith("Provider")}
    rows = re.findall(r"(?m)^\| ([a-z][a-z ]+?) \|", PAGE)
    assert rows == ["problems", *ABILITIES]
    of_pygls = {"executeCommandProvider"}  # of no command
    assert said - of_pygls == {*ABILITIES.values(), "documentSymbolProvider"}


def test_helix_is_given_a_server_for_both_languages():
    settings = tomllib.loads(block("toml"))
    server = settings["language-server"]["onto"]
    assert [server["command"], *server["args"]] == ["onto", LSP.name]
    assert isinstance(LSP, Command)
    for language, ending in zip(settings["language"], ("ttl", "bddl"), strict=True):
        assert (language["file-types"], language["language-servers"]) == ([ending], ["onto"])


def test_neovim_and_emacs_start_the_same_command_for_both():
    assert 'cmd = { "onto", "lsp" }' in block("lua")
    assert '"onto" "lsp"' in block("elisp")
    for text in (block("lua"), block("elisp")):
        assert {"turtle", "bddl"} <= set(re.findall(r"turtle|bddl", text))
    assert block("elisp").count("(") == block("elisp").count(")")


def test_the_extension_is_built_as_the_page_says():
    commands = re.search(r"(?s)## Visual Studio Code.*?```console\n(.*?)```", PAGE)[1].split("\n")
    scripts = json.loads((ROOT / "editors/vscode/package.json").read_text())["scripts"]
    assert commands[:3] == ["cd editors/vscode", "npm ci", "npm run package"]
    assert commands[3].split()[-1] in scripts["package"]
    for setting in re.findall(r"`(onto\.\w+)`", PAGE.replace("`onto.toml`", "")):
        assert setting in (ROOT / "editors/vscode/package.json").read_text()


def test_a_task_is_lifted_by_the_folder_that_the_page_names(tmp_path):
    from onto_compiler.lsp.siblings import ontologies_above

    ontology, task = re.search(r"\(`([\w/]+\.ttl)` for `([\w/]+\.bddl)`\)", PAGE).groups()
    for name, source in ((ontology, "served.ttl"), (task, "serve_the_cheese.bddl")):
        (tmp_path / name).parent.mkdir(parents=True)
        shutil.copy(ROOT / "docs/examples" / source, tmp_path / name)
    assert ontologies_above(tmp_path / task, tmp_path) == (tmp_path / ontology,)
