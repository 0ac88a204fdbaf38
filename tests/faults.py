"""What a person is told when a call is refused."""

from __future__ import annotations

import pytest

from onto_compiler.problems import OntoError


def fault(call, *arguments, **options):
    """The one problem that ``call`` raises."""
    with pytest.raises(OntoError) as caught:
        call(*arguments, **options)
    (problem,) = caught.value.problems
    return problem
