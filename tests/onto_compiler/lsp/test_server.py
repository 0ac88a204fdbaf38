"""An editor's session with a real server process."""

import shutil
from pathlib import Path

import pytest

import ontology
from onto_compiler.bddl.layout import format_text
from onto_compiler.lsp.client import Client
from onto_compiler.turtle.layout import format_turtle

pytest.importorskip("pygls")
ROOT = Path(__file__).resolve().parents[3]
SERVED = ROOT / "docs/examples/served.ttl"
TASK = ROOT / "docs/examples/serve_the_cheese.bddl"


@pytest.fixture(scope="module")
def client():
    with Client("--ontology", str(SERVED)) as running:
        yield running


@pytest.fixture
def domain(tmp_path):
    return Path(shutil.copy(SERVED, tmp_path / "served.ttl"))


@pytest.fixture
def task(tmp_path):
    return Path(shutil.copy(TASK, tmp_path / "serve_the_cheese.bddl"))


def place(text, needle, inside=0):
    offset = text.index(needle) + inside
    return text.count("\n", 0, offset), offset - text.rfind("\n", 0, offset) - 1


def codes(diagnostics):
    return sorted(d["code"] for d in diagnostics)


def settled(client, path, wanted):
    """The first diagnostics in which ``wanted`` is true, of those that come after a pause."""
    for _ in range(4):
        found = client.diagnostics(path.as_uri())
        if wanted(found):
            return found
    raise AssertionError(found)


def test_a_session_ends_as_the_protocol_says(domain):
    client = Client()
    assert client.open(domain, domain.read_text(), "turtle") == []
    assert client.close() == 0


def test_a_slip_is_shown_where_it_is_and_goes_when_it_is_mended(client, domain):
    text = domain.read_text()
    assert client.open(domain, text, "turtle") == []
    line, column = place(text, "core:marginUnit", 5)
    (found,) = client.type(domain, line, column, "x")
    assert found["code"].startswith("VOC")
    assert found["severity"] == 1
    assert "marginUnit" in found["message"]
    assert found["range"]["start"] == {"line": line, "character": column - 5}
    assert found["range"]["end"] == {"line": line, "character": column + len("xmarginUnit")}
    assert client.type(domain, line, column, "", erase=1) == []


