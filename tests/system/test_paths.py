"""Which course folder is meant: it depends on where one works."""

from tutorial.system import paths
from tutorial.system.paths import PACKAGE, SHIPPED, find_home


def make_course(folder):
    for part in ("launch_py", "notebooks", "project"):
        (folder / part).mkdir(parents=True)
    return folder


def test_the_nearest_course_folder_is_home_of_all_that_is_in_it(tmp_path):
    assert not SHIPPED.exists(), "as in a checkout"
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "project").mkdir()
    assert find_home(tmp_path) == PACKAGE.parent
    (tmp_path / "launch_py").mkdir()
    inner = make_course(tmp_path / "notebooks" / "mine")
    assert find_home(tmp_path) == find_home(inner.parent) == tmp_path
    assert find_home(inner) == find_home(inner / "notebooks") == inner


def test_a_strangers_folder_is_passed_over(tmp_path, monkeypatch):
    course = make_course(tmp_path / "mine")
    monkeypatch.setattr(paths, "ROOT", -1)
    monkeypatch.setattr("os.getuid", lambda: course.stat().st_uid + 1)
    assert find_home(course) == PACKAGE.parent
