"""Repairs, renaming, references, symbols and colours in a session with a real server process."""

import shutil
import time
from pathlib import Path

import pytest

import ontology
from onto_compiler.check.fix import fix
from onto_compiler.lsp.client import Client
from onto_compiler.lsp.requests import LEGEND

pytest.importorskip("pygls")
ROOT = Path(__file__).resolve().parents[3]
TASK = ROOT / "docs/examples/serve_the_cheese.bddl"
WIDE = "😀 𝄞"  # two characters of two UTF-16 units each
HEADER = """\
@prefix dcterms: <http://purl.org/dc/terms/> .
@prefix ex: <https://example.org/kitchen#> .
@prefix man: <https://w3id.org/onto-evwm/manipulation#> .
@prefix nix: <https://example.org/none#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .

<https://example.org/kitchen> a owl:Ontology ; dcterms:title "Kitchen"@en ;
    dcterms:description "A kitchen."@en ; dcterms:creator "Somebody" ;
    dcterms:license <https://spdx.org/licenses/MIT> ;
    owl:imports <https://w3id.org/onto-evwm/manipulation> ;
    owl:versionIRI <https://example.org/kitchen/0.1.0> ; owl:versionInfo "0.1.0" .
"""
KITCHEN = f"""{HEADER}
ex:Spoon a owl:Class ; rdfs:label "spoon {WIDE}"@en ; rdfs:subClassOf ex:Ladle ;
    skos:definition "A {WIDE} spoon"@en ; rdfs:isDefinedBy <https://example.org/kitchen> .

ex:Fork a owl:Class ; rdfs:label "fork"@en ; rdfs:subClassOf man:Object ; skos:definition "A {WIDE} fork"@en .

ex:Ladle a owl:Class ; owl:deprecated true ; dcterms:isReplacedBy man:Object ; rdfs:label "ladle"@en ;
    skos:definition "A ladle."@en ; rdfs:isDefinedBy <https://example.org/kitchen> .
"""
DATA = f"""\
@prefix k: <https://example.org/kitchen#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .

k:mine rdfs:label "{WIDE}" ; a k:Spoon .
"""
QUERY = "PREFIX k: <https://example.org/kitchen#>\nSELECT ?s WHERE { ?s a k:Spoon }\n"


@pytest.fixture
def kitchen(tmp_path):
    (tmp_path / "kitchen.ttl").write_text(KITCHEN)
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "mine.ttl").write_text(DATA)
    (tmp_path / "spoons.rq").write_text(QUERY)
    (tmp_path / "node_modules").mkdir()
    (tmp_path / "node_modules" / "theirs.ttl").write_text(DATA)
    shutil.copy(TASK, tmp_path)
    return tmp_path


@pytest.fixture
def client(kitchen):
    with Client(folder=kitchen) as running:
        yield running


def units(text):
    return len(text.encode("utf-16-le")) // 2


def offset_of(text, position):
    """The offset of a place, counted as the protocol does."""
    lines = text.split("\n")
    start = sum(len(line) + 1 for line in lines[: position["line"]])
    column = 0
    while units(lines[position["line"]][:column]) < position["character"]:
        column += 1
    return start + column


def place(text, needle, inside=0):
    offset = text.index(needle) + inside
    return text.count("\n", 0, offset), units(text[text.rfind("\n", 0, offset) + 1 : offset])


def part(text, found):
    return text[offset_of(text, found["start"]) : offset_of(text, found["end"])]


def edited(text, edits):
    for edit in sorted(edits, key=lambda edit: offset_of(text, edit["range"]["start"]), reverse=True):
        start, end = (offset_of(text, edit["range"][end]) for end in ("start", "end"))
        text = text[:start] + edit["newText"] + text[end:]
    return text


def opened(client, path, language="turtle"):
    """Open a file and wait for the whole check, where there is one."""
    found = client.open(path, path.read_text(), language)
    return found if language == "bddl" else client.diagnostics(path.as_uri())


def actions(client, path, found, only=None):
    context = {"diagnostics": found} | ({"only": only} if only else {})
    last = len(path.read_text().split("\n"))
    where = {"start": {"line": 0, "character": 0}, "end": {"line": last, "character": 0}}
    params = {"textDocument": {"uri": path.as_uri()}, "range": where, "context": context}
    return client.request("textDocument/codeAction", params)


