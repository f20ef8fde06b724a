"""``tank chaos``: faults from options, what they have hit, and an end without a trace."""

import pytest

from tutorial.ros.chaos import FAULTS


def test_it_says_which_faults_hold_and_what_they_have_hit(tank):
    run = tank("chaos -f nan -f drop:0.5 --duration 0.8")
    assert run.status == 0
    assert run.stdout.startswith("nan 100 %, drop 50 %\nmessages hit: nan ")
    assert tank("chaos --duration 0.2").stdout == "no fault\nmessages hit: none\n"


@pytest.mark.process
def test_a_viewer_bears_it_and_ctrl_c_ends_it(program, tank):
    viewer = program("run", "step3", "--headless", "--duration", 300)
    run = tank("chaos -f rename -f shuffle:0.5 --seed 3", once=lambda: "unknown '" in viewer.output)
    assert run.status == 0
    assert "rename 100 %, shuffle 50 %\n" in run.output
    assert "messages hit: shuffle " in run.output
    assert "Traceback" not in viewer.output


def test_help_explains_every_fault(tank):
    run = tank("chaos --help")
    for name, what in FAULTS.items():
        assert f"    {name:10} {what}\n" in run.stdout
