"""What counts as an answer."""

import pytest

from tutorial.checks.engine.answer import files_of, is_empty, name_of
from tutorial.checks.engine.memory_node import MemoryNode

EMPTY = ("...", "'Yours.'", "raise NotImplementedError", "raise NotImplementedError('yours')", "return None")
WRITTEN = ("return 1", "print()", "return {}")


@pytest.mark.parametrize("body", EMPTY + WRITTEN)
def test_what_counts_as_empty(body):
    namespace = {}
    exec(f"def f(self): {body}", namespace)
    assert is_empty(namespace["f"]) == (body in EMPTY)


def test_names():
    assert [name_of(each) for each in (len, int, 1)] == ["len", "int", "int"]


def test_functions_of_the_engine_are_not_the_answers():
    class Keeps:
        kept = MemoryNode.create_timer

        def own(self):
            pass

    assert files_of(Keeps) == {__file__}