def refused(client, method, path, position, **more):
    params = {
        "textDocument": {"uri": path.as_uri()},
        "position": dict(zip(("line", "character"), position, strict=True)),
    }
    with pytest.raises(RuntimeError) as caught:
        client.request(f"textDocument/{method}", params | more)
    return str(caught.value)


def renamed(client, path, position, name):
    line, character = position
    params = {"textDocument": {"uri": path.as_uri()}, "position": {"line": line, "character": character}}
    return client.request("textDocument/rename", params | {"newName": name})["changes"]


def test_each_problem_that_fix_repairs_has_a_quick_fix_and_all_together_do_what_fix_does(client, kitchen):
    path = kitchen / "kitchen.ttl"
    found = opened(client, path)
    offered = actions(client, path, found, ["quickfix"])
    assert sorted(one["diagnostics"][0]["code"] for one in offered) == ["DOC004", "DOC005", "TTL007", "VOC006"]
    titles = {one["diagnostics"][0]["code"]: one["title"] for one in offered}
    assert titles["VOC006"] == "Replace the deprecated `ex:Ladle` by `man:Object`"
    expected = {
        "DOC004": (f'"A {WIDE} spoon"', f'"A {WIDE} spoon."'),
        "TTL007": ("@prefix nix: <https://example.org/none#> .\n", ""),
        "VOC006": ("rdfs:subClassOf ex:Ladle", "rdfs:subClassOf man:Object"),
    }
    for one in offered:
        old, new = expected.get(one["diagnostics"][0]["code"], (None, None))
        after = edited(KITCHEN, one["edit"]["changes"][path.as_uri()])
        if new is not None:
            assert after == KITCHEN.replace(old, new)
    (everything,) = actions(client, path, found, ["source.fixAll"])
    assert everything["kind"] == "source.fixAll.onto"
    after = edited(KITCHEN, everything["edit"]["changes"][path.as_uri()])
    assert after == fix([path]).after[path.resolve()]


def test_an_editor_that_resolves_actions_gets_the_large_repair_when_it_is_chosen(kitchen):
    able = {"textDocument": {"codeAction": {"resolveSupport": {"properties": ["edit"]}}}}
    path = kitchen / "kitchen.ttl"
    with Client(folder=kitchen, capabilities=able) as running:
        offered = actions(running, path, opened(running, path))
        (everything,) = [one for one in offered if one["kind"] == "source.fixAll.onto"]
        assert "edit" not in everything
        resolved = running.request("codeAction/resolve", everything)
        assert edited(KITCHEN, resolved["edit"]["changes"][path.as_uri()]) == fix([path]).after[path.resolve()]


def test_nothing_is_offered_where_nothing_can_be_repaired(client, kitchen):
    path = kitchen / "data" / "mine.ttl"
    assert actions(client, path, opened(client, path)) == []
    task = kitchen / TASK.name
    assert actions(client, task, opened(client, task, "bddl")) == []


def test_problems_carry_their_page_and_say_what_is_not_needed(client, kitchen):
    found = {one["code"]: one for one in opened(client, kitchen / "kitchen.ttl")}
    assert found["TTL007"]["tags"] == [1]
    assert found["VOC006"]["tags"] == [2]
    assert "tags" not in found["DOC005"]
    for code, one in found.items():
        href = one["codeDescription"]["href"]
        assert Path(href.removeprefix("file://")).read_text().startswith(f"# {code}: ")


def test_renaming_changes_every_file_of_the_folder_counting_in_utf16(client, kitchen):
    path, data, query = kitchen / "kitchen.ttl", kitchen / "data" / "mine.ttl", kitchen / "spoons.rq"
    opened(client, data)
    position = place(DATA, "k:Spoon", 3)
    prepared = client.at("prepareRename", data, *position)
    assert (part(DATA, prepared["range"]), prepared["placeholder"]) == ("Spoon", "Spoon")
    changes = renamed(client, data, position, "Scoop")
    assert set(changes) == {path.as_uri(), data.as_uri(), query.as_uri()}
    for file in (path, data, query):
        before = file.read_text()
        after = edited(before, changes[file.as_uri()])
        assert after == before.replace(":Spoon", ":Scoop")