def test_a_syntax_error_has_its_place(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    line, column = place(text, "tidy:served_on a")
    (found,) = client.type(domain, line, column, "}")
    assert found["code"].startswith("TTL")
    assert found["range"]["start"]["line"] == line


def test_places_count_in_utf16_as_clients_do(client, domain):
    text = domain.read_text().replace("core:arity ", 'skos:note "𝄞𝄞"@en ; core:arity ')
    line, _ = place(text, "skos:note")
    row = text.splitlines()[line]
    wide = row.index("core:arity") + 2  # two characters beyond the basic plane count twice
    client.open(domain, text, "turtle")
    found = next(d for d in client.type(domain, line, wide + len("core:"), "x") if "xarity" in d["message"])
    assert found["range"]["start"] == {"line": line, "character": wide}
    assert found["range"]["end"] == {"line": line, "character": wide + len("core:xarity")}


def test_what_only_the_whole_check_finds_comes_after_a_pause_and_moves_with_the_text(client, domain):
    text = domain.read_text().replace('plate that it is served on."@en', 'plate that it is served on"@en')
    client.open(domain, text, "turtle")
    found = settled(client, domain, lambda d: "DOC004" in codes(d))
    (before,) = [d["range"]["start"]["line"] for d in found if d["code"] == "DOC004"]
    at_once = client.type(domain, 0, 0, "# a line more\n")
    assert [d["range"]["start"]["line"] for d in at_once if d["code"] == "DOC004"] == [before + 1]


def test_declared_terms_are_offered_behind_a_prefix(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    line, column = place(text, "man:Object ", len("man:Ob"))
    answer = client.at("completion", domain, line, column)
    labels = [item["label"] for item in answer["items"]]
    assert labels[:2] == ["man:Object", "man:ObjectRelation"]
    edit = answer["items"][0]["textEdit"]
    assert edit["range"]["start"] == {"line": line, "character": column - len("man:Ob")}
    assert "movable" in answer["items"][0]["documentation"]


def test_terms_are_offered_while_the_buffer_is_broken(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    end = text.count("\n")
    client.type(domain, end, 0, "tidy:stacked_on a man:")
    labels = [i["label"] for i in client.at("completion", domain, end, len("tidy:stacked_on a man:"))["items"]]
    assert {"man:ObjectRelation", "man:ContactRelation"} <= set(labels)
    assert not [label for label in labels if not label.startswith("man:")]


def test_nothing_is_offered_in_a_definition(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    line, column = place(text, "Holds when food", 5)
    assert client.at("completion", domain, line, column)["items"] == []


def test_a_term_is_explained_and_found(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    line, column = place(text, "tidy:served_on a", 6)
    told = client.at("hover", domain, line, column)["contents"]["value"]
    assert "served_on(Object, Object), margin in M" in told
    assert "Holds when food" in told
    line, column = place(text, "man:ObjectRelation", 6)
    found = client.at("definition", domain, line, column)
    manipulation = ontology.ROOT / "manipulation.ttl"
    assert found["uri"] == manipulation.as_uri()
    assert manipulation.read_text().splitlines()[found["range"]["start"]["line"]].startswith("man:ObjectRelation a")


def test_what_means_nothing_is_not_explained(client, domain):
    text = domain.read_text()
    client.open(domain, text, "turtle")
    line, column = place(text, "Holds when food", 2)
    assert client.at("hover", domain, line, column) is None
    assert client.at("definition", domain, line, column) is None


def test_a_task_is_lifted_as_it_is_typed(client, task):
    text = task.read_text()
    first = client.open(task, text, "bddl")
    assert [d for d in first if d["severity"] == 1] == []
    line, column = place(text, "(Served", 1)
    found = client.type(task, line, column, "Un")
    assert [(d["code"], d["range"]["start"]) for d in found if d["severity"] == 1] == [
        ("BDDL003", {"line": line, "character": column})
    ]


def test_predicates_names_and_categories_are_offered_in_a_task(client, task):
    text = task.read_text()
    client.open(task, text, "bddl")
    line, column = place(text, "(Served", 3)
    labels = [i["label"] for i in client.at("completion", task, line, column)["items"]]
    assert labels == ["Served"]
    line, column = place(text, "(Served cream_cheese_1", len("(Served cream"))
    labels = [i["label"] for i in client.at("completion", task, line, column)["items"]]
    assert labels == ["cream_cheese_1"]
    end_line, end_column = place(text, " - flat_stove", len(" - f"))
    labels = [i["label"] for i in client.at("completion", task, end_line, end_column)["items"]]
    assert "flat_stove" in labels


def test_a_declared_name_of_a_task_is_explained_and_found(client, task):
    text = task.read_text()
    client.open(task, text, "bddl")
    line, column = place(text, "(Served cream_cheese_1", len("(Served cre"))
    assert "object of category `cream_cheese`" in client.at("hover", task, line, column)["contents"]["value"]
    found = client.at("definition", task, line, column)
    assert found["uri"] == task.as_uri()
    declared = text.splitlines()[found["range"]["start"]["line"]]
    assert declared.strip().startswith("cream_cheese_1 - cream_cheese")
    line, column = place(text, "(Served", 3)
    assert "Served(Object, Object)" in client.at("hover", task, line, column)["contents"]["value"]


def test_a_document_is_laid_out_as_onto_fmt_does(client, domain, task):
    options = {"tabSize": 4, "insertSpaces": True}
    for path, language, wanted in (
        (domain, "turtle", format_turtle(domain.read_text(), domain)),
        (task, "bddl", format_text(task.read_text())),
    ):
        loose = wanted.replace("\n    ", "\n  ", 3).rstrip("\n")
        client.open(path, loose, language)
        asked = {"textDocument": {"uri": path.as_uri()}, "options": options}
        (edit,) = client.request("textDocument/formatting", asked)
        assert edit["newText"] == wanted
        lines = loose.split("\n")
        assert edit["range"]["start"] == {"line": 0, "character": 0}
        assert edit["range"]["end"] == {"line": len(lines) - 1, "character": len(lines[-1])}
        client.replace(path, (0, 0), (len(lines) - 1, len(lines[-1])), wanted)
        assert not client.request("textDocument/formatting", asked)
        client.type(path, 0, 0, "}")
        assert not client.request("textDocument/formatting", asked), "what is broken stays as it is"


def test_a_closed_document_has_no_problems(client, domain):
    client.open(domain, domain.read_text() + "}", "turtle")
    client.notify("textDocument/didClose", {"textDocument": {"uri": domain.as_uri()}})
    client.request(
        "textDocument/hover", {"textDocument": {"uri": SERVED.as_uri()}, "position": {"line": 0, "character": 0}}
    )
    last = [m for m in client.log if m.get("params", {}).get("uri") == domain.as_uri()][-1]
    assert last["params"]["diagnostics"] == []
