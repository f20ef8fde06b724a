"""Images from the cameras of a simulated world: their contents, and the threads that wait for them."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from pictures import is_red, need_pictures, red_block
from programs import TIMEOUT, until

from tutorial.body import Body
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.simulation import Simulation
from tutorial.view.camera import CameraRenderer
from tutorial.world import Placement


class Stage:
    """A world with a red block in front of a camera, and its renderer."""

    def __init__(self, folder, controllers=()):
        self.placement = Placement("Eye", red_block(folder))
        self.renderer = CameraRenderer()
        named = [("Eye", each) for each in controllers]
        self.simulation = Simulation([self.placement], named, find_camera=self.renderer.camera)
        self.body = self.simulation.bodies["Eye"]

    def move(self, aside):
        self.simulation.world.data.qpos[0] = aside


def elsewhere(function, *args):
    """Call a function like the simulation's thread, which does not wait for images."""
    with ThreadPoolExecutor(1) as pool:
        pool.submit(function, *args).result(TIMEOUT)


class Slow:
    """A receiver that blocks until the test releases it."""

    def __init__(self, eye):
        self.taken, self.entered, self.may_leave = [], threading.Event(), threading.Event()
        elsewhere(eye.capture, self)
        assert self.entered.wait(TIMEOUT)

    def __call__(self, pixels):
        self.entered.set()
        assert self.may_leave.wait(TIMEOUT)
        self.taken.append(pixels)


@pytest.fixture
def stage(tmp_path):
    made = Stage(tmp_path)
    yield made
    made.renderer.close()
    assert not any(thread.name == "camera" for thread in threading.enumerate())


@pytest.fixture
def eye(stage):
    need_pictures()
    return stage.body.camera("CAMERA")


def middle(pixels):
    height, width, _ = pixels.shape
    return pixels[height // 2, width // 2]


def test_a_red_block_is_red_in_its_place_and_the_top_row_is_first(stage, eye):
    stage.simulation.model.geom_pos[stage.simulation.model.geom("Eye/WALL").id, 2] = -4.0  # it reaches up to the middle
    taken = []
    eye.capture(taken.append)  # on the renderer's own thread, so in lockstep
    stage.move(0.9)  # to the left
    eye.capture(taken.append)
    straight, aside = taken
    assert straight.shape == aside.shape == (240, 320, 3)
    assert is_red(middle(straight))
    assert not is_red(middle(aside))
    assert is_red(aside[120, 40])
    assert not is_red(aside[120, 280])
    assert aside[230, 10, 2] > aside[10, 10, 2] + 50, "the wall is blue"


def test_the_world_goes_on_during_a_delivery_and_the_newest_request_wins(stage, eye):
    slow = Slow(eye)
    for aside in (0.9, 0.9, 0.0):
        stage.move(aside)
        elsewhere(eye.capture, slow.taken.append)
    stage.move(0.9)  # after the state was copied
    slow.may_leave.set()
    stage.body.camera("CAMERA").capture(lambda _: None)  # waits for the delivery
    assert len(slow.taken) == 2
    assert is_red(middle(slow.taken[1]))


def test_in_lockstep_a_receivers_error_is_the_controllers(tmp_path, caplog):
    need_pictures()

    class Broken(SimpleController):
        def initialize(self, io):
            self.camera = io.body.camera("SMALL")

        def control(self):
            self.camera.capture(lambda pixels: pixels.shape[7])

    stage = Stage(tmp_path, [Broken()])
    with pytest.raises(TutorialError, match=r"Broken failed at 0\.000 s"):
        stage.simulation.advance(0.002)
    assert (stage.renderer.error, caplog.text) == (None, "")  # the simulation reports it
    stage.renderer.close()


def test_on_other_threads_a_receivers_error_is_kept_and_logged_once(stage, eye, caplog):
    def broken(_):
        raise SystemExit("no")

    for _ in range(3):
        elsewhere(eye.capture, broken)
        stage.body.camera("SMALL").capture(lambda _: None)  # waits for the first one
    assert isinstance(stage.renderer.error, SystemExit)
    assert [record.getMessage() for record in caplog.records] == [
        "an image callback failed; the other callbacks continue"
    ]


def test_a_closed_camera_delivers_no_more_images(stage, eye):
    slow = Slow(eye)
    elsewhere(eye.capture, slow.taken.append)
    closing = threading.Thread(target=eye.close)
    closing.start()
    until(lambda: not stage.renderer._requests, "the drop of what waited")
    slow.may_leave.set()
    closing.join(TIMEOUT)
    assert len(slow.taken) == 1  # close() waits for a running delivery
    stage.body.camera("SMALL").capture(lambda _: None)
    assert len(slow.taken) == 1
    eye.close()
    eye.capture(lambda _: eye.close())  # a receiver may call close(), too


def test_after_close_no_image_is_taken(stage, eye):
    taken = []
    eye.capture(taken.append)
    stage.renderer.close()
    stage.renderer.close()
    eye.capture(taken.append)
    assert len(taken) == 1


def test_a_machine_that_cannot_render_is_reported_once(stage, monkeypatch, caplog):
    monkeypatch.setitem(sys.modules, "mujoco.egl", None)
    monkeypatch.setattr("platform.system", lambda: "Linux")
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    taken = []
    for name in ("CAMERA", "CAMERA", "SMALL"):
        stage.body.camera(name).capture(taken.append)
    assert taken == []
    (said,) = caplog.messages
    assert said.startswith("cameras do not work, but everything else does: rendering failed (ModuleNotFound")
    assert said.endswith("). On Debian and Ubuntu, sudo apt-get install libegl1 libgl1 fixes this problem.")


def test_cameras_have_names_and_sizes(stage):
    sizes = [(each.name, each.width, each.height) for each in map(stage.body.camera, ("CAMERA", "SMALL"))]
    assert sizes == [("CAMERA", 320, 240), ("SMALL", 64, 48)]  # the model does not set the first one's size
    with pytest.raises(TutorialError, match=r"the body 'Eye' has no camera 'SMAL'. Did you mean 'SMALL'?"):
        stage.body.camera("SMAL")


def test_a_displayed_body_takes_no_images(stage):
    with pytest.raises(
        TutorialError, match=r"displayed body 'Eye' cannot capture images\. Use the simulated body, io\.body"
    ):
        Body.displayed(stage.placement).camera("CAMERA")