def test_what_is_typed_and_not_saved_is_renamed_as_it_is(client, kitchen):
    data = kitchen / "data" / "mine.ttl"
    opened(client, data)
    client.type(data, 0, 0, "# a line more\n")
    changes = renamed(client, data, (4, place(DATA, "k:Spoon", 3)[1]), "Scoop")
    text = "# a line more\n" + DATA
    assert edited(text, changes[data.as_uri()]) == text.replace("k:Spoon", "k:Scoop")


def test_terms_of_others_are_not_renamed(client, kitchen):
    path = kitchen / "kitchen.ttl"
    opened(client, path)
    for at in ("owl:Class", "rdfs:label"):
        assert "standard vocabulary" in refused(client, "prepareRename", path, place(KITCHEN, at, 6))
        assert "standard vocabulary" in refused(client, "rename", path, place(KITCHEN, at, 6), newName="x")
    said = refused(client, "rename", path, place(KITCHEN, "man:Object", 5), newName="Thing")
    assert "`Object` is declared in `manipulation.ttl`, outside of this folder" in said
    assert "outside of this folder" in refused(client, "prepareRename", path, place(KITCHEN, "man:Object", 5))
    assert "the two would become one" in refused(client, "rename", path, place(KITCHEN, "ex:Spoon"), newName="Ladle")


def test_references_are_found_in_files_that_are_not_open(client, kitchen):
    path, data, query = kitchen / "kitchen.ttl", kitchen / "data" / "mine.ttl", kitchen / "spoons.rq"
    opened(client, path)
    line, character = place(KITCHEN, "ex:Spoon", 4)
    params = {"textDocument": {"uri": path.as_uri()}, "position": {"line": line, "character": character}}
    found = client.request("textDocument/references", params | {"context": {"includeDeclaration": True}})
    assert {
        (one["uri"], part(Path(one["uri"].removeprefix("file://")).read_text(), one["range"])) for one in found
    } == {
        (path.as_uri(), "ex:Spoon"),
        (data.as_uri(), "k:Spoon"),
        (query.as_uri(), "k:Spoon"),
    }
    without = client.request("textDocument/references", params | {"context": {"includeDeclaration": False}})
    assert path.as_uri() not in {one["uri"] for one in without}


def test_symbols_of_a_document_and_of_the_workspace(client, kitchen):
    path, task = kitchen / "kitchen.ttl", kitchen / TASK.name
    opened(client, path)
    found = client.request("textDocument/documentSymbol", {"textDocument": {"uri": path.as_uri()}})
    named = {one["name"]: one for one in found}
    assert list(named) == ["<https://example.org/kitchen>", "ex:Spoon", "ex:Fork", "ex:Ladle"]
    assert named["ex:Ladle"]["tags"] == [1]
    assert named["ex:Spoon"]["kind"] == 5
    assert part(KITCHEN, named["ex:Spoon"]["range"]).endswith("kitchen> .")
    assert part(KITCHEN, named["ex:Spoon"]["selectionRange"]) == "ex:Spoon"
    opened(client, task, "bddl")
    found = client.request("textDocument/documentSymbol", {"textDocument": {"uri": task.as_uri()}})
    inside = {one["name"]: [inner["name"] for inner in one["children"]] for one in found}
    assert inside["Goal"] == ["(Served cream_cheese_1 plate_1)"]
    assert "cream_cheese_1" in inside["Objects"]
    assert "main_table_plate_region" in inside["Regions"]
    for query, name, file in (
        ("spoon", "ex:Spoon", path),
        ("MINE", "k:mine", kitchen / "data" / "mine.ttl"),
        ("crmchs", "cream_cheese_1", task),
    ):
        answers = client.request("workspace/symbol", {"query": query})
        assert (name, file.as_uri()) in {(one["name"], one["location"]["uri"]) for one in answers}
        assert not [one for one in answers if "node_modules" in one["location"]["uri"]]


def test_a_task_leads_to_the_ontology(client, kitchen):
    task = kitchen / TASK.name
    text = TASK.read_text().replace("(Served cream_cheese_1 plate_1)", "(On cream_cheese_1 plate_1)")
    task.write_text(text)
    opened(client, task, "bddl")
    for at, file, block in (
        ("(On cream_cheese_1 plate_1)", "manipulation.ttl", "man:on a"),
        ("(On plate_1 main", "manipulation.ttl", "man:in_region a"),
        ("- flat_stove", "bindings/libero.ttl", "lib:flat_stove a"),
    ):
        found = client.at("definition", task, *place(text, at, 2))
        assert found["uri"] == (ontology.ROOT / file).as_uri(), at
        lines = (ontology.ROOT / file).read_text().splitlines()
        assert lines[found["range"]["start"]["line"]].startswith(block)
    found = client.at("definition", task, *place(text, "(On cream_cheese_1 plate_1)", 6))
    assert (found["uri"], part(text, found["range"])) == (task.as_uri(), "cream_cheese_1")


