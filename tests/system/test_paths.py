"""The choice of the course folder: it depends on the current directory."""

from tutorial.system import paths
from tutorial.system.paths import PACKAGE, SHIPPED, find_home


def make_course(folder):
    for part in ("launch_py", "notebooks", "project"):
        (folder / part).mkdir(parents=True)
    return folder


def test_home_is_the_nearest_course_folder(tmp_path):
    assert not SHIPPED.exists(), "as in a checkout"
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "project").mkdir()
    assert find_home(tmp_path) == PACKAGE.parent
    (tmp_path / "launch_py").mkdir()
    inner = make_course(tmp_path / "notebooks" / "mine")
    assert find_home(tmp_path) == find_home(inner.parent) == tmp_path
    assert find_home(inner) == find_home(inner / "notebooks") == inner


def test_another_users_folder_is_skipped(tmp_path, monkeypatch):
    course = make_course(tmp_path / "mine")
    monkeypatch.setattr(paths, "ROOT", -1)
    monkeypatch.setattr("os.getuid", lambda: course.stat().st_uid + 1)
    assert find_home(course) == PACKAGE.parent
