"""A class on one machine: a real JupyterHub whose students have private temporary folders."""

from concurrent.futures import ThreadPoolExecutor

import pytest
from hub import PROXY, Student, cells, hub

pytest.importorskip("jupyterhub", reason="make .venv/hub installs it")

pytestmark = [
    pytest.mark.nightly,
    pytest.mark.timeout(900),
    pytest.mark.skipif(not PROXY.exists(), reason="make .venv/hub installs the hub's proxy"),
]


def test_five_students_run_notebook_1_and_do_not_hear_each_other(tmp_path):
    before, _ = cells()

    def attend(name):
        student = Student(at, name)
        for cell in before:
            student.run(cell)
        student.run("await until(lambda: program.simulation.time > 1)")
        return student.run(
            "import os\nprint(os.environ['ROS_DOMAIN_ID'], os.environ['TMPDIR'], *hand.get_node_names())"
        ).split()

    names = [f"student{number}" for number in range(5)]
    with hub(tmp_path) as at, ThreadPoolExecutor(len(names)) as pool:
        attended = list(pool.map(attend, names))
    domains, folders, *_ = zip(*attended)
    assert len(set(domains)) == len(set(folders)) == len(names)
    assert [sorted(nodes) for _, _, *nodes in attended] == [["hand", "joystick", "simulation"]] * len(names)
