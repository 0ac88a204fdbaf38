from onto_compiler.bddl.compile import compile_task as compile_task
from onto_compiler.check.run import check as check
from onto_compiler.knowledge import Knowledge as Knowledge
from onto_compiler.problems import OntoError as OntoError
from runtime.commands.tasks import diagnose as diagnose
from runtime.commands.tasks import ground as ground
from runtime.commands.tasks import repair as repair
from runtime.trace.narrate import narrate as narrate
from runtime.trace.store import open_trace as open_trace

def main() -> int: ...
