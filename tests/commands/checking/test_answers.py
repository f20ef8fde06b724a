"""Finding the statements in a notebook that make up an answer."""

import pytest

from tutorial.commands.checking.answers import cells_of, find_answers, find_driver
from tutorial.system.paths import HOME

EXERCISES = {"aim": "HeldJoint", "by_name": "match_by_name"}
IMPORT = "from tutorial.checks.tank_controller import aim"


def answers(*cells):
    return {answer.exercise: answer for answer in find_answers(cells, EXERCISES)}


def value(*cells):
    """Return the answer to `aim`. These answers are numbers, which are easier to compare than classes."""
    return answers(IMPORT, *cells)["aim"].define()


def test_the_definition_at_the_check_counts():
    assert value("HeldJoint = 1", "await aim.check(HeldJoint)", "HeldJoint = 2") == 1
    assert value("HeldJoint = 1", "HeldJoint = 2", "await aim.check(HeldJoint)") == 2
    assert value("await aim.check(HeldJoint)", "HeldJoint = 3") == 3  # run in another order


def test_without_a_check_the_name_counts():
    assert value("HeldJoint = 1", "HeldJoint = 2") == 2
    assert answers("def match_by_name(): return 5")["by_name"].define()() == 5
    assert answers("x = 1") == {}


def test_the_last_matching_check_counts():
    assert value("HeldJoint = 1", "await aim.check(HeldJoint)", "Other = 2", "await aim.check(Other)") == 1
    assert value("Other = 2", "await aim.check(Other)") == 2
    assert value("def make(n): return n", "aim.check(answer=make(4))") == 4
    assert answers("from tutorial.checks.tank_controller import aim as a\nHeldJoint = 6\na.check(HeldJoint)")["aim"]
    assert answers("check.check(1)", "self.check()") == {}


def test_an_answer_brings_only_what_it_needs():
    found = answers(
        "import math\nimport os",
        "STEP = 0.1\nUNUSED = 1 / 0",
        "def half(x):\n    return x / 2 * STEP",
        "class Base:\n    def f(self): return half(math.tau)",
        "raise RuntimeError('no other cell runs')",
        "class HeldJoint(Base):\n    pass",
        f"{IMPORT}\nawait aim.check(HeldJoint)",
    )["aim"]
    assert {name for each in found.statements for name in each.binds} == {"math", "STEP", "half", "Base", "HeldJoint"}
    assert found.define()().f() == pytest.approx(0.314, abs=0.001)


def test_a_local_name_is_not_global():
    found = answers(
        "body = open_the_window()", "def match_by_name(names, body):\n    message = body\n    return message"
    )
    assert [each.binds for each in found["by_name"].statements] == [{"match_by_name"}]


def test_a_redefined_name_keeps_both_meanings():
    """A base class is looked up when the class is created, a function when it is called."""
    assert value("class V: n = 1", "class V(V): m = 2", "HeldJoint = V.n + V.m") == 3


def test_assignments_to_a_class_belong_to_it():
    cells = ("class HeldJoint: pass", "def aim_it(self): return 7", "HeldJoint.aim = aim_it", "aim.check(HeldJoint)")
    assert value(*cells)().aim() == 7
    assert value("try:\n    import nowhere\nexcept ImportError:\n    n = 8", "HeldJoint = n") == 8


def test_a_cell_with_await_is_not_run():
    found = answers("x = await something()", "HeldJoint = lambda: x")["aim"]
    with pytest.raises(NameError, match="'x'"):
        found.define()()


def test_a_failing_definition_leaves_the_previous_one():
    assert value("HeldJoint = 1", "HeldJoint = 1 / 0", "aim.check(HeldJoint)") == 1
    with pytest.raises(ZeroDivisionError):
        value("HeldJoint = 1 / 0", "aim.check(HeldJoint)")


def test_ipython_magics_are_ignored():
    assert value("%matplotlib inline\n!ls\nif True:\n    !ls\n?help\nHeldJoint = 1") == 1
    assert value("%%time\nHeldJoint = 2") == 2
    assert value("HeldJoint = '''\n%no magic\n'''") == "\n%no magic\n"


def test_a_cell_with_a_syntax_error_is_named():
    found = answers(IMPORT, "class HeldJoint\n    pass", "aim.check(HeldJoint)")["aim"]
    assert found.given is None
    assert found.unreadable == "cell 2 cannot be read: SyntaxError: expected ':'"
    assert answers(IMPORT, "other(", "aim.check(HeldJoint)")["aim"].unreadable == ""
    assert answers(IMPORT, "(" * 10_000, "class HeldJoint: \0")["aim"].given is None


def test_the_courses_notebooks_have_answers():
    names = {"aim": "HeldJoint", "drive": "GentleTank"}
    cells = cells_of((HOME / "notebooks" / "1_tank_controller.ipynb").read_text(encoding="utf-8"))
    found = find_answers(cells, names)
    assert [answer.exercise for answer in found] == ["aim", "drive"]
    assert all(len(answer.statements) <= 2 for answer in found)


def test_the_last_cell_that_writes_the_driver_counts():
    cells = ["%%writefile my_driver.py\nfirst = 1\n", "\n%%file 'my_driver.py' \nsecond = 2\n\nthird = 3", "x = 1"]
    assert find_driver(cells) == "second = 2\n\nthird = 3"


@pytest.mark.parametrize("cell", ["%%writefile straight.py\n1", "x = '%%writefile my_driver.py'\n", ""])
def test_other_cells_write_no_driver(cell):
    assert find_driver([cell]) == ""
