"""``tank chaos``: faults from options or a script, said as they change, and an end without a trace."""

import pytest
from click.testing import CliRunner

from tutorial.commands.tank import tank
from tutorial.ros.chaos import FAULTS


def test_it_says_which_faults_hold_and_what_they_have_hit(program, tmp_path):
    path = tmp_path / "script.yaml"
    scenes = "{at: 0, for: 0.4, faults: [shuffle]}", "{at: 0.4, for: 0.4, faults: [nan, drop:0.5]}"
    path.write_text("chaos:\n" + "".join(f"  - {scene}\n" for scene in scenes))
    running = program("chaos", "--script", path)
    assert running.ends() == 0
    assert "s  shuffle 100 %\n" in running.output
    assert "s  nan 100 %, drop 50 %\n" in running.output
    assert "messages hit: shuffle 20, nan 20, drop " in running.output


def test_a_viewer_bears_it_and_ctrl_c_ends_it(program, tmp_path):
    viewer = program("run", "step3", "--headless", "--duration", 300, "--report", tmp_path)
    chaos = program("chaos", "-f", "rename", "-f", "shuffle:0.5", "--seed", 3)
    chaos.says("s  rename 100 %, shuffle 50 %\n")
    viewer.says("unknown '")
    chaos.asks_to_stop()
    assert chaos.ends() == 0
    assert "messages hit: shuffle " in chaos.output
    assert "Traceback" not in chaos.output + viewer.output
    viewer.asks_to_stop()
    viewer.ends()


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("chaos --from Tank/joint_state", "the good stream and the faults are both on '/Tank/joint_state'. Have"),
        ("chaos --script nowhere.yaml", "there is no script 'nowhere.yaml'"),
        ("chaos a-b", "topic name"),
    ],
)
def test_a_mistake_is_a_clear_error(program, command, said):
    running = program(*command.split())
    assert running.ends() == 1
    assert said in running.output
    assert "Traceback" not in running.output


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("chaos -f shufle", "there is no fault 'shufle'. Did you mean 'shuffle'?"),
        ("chaos --fault nan:2", "'2' is no share of the messages for 'nan': give a number from 0 to 1."),
        ("chaos -f nan --script x.yaml", "give either --fault or --script, not both."),
        ("chaos --duration 0", "0.0 is not in the range"),
    ],
)
def test_a_slip_of_the_pen_is_met_before_anything_starts(command, said):
    result = CliRunner().invoke(tank, command.split(), obj=[])
    assert result.exit_code == 2
    assert said in result.output


def test_help_explains_every_fault():
    result = CliRunner().invoke(tank, ["chaos", "--help"], obj=[])
    for name, what in FAULTS.items():
        assert f"    {name:10} {what}\n" in result.output
