"""Building interface packages: they can be used, or an error explains why one cannot be built."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from programs import marked, until

from tutorial.commands.package import _write
from tutorial.commands.packaging import contents
from tutorial.commands.packaging.contents import make_interfaces
from tutorial.errors import TutorialError
from tutorial.ros.wheels import folder, interfaces
from tutorial.ros.wheels.definitions import find_mistake
from tutorial.ros.wheels.interfaces import build_interfaces
from tutorial.system.paths import HOME

PAGE = (HOME / "book/own_interfaces.md").read_text(encoding="utf-8")
JAZZY = {
    "action/LookupTransform": "RIHS01_0b8adf6bc0b5958879e3265b41a457e03558fe523890a81252c70eba97a82c5d",
    "msg/TF2Error": "RIHS01_db2485e7d6a0ec75bf087e058ee45df682acc3a621ca7780503d10aac141809a",
    "msg/TFMessage": "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087",
    "srv/FrameGraph": "RIHS01_0d1fbc6222c018ba5f33822904a2fdd4063705289956d3fdde07cd8c50fe8067",
}
"""The hashes of tf2_msgs in ROS 2 Jazzy."""

builds = [pytest.mark.ros2, pytest.mark.timeout(600)]


def listings(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture(scope="module")
def prefix():
    """A copy of the real ROS 2's folder, so that nothing is built into the learner's own."""
    problem = "" if interfaces.can_build() else folder.COMPILER
    problem = problem if folder.is_complete(folder.prefix()) else folder.how_to_get_it()
    if problem:
        (pytest.fail if os.environ.get("CI") == "true" and folder.is_supported() else pytest.skip)(problem)
    with tempfile.TemporaryDirectory(dir=folder.prefix().parent) as place:
        copy = Path(place) / "ros 2 ö"  # with a blank and an umlaut, as in some home folders
        shutil.copytree(folder.prefix(), copy, symlinks=True, copy_function=os.link)
        yield copy


def package(place, name):
    _write(place / name, make_interfaces(name))
    return place / name


@pytest.fixture
def mine(tmp_path, monkeypatch):
    """A package without a maintainer."""
    monkeypatch.setattr(contents, "_ask_git", lambda _: "")
    return package(tmp_path, "mine_msgs")


@pytest.fixture(scope="module")
def built(prefix, tmp_path_factory):
    """The folder with the page's package."""
    assert build_interfaces(package(tmp_path_factory.mktemp("page"), "my_msgs"), prefix, lambda _: None) == "my_msgs"
    return prefix


def test_page_shows_the_examples(mine):
    files = ("msg/Target.msg", "srv/FindTarget.srv", "action/AimAt.action")
    assert listings("text") == [(mine / file).read_text() for file in files]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("std_msgs", "ROS 2 already has a package 'std_msgs'. Choose a different name, such as 'my_std_msgs'"),
        ("tf2_msgs", "ROS 2 already has a package 'tf2_msgs'"),
        ("numpy", "Python already has a module or keyword 'numpy'"),
        ("MyMsgs", "Did you mean 'my_msgs'?"),
        ("", "is not a valid package name"),
    ],
)
def test_unusable_name(mine, tmp_path, name, said):
    (folder.site_packages(tmp_path) / "ros_std_msgs-5.3.6.dist-info").mkdir(parents=True)
    described = mine / "package.xml"
    described.write_text(described.read_text().replace("mine_msgs", name))
    with pytest.raises(TutorialError, match=re.escape(said)):
        build_interfaces(mine, tmp_path, lambda _: None)


@pytest.mark.parametrize("spoil", ["rm package.xml", "rm CMakeLists.txt", "broken xml", "other CMakeLists"])
def test_no_interface_package(mine, tmp_path, spoil):
    if spoil.startswith("rm "):
        (mine / spoil[3:]).unlink()
    else:
        (mine / ("package.xml" if "xml" in spoil else "CMakeLists.txt")).write_text("project(mine)")
    with pytest.raises(
        TutorialError, match=r"is not the folder of an interface package: .*--interfaces my_msgs creates such a folder"
    ):
        build_interfaces(mine, tmp_path, lambda _: None)


@pytest.mark.parametrize("missing", ["compiler", "headers"])
def test_missing_compiler(mine, tmp_path, monkeypatch, missing):
    monkeypatch.setattr(interfaces.shutil, "which", {"compiler": lambda _: None, "headers": str}[missing])
    if missing == "headers":
        monkeypatch.setattr(interfaces.sysconfig, "get_path", lambda _: "/nowhere")
    with pytest.raises(TutorialError, match=r"apt install g[+][+] python3[.]\d+-dev, or on Fedora"):
        build_interfaces(mine, tmp_path, lambda _: None)
    assert not (tmp_path / "build").exists()


