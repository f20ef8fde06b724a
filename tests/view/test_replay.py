"""Saving a run as a page, and the replay on the page."""

import base64
import gzip
import math
import re

import mujoco
import numpy as np
import pytest
from browser import Witness, chromium, open_browser
from loops import in_a_loop
from scenes import commands
from sensor_msgs.msg import Joy

from tutorial.errors import TutorialError
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import find_project
from tutorial.view.bodies import View
from tutorial.view.replay import ReplayRecorder, recorded
from tutorial.view.scene import Scene

BALL = mujoco.MjModel.from_xml_string(
    "<mujoco><worldbody><body name='ball'><freejoint name='Ball/x'/><geom size='0.1'/></body></worldbody></mujoco>"
)
PATH = "/Bodies/Ball/ball"


class Stage:
    """A scene with a ball, a clock that the test sets, and a recorder."""

    def __init__(self, **options):
        self.time = 5.0
        self.scene = Scene()
        self.view = View(self.scene)
        self.view.add("Ball", BALL)
        self.data = mujoco.MjData(BALL)
        self.recorder = ReplayRecorder(self.scene, lambda: self.time, lambda: {"Ball x": self.data.qpos[0]}, **options)

    def move(self, time, x):
        self.time = 5.0 + time
        self.data.qpos[0] = x
        mujoco.mj_kinematics(BALL, self.data)
        self.view.update("Ball", self.data)
        self.view.flush()

    def stop(self, time):
        self.time = 5.0 + time
        return self.recorder.stop()


def clips(made):
    """Return the animation in a replay, by path: (name, times, values) of each track."""
    (animation,) = [command for command in commands(made.scene) if command["type"] == "set_animation"]
    return {
        each["path"]: [
            (track["name"], track["times"].tolist(), list(track["values"])) for track in each["clip"]["tracks"]
        ]
        for each in animation["animations"]
    }


def test_moving_objects_have_poses_and_rest_until_they_move():
    stage = Stage()
    for time, x in ((0.1, 0.5), (2.0, 1.0), (2.03, 1.5)):
        stage.move(time, x)
    made = stage.stop(3.0)
    (_, times, places), (_, _, turns) = clips(made)[PATH]
    assert times == pytest.approx([0, 0.067, 0.1, 1.967, 2.0, 2.03], abs=1e-3)
    assert places[::3] == [0, 0, 0.5, 0.5, 1.0, 1.5]
    assert turns[:4] == [0, 0, 0, 1]
    assert made.times[-1] == pytest.approx(3.0)
    assert made.joints["Ball x"][-1] == 1.5
    assert clips(Stage().stop(2.0)) == {}  # nothing has moved


def test_objects_are_visible_while_they_exist():
    stage = Stage()
    stage.move(1.0, 0.5)
    stage.view.remove("Ball")
    stage.view.add("Late", BALL)
    stage.view.flush()
    sights = {path.split("/")[2]: track for path, (track, *_) in clips(stage.stop(2.0)).items()}
    assert sights["Ball"] == (".visible", [0.0, 1.0], [True, False])
    assert sights["Late"] == (".visible", [0.0, 1.0], [False, True])


def test_nan_is_not_in_the_page():
    stage = Stage()
    stage.scene.send_message({"type": "set_transform", "path": PATH, "matrix": np.full(16, np.nan)})
    stage.move(0.5, math.nan)
    stage.move(1.0, 0.5)
    made = stage.stop(1.5)
    assert math.isnan(made.joints["Ball x"][1]) or math.isnan(made.joints["Ball x"][2])
    assert clips(made)[PATH][0][2][::3][-1] == 0.5
    (timeline,) = re.findall(r'class="timeline">([^<]*)<', made.figure("Ball"))
    assert "NaN" not in gzip.decompress(base64.b64decode(timeline)).decode()


def test_a_joint_that_ends_stale_has_its_colour_in_the_replay():
    stage = Stage()
    stage.view.show_stale("Ball", ["x"])
    stage.view.flush()

    def coloured(message):
        return [each for each in commands(message) if each["path"].startswith(PATH) and each.get("property") == "color"]

    assert coloured(stage.scene.snapshot())
    assert not coloured(stage.stop(1.0).scene)


def test_pauses_are_shortened():
    stage = Stage(longest_pause=1.0)
    for second in range(0, 100, 10):
        stage.move(second, second)
    made = stage.stop(100.0)
    assert made.times[-1] == 10.0
    assert clips(made)[PATH][0][2][::3][-1] == 90.0


def test_titles_and_names_are_text():
    assert "<b>" not in Stage().stop(1.0).page("<b>")


@pytest.mark.parametrize(
    ("page", "why"),
    [("nowhere/out.html", r"written to .*out.html: No such file"), ("", "cannot be written to .*: Is a directory")],
)
def test_an_unwritable_page_is_an_error_before_the_run(tmp_path, page, why):
    with pytest.raises(TutorialError, match=why), recorded(Scene(), tmp_path / page, "tank", float):
        raise AssertionError("it ran")


