"""The notebooks in JupyterLab in a browser, from the first cell to the last, by Shift+Enter."""

import pytest
from browser import AS_WITHOUT
from desk import lab_desk
from lab import copy_files
from real_ros import need_ros_for
from screen import Learner

from tutorial.commands.lab import trust
from tutorial.system.paths import HOME

# These wait for messages that never arrive, or for real time, which takes one to two minutes.
WAITING = {"8_bag_recorder", "9_nothing_arrives", "11_race"}
LONGEST_FIRST = [
    pytest.param(path, marks=pytest.mark.nightly if path.stem in WAITING else ())
    for path in sorted((HOME / "notebooks").glob("*.ipynb"), key=lambda path: -path.stat().st_size)
]

pytestmark = [pytest.mark.browser, pytest.mark.screen, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    with lab_desk(folder, "/user/ada/", width=1280, height=720, arguments=AS_WITHOUT, scale=0.25) as desk:
        copy_files(desk.lab, HOME / "notebooks", HOME / "project", HOME / "launch_py")
        trust(desk.lab.notebooks / "notebooks", data_dir=str(folder / "data"))
        yield desk


@pytest.mark.parametrize("path", LONGEST_FIRST, ids=lambda path: path.name)
def test_shift_enter_runs_every_cell_with_its_effect_on_the_screen(desk, path):
    """Two rules decide which effects a learner looks at, and neither needs a mark in the notebook.

    If something moves in a 3D view, the view has to be on the screen while the cell runs, and when it is done. If a
    *What you should see* describes the output of a cell above it, the output and the description have to fit on one
    screen. It describes the nearest cell above that shows something, back to the previous *What you should see* or a
    heading.
    """
    need_ros_for(path)

    async def main():
        notebook = await desk.lab.open(desk.page, f"notebooks/{path.name}")
        learner = Learner(notebook, path)
        try:
            await notebook.go_to_the_top()
            for number in range(await notebook.count()):
                await learner.run_cell(number)
            assert desk.witness.complaints == []
            assert learner.missed == []
        finally:  # a page can draw only so many 3D views
            desk.witness.complaints.clear()
            await notebook.close()

    desk.run(main())
