"""Which course folder is meant: it depends on where one works."""

from __future__ import annotations

from pathlib import Path

from tutorial import paths
from tutorial.paths import PACKAGE, SHIPPED, find_home


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


def test_a_folder_that_one_may_not_look_into_is_passed_over(tmp_path, monkeypatch):
    is_dir = Path.is_dir

    def may_look(path):
        if path.parent == tmp_path:
            raise PermissionError(13, "Permission denied", str(path))
        return is_dir(path)

    monkeypatch.setattr(Path, "is_dir", may_look)
    assert find_home(tmp_path / "mine") == PACKAGE.parent


def test_a_strangers_folder_is_passed_over(tmp_path, monkeypatch):
    course = make_course(tmp_path / "mine")
    monkeypatch.setattr(paths, "ROOT", -1)
    monkeypatch.setattr("os.getuid", lambda: course.stat().st_uid + 1)
    assert find_home(course) == PACKAGE.parent
