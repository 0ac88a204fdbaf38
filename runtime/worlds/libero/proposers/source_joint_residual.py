"""The route ``source_joint_residual``: a local search around the present pose, checked by grounding every candidate.

Source (paper, table "Typed gates and state-correction families"): a verifier-checked candidate in source/joint
residuals, used after an attempt was rejected. The residual margin sets the first step of a compass search (Hooke and
Jeeves, 1961) over source coordinates (x, y, yaw) or joint coordinates; of all states that it visits, those that satisfy
the fact are offered, the steadiest or most satisfied first.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from runtime.loop.diagnosis import satisfied, surplus
from runtime.worlds.libero.proposers.candidates import StateCandidate, offer, ranked
from runtime.worlds.libero.proposers.clearance import Clearance
from runtime.worlds.libero.proposers.joints import SINK_M, moved
from runtime.worlds.libero.proposers.placement import Mover, Placement, drop, rest_orientations
from runtime.worlds.libero.proposers.poses import search_window
from runtime.worlds.libero.scene.geometry import yaw_matrix
from runtime.worlds.libero.scene.targets import place_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from numpy.typing import NDArray

    from onto_compiler.schema import Schema
    from runtime.loop.proposer import Request
    from runtime.loop.records import Proposal
    from runtime.worlds.libero.scene.targets import PlacementTarget

    Array = NDArray[np.float64]

__all__ = ["HeuristicSourceJointResidual", "compass"]

_LEVER_M = 0.1  # a yaw of one radian counts as this much displacement
_STEP_M = (0.01, 0.2)  # smallest and largest first step of an object
_STEP_OF_RANGE = (0.02, 0.5)  # the same for a joint, as a fraction of its range
_UNLIMITED = 1.0  # range (rad or m) taken for a joint without limits
_OVERSHOOT = 1.1  # the first step goes a little beyond the residual
_EVALUATIONS = 80
_SMALLEST = 0.05  # of the first step: where the search ends
_COLLIDES = 2


class HeuristicSourceJointResidual:
    """Searches near the present state for one that the grounder finds satisfied."""

    name = "heuristic_source_joint_residual"

    def __init__(self, schema: Schema) -> None:
        """``schema`` is not needed: the residual margin guides the search."""
        self.schema = schema

    def propose(self, request: Request) -> Proposal | None:
        """Return candidate number ``request.candidate``, or None when the search visited no more satisfying states."""
        return offer(request, "source_joint_residual", self.name, self.candidates(request))

    def candidates(self, request: Request) -> Iterator[StateCandidate]:
        """All candidates, best first; the present state itself, which was rejected, is not among them."""
        place = place_of(request.scene, request.diagnosis.fact)
        visited = _poses(request, place) if place is not None else _joint_states(request)
        yield from ranked(request, [[c for c in visited if not np.array_equal(c.qpos, request.qpos)]])


def compass(value: Callable[[Array], float], step: Array, evaluations: int = _EVALUATIONS) -> None:
    """Climb ``value`` from the origin: step either way in each coordinate, and in all at once; halve when none helps.

    ``step`` (n,) holds the first step of each coordinate. ``value`` is called with every point and may record it.
    """
    n = len(step)
    directions = [*np.eye(n), *(-np.eye(n))]
    if n > 1:
        directions += [np.ones(n), -np.ones(n)]
    best, centre, scale = value(np.zeros(n)), np.zeros(n), 1.0
    left = evaluations - 1
    while scale >= _SMALLEST and left > 0:
        polled = []
        for direction in directions[:left]:
            point = centre + scale * step * direction
            polled.append((value(point), point))
            left -= 1
        found, point = max(polled, key=lambda pair: pair[0])
        if found > best:
            best, centre = found, point
        else:
            scale /= 2


def _score(request: Request, qpos: Array) -> float:
    """By how much the diagnosed fact's margin exceeds what is required; +-1 where no margin is defined."""
    facts, seen, index = request.required.facts, request.observe(qpos), request.diagnosis.index
    margin = float(surplus(facts, seen)[index])
    return margin if np.isfinite(margin) else 1.0 if satisfied(facts, seen)[index] else -1.0


def _shortfall(request: Request, unknown: float) -> float:
    margin = request.diagnosis.margin
    return _OVERSHOOT * abs(margin) if np.isfinite(margin) else unknown


def _joint_states(request: Request) -> Iterable[StateCandidate]:
    """States with the joints of the fact's first argument moved, as the search visits them."""
    scene, model = request.scene, request.scene.model
    name = request.diagnosis.fact.native.arguments[0]
    free = scene.free_joint(name) if name in scene.entities else None
    joints = [int(j) for j in scene.joints(name) if int(j) != free]
    if not joints:
        return []
    limits = [tuple(model.jnt_range[j]) if model.jnt_limited[j] else (-np.inf, np.inf) for j in joints]
    spans = np.array([high - low if np.isfinite(high - low) else _UNLIMITED for low, high in limits])
    visited: list[StateCandidate] = []

    def value(point: Array) -> float:
        qpos, deepest = request.qpos, 0.0
        for joint, shift, (low, high) in zip(joints, point, limits, strict=True):
            present = float(request.qpos[scene.qpos_slice(joint)][0])
            aim = float(np.clip(present + shift, low, high)) if shift else present
            if aim != present:
                qpos, _, depth = moved(Clearance(scene, qpos), joint, aim)
                deepest = max(deepest, depth)
        score = _score(request, qpos)
        note = "joints shifted by " + ", ".join(f"{shift:.4f}" for shift in point)
        visited.append(StateCandidate(qpos, note, _COLLIDES if deepest > SINK_M else 0, -score))
        return score

    compass(value, np.clip(_shortfall(request, 0.1), _STEP_OF_RANGE[0] * spans, _STEP_OF_RANGE[1] * spans))
    return visited


def _poses(request: Request, place: PlacementTarget) -> Iterable[StateCandidate]:
    """Landings of the object near its present pose, as the search visits them."""
    clearance = Clearance(request.scene, request.qpos)
    window = search_window(clearance, place, wanted=request.diagnosis.fact.polarity)
    mover = Mover(clearance, place.subject)
    upright = rest_orientations(request.scene, request.qpos, place.subject)[0]
    visited: list[StateCandidate] = []

    def value(point: Array) -> float:
        x, y = mover.home[:2] + point[:2]
        turn = yaw_matrix(point[2] / _LEVER_M)
        note = f"shifted by ({point[0]:.4f}, {point[1]:.4f}) m, turned {np.degrees(point[2] / _LEVER_M):.0f} deg"
        landings = list(drop(mover, Placement(x, y, turn @ upright, note), window))
        visited.extend(landings)
        mover.aim(Placement(x, y, turn @ mover.home_matrix, note))
        mover.write(float(mover.home[2]))
        hovering = clearance.data.qpos.copy()  # where nothing is within reach below, the margin still shows the way
        return max(_score(request, qpos) for qpos in (hovering, *(c.qpos for c in landings)))

    # the margin of a fact that must not hold does not measure the distance to go
    wanted = request.diagnosis.fact.polarity
    first = float(np.clip(_shortfall(request, _STEP_M[0]), *_STEP_M)) if wanted else _STEP_M[1]
    compass(value, np.array([first, first, _LEVER_M * np.pi / 4]))
    return visited