def test_names_of_a_task_are_renamed_and_those_of_the_ontology_are_not(client, kitchen):
    task = kitchen / TASK.name
    text = task.read_text()
    opened(client, task, "bddl")
    changes = renamed(client, task, place(text, "(Served cream_cheese_1", 10), "feta_1")
    assert edited(text, changes[task.as_uri()]) == text.replace("cream_cheese_1", "feta_1")
    said = refused(client, "prepareRename", task, place(text, "(Served", 2))
    assert "The predicate `Served` has its name from the ontology" in said
    assert "declared already" in refused(client, "rename", task, place(text, "plate_1 - "), newName="wine_bottle_1")


def tokens_of(client, path, text):
    """The semantic tokens as text, kind and whether they declare."""
    data = client.request("textDocument/semanticTokens/full", {"textDocument": {"uri": path.as_uri()}})["data"]
    line = character = 0
    for down, right, length, kind, declares in zip(*(data[i::5] for i in range(5)), strict=True):
        line, character = line + down, right if down else character + right
        row = text.split("\n")[line].encode("utf-16-le")
        piece = row[2 * character : 2 * (character + length)].decode("utf-16-le")
        yield piece, LEGEND.token_types[kind], bool(declares)


def test_semantic_tokens_say_what_a_name_is_wherever_it_is_declared(client, kitchen):
    path, data = kitchen / "kitchen.ttl", kitchen / "data" / "mine.ttl"
    opened(client, path)
    found = list(tokens_of(client, path, KITCHEN))
    assert ("Spoon", "class", True) in found
    assert ("Ladle", "class", False) in found
    assert ("definition", "property", False) in found
    assert ("true", "keyword", False) in found
    opened(client, data)
    last = list(tokens_of(client, data, DATA))[-4:]
    assert last == [
        (f'"{WIDE}"', "string", False),
        ("a", "keyword", False),
        ("k", "namespace", False),
        ("Spoon", "class", False),
    ]
    task = kitchen / TASK.name
    opened(client, task, "bddl")
    found = list(tokens_of(client, task, task.read_text()))
    assert ("Served", "function", False) in found
    assert ("flat_stove", "class", False) in found
    assert ("Serve", "string", False) in found


def test_a_line_ends_where_the_protocol_ends_it(client, kitchen):
    path = kitchen / "kitchen.ttl"
    odd = KITCHEN.replace("A ladle.", "A\u2028ladle\u0085and\u000cmore.")
    path.write_text(odd)
    opened(client, path)
    line, character = place(odd, "ex:Ladle a", 3)
    prepared = client.at("prepareRename", path, line, character)
    assert part(odd, prepared["range"]) == "Ladle"
    last = place(odd, "rdfs:isDefinedBy <https", 5)
    client.type(path, *last, "x")
    text = odd.replace("rdfs:isDefinedBy <https", "rdfs:xisDefinedBy <https")
    found = client.diagnostics(path.as_uri())
    assert "rdfs:xisDefinedBy" in {part(text, one["range"]) for one in found}


def test_an_editor_that_can_watch_files_is_asked_to(kitchen):
    able = {
        "workspace": {
            "didChangeWatchedFiles": {"dynamicRegistration": True},
            "semanticTokens": {"refreshSupport": True},
        }
    }
    path = kitchen / "kitchen.ttl"
    with Client(folder=kitchen, capabilities=able) as running:
        opened(running, path)
        for _ in range(100):  # the terms of other files are read once the problems are out
            running.request("workspace/symbol", {"query": "nothing is called so"})
            asked = {message["method"]: message.get("params") for message in running.log if "method" in message}
            if "workspace/semanticTokens/refresh" in asked:
                break
            time.sleep(0.05)
        assert "workspace/semanticTokens/refresh" in asked
        (watching,) = asked["client/registerCapability"]["registrations"]
        assert watching["method"] == "workspace/didChangeWatchedFiles"