class TestBuilds:
    pytestmark = builds

    @pytest.mark.parametrize(
        ("file", "content", "said"),
        [
            ("msg/Target.msg", "float64 size\nfloat46 x", "msg/Target.msg: InvalidResourceName: 'float46' is an"),
            ("msg/Target.msg", "float64 a\nfloat64 a", "Target.msg: ValueError: the fields iterable contains dupl"),
            ("msg/Target.msg", "\nuint8 A=300", "Target.msg: InvalidValue: value '300' can not be converted to typ"),
            ("msg/Target.msg", "float64 Size", "Target.msg: NameError: 'Size' is an invalid field name"),
            ("msg/Target.msg", "float64", "Target.msg: InvalidFieldDefinition: float64"),
            ("msg/Target.msg", "string \xff", "Target.msg: UnicodeDecodeError"),
            ("msg/Target.msg", "foo_msgs/Bar x", "Target.msg: there is no message foo_msgs/Bar"),
            ("msg/Target.msg", "Bar[] x", "there is no message mine_msgs/Bar"),
            ("msg/Target.msg", "sensor_msgs/Imu x", "CMakeLists.txt needs find_package(sensor_msgs REQUIRED), and"),
            ("srv/FindTarget.srv", "string name\n---\nbol found", "FindTarget.srv: InvalidResourceName: 'bol'"),
            ("srv/FindTarget.srv", "string name", "FindTarget.srv: InvalidServiceSpecification: Could not find sep"),
            ("action/AimAt.action", "string name\n---", "AimAt.action: InvalidActionSpecification: Number of '---'"),
            ("action/AimAt.action", "---\n---\nBar x", "AimAt.action: there is no message mine_msgs/Bar"),
        ],
    )
    def test_mistake(self, prefix, mine, file, content, said):
        (mine / file).write_text(content, "latin-1")
        assert said in find_mistake(mine, "mine_msgs", prefix)

    def test_no_mistake(self, prefix, mine):
        (mine / "msg/Fine.msg").write_text(
            "# A note\nuint8 A=1\nTarget[<=3] b # Note\ngeometry_msgs/Point[3] c\nstring<=9 d"
        )
        assert find_mistake(mine, "mine_msgs", prefix) == ""
        assert find_mistake(interfaces.TF2_MSGS, "tf2_msgs", prefix) == ""

    @pytest.mark.parametrize(
        ("file", "old", "new", "said"),
        [
            (
                "msg/Target.msg",
                "string",
                "strin",
                "mine_msgs could not be built: msg/Target.msg: InvalidResourceName: 'strin'",
            ),
            ("CMakeLists.txt", "(geometry_msgs", "(geometri_msgs", "there is no package 'geometri_msgs'"),
            ("CMakeLists.txt", "project(mine_msgs)", "project(other)", "'mine_msgs' .* does not match"),
            ("CMakeLists.txt", "msg/Target", "msg/Targt", "the passed file 'msg/Targt.msg' doesn't exist"),
        ],
    )
    def test_failed_build(self, prefix, mine, file, old, new, said):
        (mine / file).write_text((mine / file).read_text().replace(old, new))
        before = {path for path in prefix.rglob("*") if prefix / "build" not in path.parents}
        with pytest.raises(TutorialError) as refused:
            build_interfaces(mine, prefix, lambda _: None)
        assert re.search(re.sub(r"([()])", r"\\\1", said), str(refused.value))
        assert {path for path in prefix.rglob("*") if prefix / "build" not in path.parents} == before
        assert not (prefix / "build/scratch").exists()

    def test_interrupted_build(self, prefix, mine, monkeypatch):
        code = (
            "import sys; from pathlib import Path; from tutorial.ros.wheels.interfaces import build_interfaces as build"
        )
        words = [sys.executable, "-c", f"{code}; build(*map(Path, sys.argv[1:]), lambda _: None)", mine, prefix]
        monkeypatch.setenv("TANK_TEST_MARK", str(mine))
        monkeypatch.setenv("TMPDIR", str(mine.parent))
        with subprocess.Popen(words, stderr=subprocess.PIPE) as process:
            until(lambda: any(mine.parent.glob("tank-*/.ninja_log")), "the compiler")
            process.send_signal(signal.SIGINT)
            process.communicate()
        monkeypatch.delenv("TANK_TEST_MARK")
        assert process.returncode == -signal.SIGINT
        assert not marked(str(mine))
        assert not (prefix / "build/scratch").exists()
        assert not list(prefix.rglob("*mine_msgs*"))

    def test_dependency(self, built, mine):
        for kind in ("srv", "action"):
            shutil.rmtree(mine / kind)
        (mine / "msg/Target.msg").write_text("my_msgs/Target[] targets")
        makes = (mine / "CMakeLists.txt").read_text().replace("geometry_msgs", "my_msgs")
        (mine / "CMakeLists.txt").write_text(re.sub(r' *"(srv|action)/.*\n', "", makes))
        build_interfaces(mine, built, lambda _: None)
        code = "import mine_msgs.msg, my_msgs.msg; print(mine_msgs.msg.Target(targets=[my_msgs.msg.Target(name='a')]))"
        words = [sys.executable, "-c", code]
        variables = os.environ | {"PYTHONPATH": str(folder.site_packages(built))}
        assert "name='a'" in subprocess.run(words, env=variables, check=True, capture_output=True, text=True).stdout

    def test_programs_of_the_page(self, built, tmp_path, domain):
        server, client = listings("python")
        (tmp_path / "server.py").write_text(server)
        (tmp_path / "client.py").write_text(client)
        variables = os.environ | {
            "PYTHONPATH": str(folder.site_packages(built)),
            "PYTHONUNBUFFERED": "1",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "TUTORIAL_ROS": "rclpy",
        }
        variables.pop("RMW_IMPLEMENTATION", None)
        options = {
            "cwd": tmp_path,
            "env": variables,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.STDOUT,
            "text": True,
        }
        with subprocess.Popen([sys.executable, "server.py"], **options) as running:
            try:
                client = subprocess.run([sys.executable, "client.py"], timeout=120, check=False, **options)
            finally:
                running.kill()  # rclpy may miss a single Ctrl-C
                said, _ = running.communicate()
        (shown,) = (text for text in listings("console") if "client.py" in text)
        assert client.stdout == shown.partition("\n")[2], said
        assert said == ""

    def test_tf2_msgs_hashes(self, prefix):
        for name, jazzys in JAZZY.items():
            described = json.loads((prefix / f"share/tf2_msgs/{name}.json").read_text())
            hashes = {each["type_name"]: each["hash_string"] for each in described["type_hashes"]}
            assert hashes[f"tf2_msgs/{name}"] == jazzys