def test_the_pages_path_is_logged(tmp_path, caplog):
    page = tmp_path / "out.html"
    with caplog.at_level("INFO"), recorded(Scene(), page, "tank", float):
        pass
    assert caplog.messages == [f"the replay is in {page}: open it in a browser"]


async def drive_step_1(path):
    """Save a run of two seconds that turns and raises the turret; return the displayed joint positions."""
    scene, shown = Scene(), []
    async with Host(Project.load(find_project("step1")), view=View(scene)) as host:
        host.controllers["TankController"].joy.put(Joy(axes=[0.0, 0.0, -0.4, 0.2]))
        with recorded(scene, path, "tank", host.shown_at, host.joint_positions):
            for _ in range(100):
                host.simulation.advance(0.02)
                host.refresh()
                shown.append(host.joint_positions())
    return shown


ANGLES = """time => {
    const {replay} = document.querySelector(".tank-replay");
    replay.slider.value = time;
    replay.slider.dispatchEvent(new Event("input"));
    const tree = replay.picture.viewer.scene_tree;
    const pose = (name) => tree.find(["Bodies", "Tank", `Tank.${name}`]).object.quaternion.toArray();
    return [["CHASSIS", "TURRET_Y", "TURRET_P"].map(pose), replay.where.textContent];
}"""


def angle(before, after, axis):
    """Return the rotation of a body relative to its parent about an axis [rad]; quaternions are (x, y, z, w)."""
    inverse, turn = np.empty(4), np.empty(4)
    mujoco.mju_negQuat(inverse, np.roll(before, 1))
    mujoco.mju_mulQuat(turn, inverse, np.roll(after, 1))
    return 2 * math.atan2(float(np.dot(turn[1:], axis)), float(turn[0]))


STATE = """() => {
    const {time, isPlaying, button} = document.querySelector(".tank-replay").replay;
    return [time, isPlaying, button.textContent];
}"""
PLAY_TWICE = """() => {
    const {replay} = document.querySelector(".tank-replay"), seek = replay.seek.bind(replay);
    window.steps = 0;
    window.frames = 0;
    replay.seek = (time) => { window.steps += 1; seek(time); };
    replay.play(); replay.pause(); replay.play();
    const count = () => { window.frames += 1; requestAnimationFrame(count); };
    requestAnimationFrame(count);
}"""


async def it_plays(page, duration):
    """Press play, and check that the run plays to its end at real speed. The test sets the clock."""
    await page.clock.pause_at(3600)  # [s], later than now
    play, pause = (page.get_by_role("button", name=name, exact=True) for name in ("Play", "Pause"))
    await play.click()
    await page.clock.run_for(400)
    time, *doing = await page.evaluate(STATE)
    assert time == pytest.approx(0.4, abs=0.05)
    assert doing == [True, "Pause"]
    await pause.click()
    await page.clock.run_for(400)
    assert await page.evaluate(STATE) == [time, False, "Play"]
    await page.evaluate(PLAY_TWICE)
    await page.clock.run_for(200)
    assert 10 <= await page.evaluate("steps") <= 1.5 * await page.evaluate("frames"), "it plays at double speed"
    await pause.click()
    assert (await page.evaluate(STATE))[0] == pytest.approx(time + 0.2, abs=0.05)
    await play.click()
    await page.clock.fast_forward(1000 * duration)  # as if the machine had been asleep
    assert await page.evaluate(STATE) == [duration, False, "Play"]
    await play.click()
    await page.clock.run_for(200)
    await page.get_by_role("slider", name="time").press("End")
    assert await page.evaluate(STATE) == [duration, False, "Play"]


@pytest.mark.browser
@pytest.mark.timeout(300)
@in_a_loop
async def test_the_page_shows_the_joints_of_the_run(domain, tmp_path):
    path, browser = tmp_path / "viewer.html", chromium()
    driven = await drive_step_1(path)
    async with open_browser(browser) as page:
        witness = Witness(page)
        await page.clock.install(time=0)
        await page.goto(path.as_uri())
        await page.wait_for_function("document.querySelector('.tank-replay')?.replay?.picture")
        times, joints = await page.evaluate(
            "(({times, joints}) => [times, joints])(document.querySelector('.tank-replay').replay)"
        )
        for share in (0.3, 0.6, 1.0):
            frame = round(share * (len(times) - 1))
            (chassis, turret, barrel), words = await page.evaluate(ANGLES, times[frame])
            shown = [angle(chassis, turret, (0, 0, -1)), angle(turret, barrel, (0, -1, 0))]
            kept = {name: joints[name][frame] for name in driven[0]}
            assert shown == pytest.approx(list(kept.values()), abs=1e-3)
            assert any(kept == pytest.approx(each, abs=1e-5) for each in driven)
            assert f"TURRET_Y {kept['Tank TURRET_Y']:.3f}" in words
        assert kept == pytest.approx(driven[-1], abs=1e-5)
        await it_plays(page, times[-1])
        assert not witness.complaints
        assert all(url.startswith(("file:", "blob:", "data:")) for url in witness.requests)
