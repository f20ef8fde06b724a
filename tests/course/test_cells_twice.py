"""Running a cell twice does no harm: run every notebook in its own kernel, without a page."""

import shutil

import nbformat
import pytest
from kernels import kernel
from pictures import need_pictures
from real_ros import need_ros_for

from tutorial.system.paths import HOME

# Three runs of these take from half a minute to five minutes.
LONG = {"0_setup", "3_joint_state_subscriber", "7_pose", "8_bag_recorder", "9_nothing_arrives", "11_race"}
NOTEBOOKS = [
    pytest.param(path, marks=pytest.mark.nightly if path.stem in LONG else ())
    for path in sorted((HOME / "notebooks").glob("[0-9]*_*.ipynb"))
]

pytestmark = [pytest.mark.process, pytest.mark.timeout(600)]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_every_cell_runs_twice_in_a_row(path, domain, tmp_path, monkeypatch):
    need_ros_for(path)
    if "camera" in path.stem or "race" in path.stem:
        need_pictures()
    for part in ("notebooks", "project", "launch_py"):
        shutil.copytree(HOME / part, tmp_path / part)
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.chdir(tmp_path / "notebooks")
    cells = [cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    with kernel() as running:
        for source in cells + [source for source in cells for _ in range(2)]:
            running.run(source)
