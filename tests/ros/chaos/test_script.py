"""Scripts of faults."""

import pytest

from tutorial.errors import TutorialError
from tutorial.ros.chaos.script import ChaosScript

SCRIPT = """\
chaos:
  - {at: 1, for: 2, faults: [shuffle, nan:0.1]}
  - {at: 2, for: 3, faults: ["nan:0.5", "drop: 0.25"]}
"""


@pytest.fixture
def path(tmp_path):
    return tmp_path / "script.yaml"


def test_each_time_has_its_faults(path):
    path.write_text(SCRIPT)
    script = ChaosScript(path)
    assert script.duration == 5
    assert script.at(0.99) == script.at(5) == {}
    assert script.at(1) == {"shuffle": 1, "nan": 0.1}
    assert script.at(2.5) == {"shuffle": 1, "nan": 0.5, "drop": 0.25}
    assert script.at(4.99) == {"nan": 0.5, "drop": 0.25}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("nan:0.1", "nann:0.1", "line 2: there is no fault 'nann'. Did you mean 'nan'?"),
        ("nan:0.5", "nan:5", "line 3: '5' is no share of the messages for 'nan': give a number from 0 to 1."),
        ("for: 3", "four: 3", "line 3: 'four' is not known here. Did you mean 'for'?"),
        ("at: 1", "at: -1", "line 2: chaos[0].at: expected a number >= 0"),
        ("for: 3", "for: 1e300", "line 3: chaos[1].for: expected a number <= 1000000"),
        ("at: 1, ", "", "line 2: 'at' is missing here."),
    ],
)
def test_a_mistake_is_named_with_its_line(path, old, new, said):
    path.write_text(SCRIPT.replace(old, new))
    with pytest.raises(TutorialError) as error:
        ChaosScript(path)
    assert said in str(error.value)
