"""OWL tools other than ours can read the shipped ontology, and a reasoner finds no contradiction in it."""

import owlready2
import pytest
from pyoxigraph import RdfFormat, Store, serialize

import ontology
from onto_compiler.sources import load_store


def as_world(tmp_path, store):
    """The ontology in owlready2. The import statements are left out: everything imported is in ``store`` already."""
    imports = "http://www.w3.org/2002/07/owl#imports"
    triples = [quad.triple for quad in store if quad.predicate.value != imports]
    path = tmp_path / "all.nt"
    path.write_bytes(serialize(triples, format=RdfFormat.N_TRIPLES))
    world = owlready2.World()
    return world, world.get_ontology(path.as_uri()).load()


def test_owlready2_loads_every_class(tmp_path):
    store = load_store()
    world, loaded = as_world(tmp_path, store)
    query = "SELECT ?c WHERE { ?c a <http://www.w3.org/2002/07/owl#Class> }"
    ours = {row[0].value for row in store.query(query, use_default_graph_as_union=True)}
    assert ours <= {cls.iri for cls in loaded.classes()} | {cls.iri for cls in world.classes()}
    assert len(ours) > 50


@pytest.mark.usefixtures("java")
@pytest.mark.parametrize("contradiction", [False, True], ids=["shipped", "with a contradiction"])
def test_hermit_agrees_on_consistency(tmp_path, contradiction):
    store = load_store()
    if contradiction:
        core = "https://w3id.org/onto-evwm/core#"
        store.load(
            f"<{core}Dispatch> a <{core}Level> .".encode(), format=RdfFormat.TURTLE, base_iri="https://example.org/"
        )
    world, loaded = as_world(tmp_path, store)
    with loaded:
        if contradiction:
            with pytest.raises(owlready2.OwlReadyInconsistentOntologyError):
                owlready2.sync_reasoner_hermit(world, debug=0)
        else:
            owlready2.sync_reasoner_hermit(world, debug=0)
            assert list(world.inconsistent_classes()) == []


def test_every_file_is_read_by_rdflib_too():
    rdflib = pytest.importorskip("rdflib")
    for path in ontology.turtle_files():
        ours = Store()
        ours.load(path=path, format=RdfFormat.TURTLE, base_iri=path.as_uri())
        assert len(rdflib.Graph().parse(path, format="turtle")) == len(ours)
