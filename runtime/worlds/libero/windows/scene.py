"""What the replays of one task's windows need: the exact loop, LIBERO's own judge, and its resets with other seeds."""

from __future__ import annotations

from grounding.sim import SimGrounder
from onto_compiler.closing import Closing
from onto_compiler.knowledge import Knowledge
from onto_compiler.problems import OntoError
from runtime.worlds.libero.demos.records import DemoFile, Demonstration
from runtime.worlds.libero.demos.replay import task_of
from runtime.worlds.libero.scene.facts import ForwardedFacts
from runtime.worlds.libero.simulator.compiled import compile_scene
from runtime.worlds.libero.simulator.native import NativeTask
from runtime.worlds.libero.simulator.simulation import Simulation
from runtime.worlds.libero.windows.window import Window
from runtime.worlds.required import required_of
from runtime.worlds.snapshot import Snapshot

__all__ = ["WindowScene"]


class WindowScene(Closing):
    """The scene of ``file``'s task. Replays run on the exact loop, which is bit-equal to LIBERO's environment."""

    def __init__(self, file: DemoFile, knowledge: Knowledge) -> None:
        """Build scene and judge, in some seconds; raises ``DEM005`` and as ``onto ground``."""
        ref = task_of(file)
        scene = compile_scene(ref.bddl)
        self.file = file
        self.required = required_of(ref, knowledge)
        self.simulation = Simulation(scene, exact=True)
        self.holds = ForwardedFacts(SimGrounder(scene.index, self.required.facts, knowledge.schema))
        self._native = NativeTask.open(ref)
        self._homes: dict[int, Snapshot] = {}

    def demonstration(self, window: Window) -> Demonstration:
        """The demonstration that ``window`` is of; raises ``DEM008`` if the file has none that holds it."""
        file = self.file
        if window.task != f"{file.suite}/{file.task}" or not 0 <= window.demo < len(file.demos):
            message = f"the file of `{file.suite}/{file.task}` has no demonstration {window.demo} of `{window.task}`"
            raise OntoError.of("DEM008", message, "draw windows from the file that they are replayed with", file.path)
        demo = file.demos[window.demo]
        if not 0 <= window.start <= window.stop <= len(demo):
            message = (
                f"`{demo.name}` has {len(demo)} steps, and the window reaches from {window.start} to {window.stop}"
            )
            raise OntoError.of("DEM008", message, "draw windows from the file that they are replayed with", file.path)
        return demo

    def home(self, seed: int) -> Snapshot:
        """The whole state after LIBERO's own reset with ``seed``: the fixtures of that seed."""
        if seed not in self._homes:
            self._native.reset_seeded(seed)
            self._homes[seed] = self._native.snapshot()
        return self._homes[seed]

    def success(self, state: Snapshot) -> bool:
        """LIBERO's verdict on ``state``, forwarded first; raises ``SIM004`` if it is another scene's."""
        self._native.restore(state)
        return self._native.success()

    def close(self) -> None:
        """Free the native environment."""
        self._native.close()
