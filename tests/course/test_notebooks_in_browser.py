"""The notebooks in JupyterLab in a browser, run from the top to the end."""

import pytest
from browser import AS_WITHOUT
from desk import lab_desk
from lab import copy_files

from tutorial.commands.lab import trust
from tutorial.system.paths import HOME

LONGEST_FIRST = sorted((HOME / "notebooks").glob("*.ipynb"), key=lambda path: -path.stat().st_size)

pytestmark = [pytest.mark.browser, pytest.mark.timeout(400)]


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("desk")
    with lab_desk(folder, "/user/ada/", width=640, height=480, arguments=AS_WITHOUT, scale=0.25) as desk:
        copy_files(desk.lab, HOME / "notebooks", HOME / "project", HOME / "launch_py")
        trust(desk.lab.notebooks / "notebooks", data_dir=str(folder / "data"))
        yield desk


@pytest.mark.parametrize("name", [path.name for path in LONGEST_FIRST])
def test_all_cells_run_without_an_error_or_a_warning(desk, name):
    async def main():
        notebook = await desk.lab.open(desk.page, f"notebooks/{name}")
        await notebook.run_all()
        assert await notebook.errors() == []
        assert desk.witness.complaints == []
        await notebook.close()

    desk.run(main())
