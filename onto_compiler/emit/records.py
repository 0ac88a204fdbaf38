"""The JSON records that commands print, field by field, with the term of the vocabulary that each field states.

JSON Schema and JSON-LD context are two readings of this table. A flat record speaks of several things at once (an
attempt of its decision and application, say); read as RDF it is one node that is all of them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from onto_compiler.rdf import CORE, PROV, RDFS, TRACE

__all__ = ["DOCUMENTS", "GRAPH", "RECORDS", "TYPE", "Field", "RecordShape"]

GRAPH = "@graph"  # the term of a field that holds records and says nothing itself
TYPE = "@type"  # the term of a field that names the class of its record


@dataclass(frozen=True, slots=True)
class Field:
    """What a field holds and states.

    ``kind`` is a JSON type, ``strings``, ``word:KIND`` (see ``words``), ``words:KIND``, ``record:NAME``, ``list:NAME``
    or ``rows:TYPE``, a list of lists.
    """

    kind: str
    term: str = ""  # IRI; empty where the vocabulary has no word for it
    null: bool = False
    reverse: bool = False  # the term leads from the value to the record
    blank: bool = False  # the empty string stands for none
    optional: bool = False  # not every record has it


@dataclass(frozen=True, slots=True)
class RecordShape:
    """One kind of object; ``parts`` are records whose fields it has too."""

    about: str
    fields: Mapping[str, Field]
    parts: tuple[str, ...] = ()
    rules: tuple[str, ...] = field(default=())  # what jsonschema adds: "signature", "arity", "route"


_FACT = {
    "predicate": Field("word:predicate", CORE + "predicate"),
    "arguments": Field("strings", CORE + "arguments"),
    "polarity": Field("boolean", CORE + "polarity"),
}
_EVIDENCE = {
    "truth": Field("boolean", CORE + "truth"),
    "margin": Field("number", CORE + "margin", null=True),
    "unit": Field("word:unit", CORE + "unit", blank=True),
}

RECORDS: Mapping[str, RecordShape] = {
    "Argument": RecordShape(
        "An argument of a required fact: its name in the scene, and its class or, of a threshold, its own name.",
        {"name": Field("string", RDFS + "label"), "type": Field("word:entity", TYPE)},
    ),
    "RequiredFact": RecordShape(
        "An assertion that a task asks for.",
        {
            "predicate": Field("word:predicate_local", CORE + "predicate"),
            "arguments": Field("list:Argument", CORE + "arguments"),
            "polarity": Field("boolean", CORE + "polarity"),
            "threshold": Field("number", CORE + "requiredMargin"),
            "native": Field("string", CORE + "nativeAtom"),
            "grounded_by": Field("string", CORE + "groundedBy"),
            "line": Field("integer"),
            "column": Field("integer"),
        },
        rules=("signature",),
    ),
    "RequiredABox": RecordShape(
        "What a task asks for at its end, and declares of its start.",
        {
            "task": Field("string", TRACE + "task"),
            "language": Field("string", TRACE + "language"),
            "problem": Field("string", TRACE + "problem"),
            "source": Field("string", TRACE + "taskFile"),
            "facts": Field("list:RequiredFact", TRACE + "memberFact"),
            "premise": Field("list:RequiredFact", TRACE + "declares"),
            "alternatives": Field("rows:integer", optional=True),  # places in `facts`
        },
    ),
    "Problem": RecordShape(
        "A fault in an input, with its place; line and column are 0 where a whole file is meant.",
        {
            "code": Field("string"),
            "severity": Field("string"),
            "file": Field("string"),
            "line": Field("integer"),
            "column": Field("integer"),
            "message": Field("string"),
            "hint": Field("string"),
        },
    ),
    "ObservedFact": RecordShape(
        "What the simulator's state says of one required fact.",
        {
            "fact": Field("string"),
            **_FACT,
            "satisfied": Field("boolean"),
            "status": Field("word:status", CORE + "status"),
            **_EVIDENCE,
            "limit": Field("string", CORE + "limit"),
            "native": Field("string", CORE + "nativeAtom"),
        },
        rules=("arity",),
    ),
    "UnmetFact": RecordShape(
        "A diagnosis of one state, with the route that a first attempt would take.",
        {
            "fact": Field("string"),
            **_FACT,
            **_EVIDENCE,
            "status": Field("word:status", CORE + "status"),
            "limit": Field("string", CORE + "limit"),
            "failure": Field("word:failure", CORE + "failureClass"),
            "route": Field("word:route", CORE + "route"),
            "rule": Field("string"),
            "selected": Field("boolean"),
        },
        rules=("arity", "route"),
    ),
    "Diagnosis": RecordShape(
        "The first diagnosis of one fact in an episode, with the routes that the fact was sent to.",
        {
            **_FACT,
            **_EVIDENCE,
            "margin_after": Field("number", null=True),
            "failure": Field("word:failure", CORE + "failureClass"),
            "route": Field("word:route", CORE + "route", null=True),
            "routes": Field("words:route"),
            "source": Field("word:source", CORE + "source"),
        },
        rules=("arity",),
    ),
    "RouteDecision": RecordShape(
        "Which route a rule chose for the selected fact.",
        {
            "fact": Field("string"),
            "failure": Field("word:failure", CORE + "failureClass"),
            "route": Field("word:route", CORE + "route"),
            "decision": Field("word:decision", CORE + "decision"),
        },
        rules=("route",),
    ),
    "Application": RecordShape(
        "What was applied, by whom and how; all null where nothing was.",
        {
            "proposer": Field("string", TRACE + "proposer", null=True),
            "candidate": Field("integer", TRACE + "candidate", null=True),
            "mode": Field("word:mode", TRACE + "mode", null=True),
            "steps": Field("integer", TRACE + "controlSteps", null=True),
            "end": Field("word:end", TRACE + "end", null=True),
            "reason": Field("string", TRACE + "reason", null=True),
            "note": Field("string", TRACE + "note", null=True),
        },
    ),
    "Verification": RecordShape(
        "The native predicate's answer, and whether it held after settling (null: nobody asked).",
        {
            "query": Field("string", TRACE + "query"),
            "outcome": Field("boolean", TRACE + "outcomeTruth"),
            "settled": Field("boolean", TRACE + "settled", null=True),
        },
    ),
    "Attempt": RecordShape(
        "One turn of the correction loop.",
        {
            "verification": Field("record:Verification", TRACE + "verification", null=True),
            "fault": Field("string", TRACE + "fault", null=True),
            # Of an attempt whose proposal was only imagined; `plan` is a place in the episode's plans.
            "plan": Field("integer", optional=True),
            "evaluations": Field("integer", TRACE + "evaluations", optional=True),
            "adopted": Field("boolean", TRACE + "adopted", optional=True),
            "predicted_margin": Field("number", null=True, optional=True),
        },
        parts=("RouteDecision", "Application"),
    ),
    "PlannedFact": RecordShape(
        "A required fact at the end of an executed plan: as the simulator shows it, and as it was predicted.",
        {
            **_FACT,
            **_EVIDENCE,
            "predicted": Field("boolean", null=True),
            "predicted_margin": Field("number", null=True),
            "score": Field("number", CORE + "score", null=True),
        },
        rules=("arity",),
    ),
    "ExecutedPlan": RecordShape(
        "A plan that was executed; `retained` is whether every required fact was predicted, which is no success.",
        {
            "planner": Field("string", TRACE + "proposer"),
            "evaluations": Field("integer", TRACE + "evaluations"),
            "mode": Field("word:mode", TRACE + "mode"),
            "steps": Field("integer", TRACE + "controlSteps"),
            "retained": Field("boolean", null=True),
            "failures": Field("words:failure"),
            "facts": Field("list:PlannedFact"),
            "verification": Field("record:Verification", TRACE + "verification"),
        },
    ),
    "Episode": RecordShape(
        "One run of the correction loop, as `onto repair --json` prints it.",
        {
            "suite": Field("string", TRACE + "suite"),
            "task": Field("string", TRACE + "task"),
            "state": Field("integer", TRACE + "stateIndex"),
            "seed": Field("integer", TRACE + "seed"),
            "language": Field("string", TRACE + "language"),
            "required": Field("strings"),
            "premise_holds": Field("boolean", TRACE + "premiseHolds"),
            "diagnoses": Field("list:Diagnosis", PROV + "wasGeneratedBy", reverse=True),
            "attempts": Field("integer"),
            "history": Field("list:Attempt", TRACE + "inEpisode", reverse=True),
            "plans": Field("list:ExecutedPlan", TRACE + "inEpisode", reverse=True, optional=True),
            "outcome": Field("word:outcome", TRACE + "outcome"),
            "accepted": Field("boolean"),
            "judge": Field("string"),
            "settled": Field("boolean", null=True),
            "verification": Field("record:Verification", TRACE + "verification", null=True),
            "provenance": Field("object"),
        },
    ),
    "Compilation": RecordShape(
        "What `onto compile --json` prints.",
        {"tasks": Field("list:RequiredABox", GRAPH), "problems": Field("list:Problem")},
    ),
    "Verdict": RecordShape(
        "What a task file came to in a batch: how much it asks for, and whether the cache knew.",
        {
            "file": Field("string"),
            "compiled": Field("boolean"),
            "facts": Field("integer"),
            "premise": Field("integer"),
            "alternatives": Field("integer"),
            "cached": Field("boolean"),
        },
    ),
    "Summary": RecordShape(
        "How many files a batch had, and what they came to.",
        {name: Field("integer") for name in ("files", "compiled", "failed", "cached")},
    ),
    "Batch": RecordShape(
        "What `onto compile FOLDER --json` prints.",
        {"files": Field("list:Verdict"), "summary": Field("record:Summary"), "problems": Field("list:Problem")},
    ),
    "Grounding": RecordShape(
        "What `onto ground --json` prints.",
        {
            "world": Field("string"),
            "suite": Field("string", TRACE + "suite"),
            "task": Field("string", TRACE + "task"),
            "state": Field("integer", TRACE + "stateIndex"),
            "facts": Field("list:ObservedFact", TRACE + "memberFact"),
            "premise": Field("list:ObservedFact", TRACE + "declares"),
            "native_success": Field("boolean", TRACE + "outcomeTruth", null=True),
        },
    ),
    "Diagnoses": RecordShape(
        "What `onto diagnose --json` prints.",
        {
            "task": Field("string", TRACE + "task"),
            "state": Field("integer", TRACE + "stateIndex"),
            "diagnoses": Field("list:UnmetFact", PROV + "wasGeneratedBy", reverse=True),
            "alternatives": Field("rows:string", optional=True),
        },
    ),
    "Demonstration": RecordShape(
        "What `onto demo --json` prints: one episode per task, and how many ended well.",
        {
            "tasks": Field("list:Episode", GRAPH),
            "accepted": Field("integer"),
            "settled": Field("integer"),
            "wall_s": Field("number"),
        },
    ),
}
DOCUMENTS = ("Compilation", "Batch", "Grounding", "Diagnoses", "Episode", "Demonstration")  # what commands print
