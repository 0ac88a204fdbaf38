"""A large file is checked once, and again when anything that decides the result has changed."""

import pytest

import onto_compiler.check.cached as module
from onto_compiler.check.cached import cached_check
from onto_compiler.check.run import check
from onto_compiler.check.settings import Settings

TEXT = """@prefix x: <https://example.org/x#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
x:A a owl:Klass .
"""


@pytest.fixture
def calls(tmp_path, monkeypatch):
    (tmp_path / "x.ttl").write_text(TEXT)
    made = []
    monkeypatch.setattr(module, "_LARGE", 10)
    monkeypatch.setattr(module, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(module, "check", lambda *given: made.append(given) or check(*given))
    return made


def test_the_same_file_is_checked_once_with_the_same_result(calls, tmp_path):
    first = cached_check([tmp_path / "x.ttl"])
    assert cached_check([tmp_path / "x.ttl"]) == first == check([tmp_path / "x.ttl"])
    assert len(calls) == 1
    assert [problem.code for problem in first.problems] == ["VOC011"]


def test_another_text_other_settings_and_other_files_are_checked_anew(calls, tmp_path):
    cached_check([tmp_path / "x.ttl"])
    cached_check([tmp_path / "x.ttl"], None, Settings(ignore=("VOC",)))
    (tmp_path / "y.ttl").write_text(TEXT)
    cached_check([tmp_path])
    (tmp_path / "x.ttl").write_text(TEXT.replace("Klass", "Class"))
    assert cached_check([tmp_path / "x.ttl"]).problems == ()
    assert len(calls) == 4


def test_what_packages_register_counts(calls, tmp_path, monkeypatch):
    cached_check([tmp_path / "x.ttl"])
    monkeypatch.setattr(module, "_registered", lambda: ["onto_evwm.groundings new a:b"])
    cached_check([tmp_path / "x.ttl"])
    assert len(calls) == 2


def test_a_damaged_cache_and_one_that_cannot_be_written_cost_time_only(calls, tmp_path):
    first = cached_check([tmp_path / "x.ttl"])
    (kept,) = (tmp_path / "cache" / "checks").glob("*.json")
    kept.write_text("{}\n{}\n")
    assert cached_check([tmp_path / "x.ttl"]) == first
    kept.unlink()
    kept.parent.rmdir()
    kept.parent.write_text("a file")
    assert cached_check([tmp_path / "x.ttl"]) == first
    assert len(calls) == 3


def test_a_small_file_and_a_missing_one_are_not_kept(calls, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_LARGE", 10**6)
    cached_check([tmp_path / "x.ttl"])
    assert [problem.code for problem in cached_check([tmp_path / "gone.ttl"]).problems] == ["TTL002"]
    assert not (tmp_path / "cache").exists()


def test_a_change_of_an_import_or_of_a_catalog_is_noticed(calls, tmp_path):
    head = "<https://example.org/x> a owl:Ontology ; owl:imports <https://example.org/y> .\n"
    (tmp_path / "x.ttl").write_text(TEXT.replace("Klass", "Class") + head)
    upper, catalog = tmp_path / "y.ttl", tmp_path / "catalog-v001.xml"

    def codes():
        return [problem.code for problem in cached_check([tmp_path / "x.ttl"]).problems]

    assert codes() == codes() == ["OWL003"]
    upper.write_text(TEXT)
    catalog.write_text(
        '<catalog xmlns="urn:oasis:names:tc:entity:xmlns:xml:catalog">'
        '<uri name="https://example.org/y" uri="y.ttl"/></catalog>'
    )
    assert codes() == codes() == []
    upper.write_text("x:a")
    assert codes() == codes() == ["TTL003"]
    assert len(calls) == 3
