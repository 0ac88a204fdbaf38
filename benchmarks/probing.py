"""States that probe a fact: random ones around its goal, settled ones, and ones within 1 mm or 1 mrad of a limit.

Each is grounded by us and by LIBERO's own predicate. The tests hold the two equal; the protocol ``grounding`` publishes
how often and on what they were compared.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from grounding.predicates.terms import Term
from grounding.scenes import Scene
from grounding.sim import SimGrounder
from onto_compiler.bddl.lift import required_abox
from onto_compiler.bddl.parse import parse_file
from onto_compiler.required import Fact
from onto_compiler.schema import Schema
from runtime.worlds.libero.simulator.assets import find_task, initial_states
from runtime.worlds.libero.simulator.native import NativeTask

__all__ = ["CLOSE", "GOAL_TASKS", "OTHER_TASKS", "Counts", "Sample", "probe"]

CLOSE = 1e-3  # metres or radians: how near a threshold an adversarial state lies
GOAL_TASKS = tuple(("libero_goal", index) for index in range(10))
OTHER_TASKS = (
    ("libero_spatial", 4),  # the bowl lies in a drawer that stands open
    ("libero_spatial", 5),  # the bowl lies on a ramekin
    ("libero_object", 0),  # In a basket that can move
    ("libero_10", 2),  # Turnon, and a pot on the burner
    ("libero_10", 3),  # In a drawer, and Close
    ("libero_10", 5),  # In a compartment of a caddy
    ("libero_10", 6),  # On a table region that stands for a landmark
    ("libero_10", 9),  # In a microwave, and Close
    ("libero_90", 35),  # Open a microwave
    ("libero_90", 39),  # Turnoff
)
TERMS = {
    "in_site": ("x", "y", "height", "depth"),
    "on_object": ("xy", "height", "contact"),
    "on_site": ("x", "y", "height", "ceiling", "contact"),
}


@dataclass(frozen=True)
class Sample:
    """One fact in one state: what the native predicate says, and what the grounder says."""

    task: str
    fact: str
    grounded_by: str
    predicate: str
    target: bool  # the state was made for this fact
    label: str  # "random" | "settled" | "edge:TERM:+" | "edge:TERM:-"
    native: bool
    truth: bool
    compiled: bool  # the truth again, without margins
    margin: float
    limit: str
    terms: tuple[Term, ...]


class Prober:
    """Makes states for the facts of one task and compares both groundings in each."""

    def __init__(self, native: NativeTask, scene: Scene, facts: tuple[Fact, ...], schema: Schema, seed: int) -> None:
        self.native, self.scene, self.facts, self.schema = native, scene, facts, schema
        self.grounder = SimGrounder(scene, facts, schema)
        self.rng = np.random.default_rng(seed)
        self.base = native.snapshot()
        self.start = native.data.qpos.copy()

    def samples(self, fact: Fact, randoms: int, settles: int, edges: int) -> Iterator[Sample]:
        make = self._joint_states if fact.grounded_by == "joint_threshold" else self._pose_states
        for label in make(fact, randoms, settles, edges):
            yield from self.compare(fact, label)

    def compare(self, target: Fact | None, label: str) -> Iterator[Sample]:
        data = self.native.data
        observed, terms = self.grounder.observe(data), self.grounder.terms(data)
        compiled = self.grounder.truth(data)
        for index, fact in enumerate(self.facts):
            yield Sample(
                self.native.bddl.stem,
                str(fact),
                fact.grounded_by,
                fact.native.predicate,
                fact is target,
                label,
                self.native.evaluate(fact.native),
                bool(observed.truth[index]),
                bool(compiled[index]),
                float(observed.margin[index]),
                observed.limit[index],
                terms[index],
            )

    # Joints ----------------------------------------------------------------------------------------------------------

    def _joint_states(self, fact: Fact, randoms: int, settles: int, edges: int) -> Iterator[str]:
        threshold = self.schema.threshold(fact.arguments[1].type)
        bound = threshold.bound if threshold else 0.0
        joints = self.scene.joints(fact.native.arguments[0])
        low, high = self.scene.model.jnt_range[joints].min(), self.scene.model.jnt_range[joints].max()
        values = [("random", v) for v in self.rng.uniform(low - 0.1, high + 0.1, randoms + settles)]
        for sign, mark in ((1, "+"), (-1, "-")):
            values += [(f"edge:qpos:{mark}", bound + sign * d) for d in self.rng.uniform(0, CLOSE, edges)]
        values.append(("edge:qpos:=", bound))
        for label, value in values:
            qpos = self.start.copy()
            qpos[self.scene.model.jnt_qposadr[joints]] = value
            self.native.restore(self.base)
            self.native.write_qpos(qpos)
            yield label

    # Poses -----------------------------------------------------------------------------------------------------------

    def _pose_states(self, fact: Fact, randoms: int, settles: int, edges: int) -> Iterator[str]:
        for _ in range(randoms):
            self._place(fact, self._offset(fact, 1.4), turn=self.rng.random() < 0.3)
            yield "random"
        for _ in range(settles):
            self._rest(fact, self._offset(fact, 0.5), lift=float(self.rng.uniform(0.0, 0.01)))
            self.native.settle(4)
            yield "settled"
        for _ in range(edges):
            yield from self._edges(fact)

    def _offset(self, fact: Fact, spread: float) -> NDArray[np.float64]:
        """A point around the goal, in the target's frame; LIBERO's box ends 1 cm below or 10 cm above its faces."""
        if self._is_site(fact):
            half = self.scene.model.site_size[self.scene.site(fact.native.arguments[1])]
            low, high = (-half[2], half[2]) if fact.grounded_by == "in_site" else (half[2], half[2] + 0.08)
            xy = self.rng.uniform(-spread, spread, 2) * half[:2]
            return np.array([*xy, self.rng.uniform(low - 0.02 * spread, high + 0.02 * spread)])
        return np.array([*self.rng.uniform(-0.03, 0.03, 2) * spread, self.rng.uniform(-0.01, 0.06)])

    def _edges(self, fact: Fact) -> Iterator[str]:
        """For each threshold of the fact, one state on either side of it, all else being satisfied where it can be."""
        make = self._edge_of_region if self._is_site(fact) else self._edge_of_object
        make = self._edge_of_box if fact.grounded_by == "in_site" else make
        for name, sign in product(TERMS[fact.grounded_by], (1.0, -1.0)):
            if make(fact, name, sign * float(self.rng.uniform(0.0, CLOSE))):
                yield f"edge:{name}:{'+' if sign > 0 else '-'}"

    def _edge_of_object(self, fact: Fact, name: str, delta: float) -> bool:
        """``On(object, object)`` with a margin of about ``delta`` in term ``name``."""
        angle = self.rng.uniform(0, 2 * np.pi)
        if name == "xy":
            self._rest(fact, (0.03 - delta) * np.array([np.cos(angle), np.sin(angle), 0.0]))
        elif name == "contact":
            self._rest(fact, np.array([0.005, 0.0, 0.0]), lift=-delta)
        else:
            self._place(fact, np.array([0.004, 0.0, delta]))
        return True

    def _edge_of_box(self, fact: Fact, name: str, delta: float) -> bool:
        """``In(object, region)``: the box is axis-aligned in the world, and 1 cm deeper than its size."""
        site = self.scene.site(fact.native.arguments[1])
        frame = self.native.data.site_xmat[site].reshape(3, 3)
        half = np.abs(frame @ self.scene.model.site_size[site])
        offset = np.zeros(3)
        if name == "depth":
            offset[2] = -half[2] - 0.01 + delta
        else:
            axis = ("x", "y", "height").index(name)
            side = 1.0 if name == "height" else self.rng.choice((-1.0, 1.0))
            offset[axis] = side * (half[axis] - delta)
        self._place(fact, frame @ offset)
        return True

    def _edge_of_region(self, fact: Fact, name: str, delta: float) -> bool:
        """``On(object, region)``; False for the contact of a region that no entity carries."""
        region = fact.native.arguments[1]
        half = self.scene.model.site_size[self.scene.site(region)]
        offset = np.zeros(3)
        if name == "height":
            offset[2] = half[2] - 0.005 + delta
        elif name == "ceiling":
            offset[2] = half[2] + 0.10 - delta
        else:
            offset[2] = half[2] + 0.02
        if name in {"x", "y"}:
            axis = "xy".index(name)
            offset[axis] = self.rng.choice((-1.0, 1.0)) * (half[axis] - delta)
        if name in {"height", "ceiling"}:
            self._place(fact, offset)
        elif name != "contact" or self.scene.site_parent(region):
            self._rest(fact, offset, lift=-delta if name == "contact" else 0.0)
        else:
            return False
        return True

    def _is_site(self, fact: Fact) -> bool:
        return fact.native.arguments[1] in self.scene.sites

    def _anchor(self, fact: Fact) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """World position and frame of the target in the base state."""
        target, data = fact.native.arguments[1], self.native.data
        if self._is_site(fact):
            site = self.scene.site(target)
            return data.site_xpos[site].copy(), data.site_xmat[site].reshape(3, 3).copy()
        return data.xpos[self.scene.root_body(target)].copy(), np.eye(3)

    def _place(self, fact: Fact, offset: NDArray[np.float64], *, turn: bool = False) -> None:
        """Write the object at ``offset`` (in upstream's frame of the target, ``xmat @ (object - target)``)."""
        self.native.restore(self.base)
        anchor, frame = self._anchor(fact)
        joint = self.scene.free_joint(fact.native.arguments[0])
        if joint is None:
            raise ValueError(f"`{fact.native.arguments[0]}` cannot be moved")
        qpos = self.start.copy()
        pose = qpos[self.scene.qpos_slice(joint)]
        pose[:3] = anchor + frame.T @ offset
        if turn:
            quaternion = self.rng.normal(size=4)
            pose[3:] = quaternion / np.linalg.norm(quaternion)
        self.native.write_qpos(qpos)

    def _rest(self, fact: Fact, offset: NDArray[np.float64], lift: float = 0.0) -> None:
        """Lower the object at ``offset`` until it just touches what carries it, then lift it by ``lift`` metres."""
        target = fact.native.arguments[1]
        carrier = self.scene.site_parent(target) if self._is_site(fact) else target
        if carrier is None:
            self._place(fact, offset)
            return
        low, high = -0.05, 0.15
        for _ in range(18):  # 0.2 m halved 18 times: below a micrometre
            middle = (low + high) / 2
            self._place(fact, np.array([offset[0], offset[1], offset[2] + middle]))
            touches = self.native.env.check_contact(
                self.native.env.get_object(carrier), self.native.env.get_object(fact.native.arguments[0])
            )
            low, high = (middle, high) if touches else (low, middle)
        self._place(fact, np.array([offset[0], offset[1], offset[2] + low + lift - 1e-6]))


@dataclass(frozen=True)
class Counts:
    """How many states of each sort to make for each fact of a goal; ``edges`` counts rounds over all thresholds."""

    randoms: int
    settles: int
    edges: int


def probe(suite: str, index: int, schema: Schema, counts: Counts) -> list[Sample]:
    """Open a task, settle an official initial state, and compare both groundings in states made for its goal."""
    ref = find_task(suite, index)
    required = required_abox(parse_file(ref.bddl), schema, ref.name)
    with NativeTask.open(ref, seed=index) as native:
        native.reset_to(initial_states(ref)[index])
        native.settle(10)
        # A premise about a region asks where an object was put; here it is held against the native predicate.
        placed = (f.grounded_by == "placed_in_region" for f in required.premise)
        premise = [replace(f, grounded_by="on_site") if p else f for f, p in zip(required.premise, placed, strict=True)]
        prober = Prober(native, Scene(native.model), (*required.facts, *premise), schema, index)
        found = list(prober.compare(None, "initial"))
        for fact in required.facts:
            found += prober.samples(fact, counts.randoms, counts.settles, counts.edges)
    return found
