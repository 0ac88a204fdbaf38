"""The truth of all facts of a goal in one compiled call, with the contacts read once: no margins, no Python objects.

What a plan cannot decide by more than a billionth of a metre or radian is left open, and its grounding function
answers: an order of operations or a last bit can then never make this a second truth.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from grounding.evaluate import ANY_JOINT, BOX, DISC, EVERY_JOINT, NO_PLAN, NUMBERS, OPEN, REGION, SLOTS, evaluate
from grounding.memory import contact_places
from grounding.plans import Box, Disc, Joints, Plan, SiteBox
from grounding.scenes import Scene
from onto_compiler.problems import OntoError

__all__ = ["MOST_CONTACTS", "CompiledTruth"]

MOST_CONTACTS = 64  # contacts that one goal can ask for: bits of a word


class CompiledTruth:
    """Evaluates ``plans`` on states of ``scene``; a plan that is None, or one contact too many, is always left open."""

    def __init__(self, scene: Scene, plans: Sequence[Plan | None]) -> None:
        """Write the plans as tables."""
        self._model = scene.model
        self.truth = np.zeros(len(plans), dtype=np.uint8)
        self._integers = np.zeros((len(plans), 4), dtype=np.int64)
        self._numbers = np.zeros((len(plans), NUMBERS))
        self._sides = np.zeros((2, scene.model.ngeom), dtype=np.uint64)
        self._joints = np.zeros(0, dtype=np.int64)
        self._contacts = 0
        for fact, plan in enumerate(plans):
            self._write(fact, plan)
        self._block = np.zeros(len(SLOTS), dtype=np.int64)
        self._address = self._block.ctypes.data
        self._data: mujoco.MjData | None = None

    def __call__(self, data: mujoco.MjData) -> int:
        """Write ``truth`` (0, 1, or 2: :attr:`open`) and return how many are open; -1 where ``qpos`` is not finite."""
        if data is not self._data:
            self._bind(data)
        return int(evaluate(self._address))

    @property
    def open(self) -> NDArray[np.intp]:
        """The facts whose ``truth`` is open."""
        return np.flatnonzero(self.truth == OPEN)

    def _write(self, fact: int, plan: Plan | None) -> None:
        contact = None if plan is None or isinstance(plan, SiteBox | Joints) else plan.contact
        if plan is None or (contact is not None and self._contacts == MOST_CONTACTS):
            self._integers[fact] = NO_PLAN, 0, 0, -1
            return
        bit = -1
        if contact is not None:
            bit, self._contacts = self._contacts, self._contacts + 1
            for side, geoms in enumerate(contact):
                self._sides[side, geoms] |= np.uint64(1 << bit)
        integers: tuple[int, int, int]
        numbers: tuple[float, ...]
        match plan:
            case Box(body, site, low, high):
                integers, numbers = (BOX, body, site), (*low, *high)
            case SiteBox(body, site, size, sink):
                integers, numbers = (REGION, body, site), (*size, sink)
            case Disc(upper, lower, radius):
                integers, numbers = (DISC, upper, lower), (radius,)
            case Joints(addresses, sign, bound, every):
                start, self._joints = len(self._joints), np.append(self._joints, np.array(addresses, dtype=np.int64))
                integers = (EVERY_JOINT if every else ANY_JOINT, start, len(self._joints))
                numbers = (sign, bound)
        self._integers[fact] = (*integers, bit)
        self._numbers[fact, : len(numbers)] = numbers

    def _bind(self, data: mujoco.MjData) -> None:
        """Note where ``data``, which is kept, and the tables have what the compiled code reads."""
        sizes, needed = (len(data.xpos), len(data.site_xpos)), (self._model.nbody, self._model.nsite)
        if sizes != needed:
            message = f"the state has {sizes[0]} bodies and {sizes[1]} sites, the scene {needed[0]} and {needed[1]}"
            raise OntoError.of("SIM004", message, "ground a state with the scene of the same model")
        places = contact_places()
        arrays = {
            **{name: getattr(data, name) for name in ("xpos", "site_xpos", "site_xmat", "qpos")},
            **{name: getattr(self, f"_{name}") for name in ("sides", "integers", "numbers", "joints")},
            "truth": self.truth,
        }
        values = {
            **{name: array.ctypes.data for name, array in arrays.items()},
            "ncon": data._address + places.ncon,  # noqa: SLF001  the bindings' documented way to the C struct
            "contact": data._address + places.contact,  # noqa: SLF001  as above
            "geom": places.geom,
            "stride": places.stride,
            "nq": data.qpos.size,
            "nbody": len(data.xpos),
            "nsite": len(data.site_xpos),
            "ngeom": self._sides.shape[1],
            "facts": len(self.truth),
            "njoint": len(self._joints),
            "contacts": self._contacts,
        }
        self._block[:] = [values[name] for name in SLOTS]
        self._data = data
