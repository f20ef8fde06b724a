"""One running program: its items, its threads, and what happens when they go while messages arrive."""

from __future__ import annotations

import asyncio
import logging
import random
import textwrap
import threading
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest
from geometry_msgs.msg import Pose
from programs import PATIENCE
from sensor_msgs.msg import JointState
from unruly import Unruly

from tutorial import project as project_module
from tutorial.controller import SimpleController
from tutorial.errors import TutorialError
from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import BodyItem, Project
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import ControllerError, State
from tutorial.view.bodies import View
from tutorial.view.scene import Record, Scene, unpack_records
from tutorial.world import Placement


def run_without_errors(scenario, caplog):
    """Run a scenario in whose log there is no error in the end."""
    with caplog.at_level(logging.WARNING):
        asyncio.run(scenario())
    assert not [record for record in caplog.records if record.levelno >= logging.ERROR], caplog.text


async def until(condition, what="the condition"):
    deadline = asyncio.get_running_loop().time() + PATIENCE
    while not condition():
        assert asyncio.get_running_loop().time() < deadline, f"waited in vain for {what}"
        await asyncio.sleep(0.005)


def message(position, nanoseconds, name="TURRET_Y"):
    state = JointState(name=[name], position=[position])
    state.header.stamp.sec, state.header.stamp.nanosec = divmod(nanoseconds, 1_000_000_000)
    return state


class Flood:
    """Publishes joint states as fast as it can, on a thread of its own."""

    def __init__(self):
        self._thread_node = NodeThread("flood")
        self.publisher = self._thread_node.node.create_publisher(JointState, "/Tank/joint_state", 1)
        self.count = 0
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        while not self._stop.wait(0.0005):
            self.count += 1
            self.publisher.publish(message(0.001 * (self.count % 100), self.count * 1_000_000))

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()
        self._thread_node.close()


@pytest.fixture
def step3(domain):
    return Project.load(find_project("step3"))


@pytest.fixture
def fleet(domain):
    """Four tanks in one viewer."""
    project = Project.load(find_project("fleet"))
    return replace(project, bodies=project.bodies[:4])


def lines(scene):
    """What stands below the view."""
    return [text.decode() for kind, text in unpack_records(scene.snapshot()) if kind is Record.LINE]


def threads():
    return {thread for thread in threading.enumerate() if not thread.name.startswith("Dummy")}


def test_a_message_moves_the_displayed_body_on_the_main_thread(step3):
    async def scenario():
        async with Host(step3) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                seen_on = []
                host.bodies["Tank"].on_change(lambda report: seen_on.append((threading.current_thread(), str(report))))
                publisher.publish(message(0.5, 1))
                await until(lambda: seen_on, "the update")
                assert seen_on == [(threading.main_thread(), "1 joint shown")]
                assert host.bodies["Tank"].joint("TURRET_Y").position == 0.5
                assert host.record()["report"]["matched"] == 1

    before = threads()
    asyncio.run(scenario())
    assert threads() == before, "no thread is left"


@pytest.mark.parametrize(("project", "close_up"), [("step3", True), ("step7_viewer", False), ("step7", False)])
def test_robots_alone_are_looked_at_closely_and_in_a_laboratory_from_where_all_is_seen(domain, project, close_up):
    async def camera(*names):
        scene = Scene()
        chosen = Project.load(find_project(project))
        bodies = tuple(item for item in chosen.bodies if item.placement.name in names) or chosen.bodies
        async with Host(replace(chosen, bodies=bodies), view=View(scene)):
            return [payload for kind, payload in unpack_records(scene.snapshot()) if kind is Record.CAMERA]

    furnished = Scene()
    View(furnished)
    usual = [payload for kind, payload in unpack_records(furnished.snapshot()) if kind is Record.CAMERA]
    assert (asyncio.run(camera()) != usual) == close_up
    assert asyncio.run(camera("Tank")) != usual, "the tank alone"


def test_of_two_publishers_one_is_followed_until_it_goes_and_both_are_named(step3, caplog):
    topic = "/Tank/joint_state"

    async def scenario():
        view = View(scene := Scene())
        async with Host(step3, view=view) as host:
            joint = host.bodies["Tank"].joint("TURRET_Y")
            subscription = host.controllers["JointStateSubscriber"].subscription

            async def say(publisher, position, milliseconds):
                before = host.record()["report"]
                publisher.publish(message(position, milliseconds * 1_000_000))
                await until(lambda: host.record()["report"] != before, "the update")
                return joint.position

            with NodeThread("one") as one, NodeThread("other") as other:
                first, second = (each.node.create_publisher(JointState, topic, 1) for each in (one, other))
                await until(lambda: subscription.get_publisher_count() == 2, "both publishers")
                await until(lambda: host.node.count_publishers(topic) == 2, "the graph")
                await until(lambda: first.get_subscription_count() and second.get_subscription_count(), "the match")
                for i in range(1, 30):  # like stamps, 3 ms apart
                    assert await say(first, 0.5, 20 * i) == 0.5
                    assert await say(second, -0.5, 20 * i + 3) == 0.5
                host.refresh()
                *_, line = (payload for kind, payload in unpack_records(scene.snapshot()) if kind is Record.LINE)
                said = f"2 publish on {topic}, one is followed: /one, /other"
                assert line.decode().startswith(f"Tank: 1 joint shown; {said}")
                one.close()
                await until(lambda: subscription.get_publisher_count() == 1, "one alone")
                assert await say(second, -0.5, 600) == -0.5
                assert host.record()["report"]["another"] == 29
                return said

    with caplog.at_level(logging.WARNING):
        said = asyncio.run(scenario())
    assert [text for text in caplog.messages if "publish on" in text] == [f"Tank: {said}"]


def test_a_body_may_be_deleted_while_messages_arrive(step3, caplog):
    async def scenario():
        scene = Scene()
        view = View(scene)
        async with Host(step3, view=view) as host:
            run = asyncio.ensure_future(host.run())
            with Flood() as flood:
                await until(lambda: host.bodies["Tank"].joint("TURRET_Y").position > 0, "the first updates")
                body = host.bodies["Tank"]
                host.remove("Tank")
                pose = body.qpos.copy()
                sent = flood.count
                await until(lambda: flood.count > sent + 200, "more messages")
                assert host.bodies == {}
                assert view.names == ()
                assert (body.qpos == pose).all(), "what was posted for it does not run any more"
                await until(lambda: not host.node.count_subscribers("/Tank/joint_state"), "the subscription's end")
                assert not run.done()
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run

    run_without_errors(scenario, caplog)


def test_a_body_may_go_and_come_again_while_messages_arrive(step3, caplog):
    async def scenario():
        view = View(Scene())
        async with Host(step3, view=view) as host:
            run = asyncio.ensure_future(host.run())
            with Flood():
                for _ in range(3):
                    turret = host.bodies["Tank"].joint("TURRET_Y")
                    await until(lambda turret=turret: turret.position > 0, "the updates")
                    host.remove("Tank")
                    host.add(step3.bodies[0])
                    assert view.names == ("Tank",)
            await until(lambda: host.node.count_subscribers("/Tank/joint_state") == 1, "the end of the others")
            record = host.record()
            assert record["topics"]["/Tank/joint_state"]["applied"] == record["report"]["matched"] >= 3
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run

    run_without_errors(scenario, caplog)


def test_a_body_is_added_only_where_it_can_be(step3, domain):
    async def scenario():
        [item] = step3.bodies
        unfit = BodyItem(replace(item.placement, name="Other"), (*item.controllers, Unfit))
        async with Host(step3, view=View(Scene())) as host:
            with pytest.raises(TutorialError, match=r"there is a body 'Tank' already\. Remove it first"):
                host.add(item)
            with pytest.raises(TutorialError, match="Unfit could not join Other"):
                host.add(unfit)
            assert list(host.bodies) == ["Tank"]
            await until(lambda: not host.node.count_subscribers("/Other/joint_state"), "the end of its subscription")
        with pytest.raises(TutorialError, match=r"this program is closed\."):
            host.add(item)
        async with Host(Project.load(find_project("step2"))) as host:
            with pytest.raises(TutorialError, match="'Other' comes too late: a simulated world is made of the bodies"):
                host.add(unfit)

    asyncio.run(scenario())


def test_each_body_of_a_fleet_follows_its_own_messages(fleet):
    sent = {  # one in order, one shuffled, one with a name that is no joint's; and what they come to
        "Tank_1": (JointState(name=["TURRET_Y", "TURRET_P"], position=[0.1, 0.2]), [0.1, 0.2]),
        "Tank_2": (JointState(name=["TURRET_P", "TURRET_Y"], position=[0.3, 0.4]), [0.4, 0.3]),
        "Tank_3": (JointState(name=["TURRET_P", "TRACK"], position=[0.5, 0.6]), [0.0, 0.5]),
    }

    async def scenario():
        view = View(scene := Scene())
        async with Host(fleet, view=view) as host:
            with NodeThread("tester") as tester:
                publishers = {}
                for i, name in enumerate(sent):
                    sent[name][0].header.stamp.nanosec = 4 - i  # nobody's stamp makes another's message late
                    publishers[name] = tester.node.create_publisher(JointState, f"/{name}/joint_state", 1)
                    await until(publishers[name].get_subscription_count, "the match")

                def said():
                    for name, publisher in publishers.items():
                        publisher.publish(sent[name][0])
                    host.refresh()
                    return lines(scene)[-1]

                await until(lambda: said().startswith("2 of 4 bodies follow their messages | Tank_3: 1 j"), "the line")
                assert "unknown 'TRACK'" in said()
                assert said().endswith("| Tank_4: nothing has come on /Tank_4/joint_state yet")
            for name, (_, positions) in sent.items():
                assert [joint.position for joint in host.bodies[name].joints] == positions
            report = host.record()["report"]
            assert report["unknown"] > 0
            assert report["late"] == 0

    asyncio.run(scenario())


def test_an_unknown_body_is_named_with_the_nearest(step3):
    async def scenario():
        async with Host(step3) as host:
            host.remove("Tnak")

    with pytest.raises(TutorialError, match=r"there is no body 'Tnak'\. Did you mean 'Tank'\?"):
        asyncio.run(scenario())


def test_a_simulated_body_may_be_deleted_while_it_is_stepped(domain):
    async def scenario():
        async with Host(Project.load(find_project("step2"))) as host:
            run = asyncio.ensure_future(host.run())
            await until(lambda: host.simulation.step > 50, "the first steps")
            host.remove("Tank")
            step = host.simulation.step
            await until(lambda: host.simulation.step > step + 50, "more steps")
            run.cancel()
            with pytest.raises(asyncio.CancelledError):
                await run
            assert host.simulation.error is None

    asyncio.run(scenario())


@pytest.fixture
def hanging(domain, monkeypatch):
    """A project whose tank has a controller that does not return, and the event that says that it is there."""
    monkeypatch.setattr("tutorial.simulation.STUCK", 0.2)
    monkeypatch.setattr("tutorial.host.HUNG", 0.2)
    there, let = threading.Event(), threading.Event()

    class Hangs(SimpleController):
        def control(self):
            there.set()
            let.wait(60)

    before = threads()
    project = Project.load(find_project("step2"))
    bodies = tuple(replace(item, controllers=(*item.controllers, Hangs)) for item in project.bodies)
    yield replace(project, bodies=bodies), there
    let.set()
    for thread in threads() - before:
        thread.join(PATIENCE)
        assert not thread.is_alive()


def test_a_controller_that_does_not_return_holds_up_neither_remove_nor_close(hanging):
    project, there = hanging

    async def scenario():
        async with Host(project, view=View(Scene())) as host:
            run = asyncio.ensure_future(host.run())
            await until(there.is_set, "the first step")
            with pytest.raises(ControllerError, match=r"Hangs does not return: it is at test_host\.py, line \d+, in c"):
                host.remove("Tank")
            assert list(host.bodies) == ["Labo"], "the displayed body is gone nevertheless"
            with pytest.raises(ControllerError, match="Mend it, and make the simulation anew: open its program again"):
                await run
            host.remove("Labo")
            assert host.bodies == {}
            with pytest.raises(ControllerError, match="Hangs does not return"):
                await host.run()
            assert "Hangs does not return" in str(host.error), "a start that is refused forgets nothing"

    asyncio.run(scenario())


def test_a_run_with_a_duration_ends_where_a_controller_does_not_return(hanging):
    async def scenario():
        async with Host(hanging[0]) as host:
            with pytest.raises(ControllerError, match="Hangs does not return"):
                await asyncio.wait_for(host.run(1.0), PATIENCE)

    asyncio.run(scenario())


def test_a_program_may_be_closed_while_it_runs(step3):
    async def scenario():
        host = Host(step3, view=View(Scene()))
        run = asyncio.ensure_future(host.run())
        await asyncio.sleep(0.05)
        host.close()
        await asyncio.wait_for(run, PATIENCE)
        with pytest.raises(TutorialError, match=r"this program is closed\. Open it again\."):
            await host.run(0.1)

    asyncio.run(scenario())


def test_a_simulating_program_shows_its_copy(domain):
    async def scenario():
        async with Host(Project.load(find_project("step2"))) as host:
            start = host.bodies["Tank"].qpos.copy()
            progress = []
            await host.run(0.3, progress=progress.append)
            assert host.seconds == pytest.approx(0.3)
            assert progress == sorted(progress)
            assert not (host.bodies["Tank"].qpos == start).all()
            assert (host.bodies["Tank"].qpos == host.simulation.bodies["Tank"].qpos).all()
            assert host.record()["topics"]["/Tank/joint_state"]["published"] == 15

    asyncio.run(scenario())


def test_what_is_wrong_with_the_messages_is_one_throttled_line(step3, caplog):
    async def scenario():
        async with Host(step3) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 10)
                await until(publisher.get_subscription_count, "the match")
                for i in range(1, 20):
                    publisher.publish(message(0.1, i, name="TURET_Y"))
                    await until(lambda i=i: host.record()["report"]["unknown"] == i, "the update")

    with caplog.at_level(logging.WARNING):
        asyncio.run(scenario())
    assert caplog.text.count("unknown 'TURET_Y'. Did you mean 'TURRET_Y'?") == 1


class Naive(SimpleController):
    """The naive callback of step 3: it touches the display from the executor's thread."""

    def configure(self, config):
        self.body = config.body
        self.node = config.node
        topic = f"{config.body.name}/joint_state"
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1)

    def on_joint_state(self, message):
        self.body.set_joint_positions({"TURRET_Y": 1.0})

    def unconfigure(self):
        self.node.destroy_subscription(self.subscription)


class Unfit(SimpleController):
    def configure(self, config):
        raise ValueError("mine")


@pytest.fixture
def project_with(domain, tmp_path, monkeypatch):
    """A project whose tank has a controller of the test's own."""

    def make(controller):
        monkeypatch.setattr(project_module, "find_controller", lambda _: controller)
        path = tmp_path / "project.yaml"
        models = Path(find_project("step3")).parent / "models"
        path.write_text(
            textwrap.dedent(f"""
            bodies:
              - name: Tank
                model: {models}/tank.xml
                controllers: [Mine]
            """)
        )
        return Project.load(path)

    return make


def test_the_naive_callback_is_told_whose_the_body_is(project_with, caplog):
    async def scenario():
        async with Host(project_with(Naive)) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                publisher.publish(message(0.1, 1))
                await until(lambda: "WrongThreadError" in caplog.text, "the error")
                assert host.bodies["Tank"].joint("TURRET_Y").position == 0.0

    asyncio.run(scenario())
    assert (
        "set_joint_positions was called on the thread 'executor', but the body 'Tank' belongs to the thread "
        "'MainThread'. Post the call instead: call_later(f, message)."
    ) in caplog.text


class Poser(SimpleController):
    """Publishes a message that has a position, and is no joint state."""

    def configure(self, config):
        config.node.create_publisher(Pose, "pose", 1).publish(Pose())


class Clumsy(SimpleController):
    """Fails once, as a posted call and as a callback."""

    def configure(self, config):
        config.call_later(lambda: 1 / 0)
        config.node.create_subscription(JointState, "Tank/joint_state", lambda message: {}["mine"], 1)


def test_a_message_without_a_header_is_recorded_too(project_with):
    async def scenario():
        async with Host(project_with(Poser)) as host:
            record = host.record()
            assert record["topics"]["/pose"]["published"] == 1
            assert list(record["joints"]) == list(host.bodies["Tank"].joint_names)

    asyncio.run(scenario())


class Leaver(SimpleController):
    """Wants to end the program when it leaves its body."""

    def unconfigure(self):
        raise SystemExit("mine")


def test_a_controller_that_wants_to_end_the_program_does_not(project_with, caplog):
    async def scenario():
        async with Host(project_with(Leaver)):
            pass

    asyncio.run(scenario())
    assert "Leaver of Tank failed in unconfigure()" in caplog.text
    assert "SystemExit: mine" in caplog.text


def test_a_new_run_forgets_what_failed_before(project_with):
    async def scenario():
        scene = Scene()
        async with Host(project_with(Clumsy), view=View(scene)) as host:
            with NodeThread("tester") as tester:
                publisher = tester.node.create_publisher(JointState, "/Tank/joint_state", 1)
                await until(publisher.get_subscription_count, "the match")
                await until(lambda: isinstance(host.error, ZeroDivisionError), "the posted call's error")
                publisher.publish(message(0.1, 1))
                await until(lambda: isinstance(host.error, KeyError), "the callback's error")
            await host.run(0.01)
            assert host.error is None

    asyncio.run(scenario())


def test_a_controller_that_cannot_join_its_body_is_named_and_nothing_is_left(project_with):
    before = threads()

    async def scenario():
        async with Host(project_with(Unfit)):
            pass

    with pytest.raises(
        TutorialError, match=r"Unfit could not join Tank: test_host.py, line \d+, in configure: ValueError: mine"
    ):
        asyncio.run(scenario())
    assert threads() == before


def test_closing_twice_does_nothing(step3):
    async def scenario():
        host = Host(step3)
        host.close()
        host.close()

    asyncio.run(scenario())


BOX = """
<mujoco><worldbody><body name="box"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body></worldbody></mujoco>
"""


def unruly_class(rng, let, made):
    """A class of controllers that misbehave in one of all the ways that the host has to live with."""

    class Wild(Unruly):
        def __init__(self):
            methods = ("configure", "initialize", *["control"] * 3, *["called_back"] * 2, "stop", "unconfigure")
            super().__init__(rng, let, methods)
            if self.method.endswith("configure") and self.act in ("hang", KeyboardInterrupt):
                self.act = SystemExit  # what hangs on the main thread is the reader's to interrupt
            made.append(self)

        def configure(self, config):
            self.config = config
            self.perhaps("configure")
            self.timer = config.node.create_timer(0.005, self.called_back)

        def called_back(self):
            self.perhaps("called_back")

        def unconfigure(self):
            self.config.node.destroy_timer(self.timer)
            self.perhaps("unconfigure")

        def posted(self, kind):
            self.config.call_later(int)
            if kind is not None:
                self.fail(kind)

    return Wild


async def some_frames(host, rng):
    run = asyncio.ensure_future(host.run())
    await asyncio.sleep(rng.uniform(0.0, 0.1))
    rng.choice((run.cancel, run.cancel, host.close))()
    with suppress(asyncio.CancelledError):
        await run


ACTS = (
    lambda host, rng: host.run(0.02),
    lambda host, rng: host.run(0.05),
    some_frames,
    lambda host, rng: host.refresh(),
    lambda host, rng: host.simulation.start(0.01),
    lambda host, rng: host.simulation.stop(),
    lambda host, rng: host.simulation.restart(),
    lambda host, rng: host.remove("A"),
    lambda host, rng: host.remove("B"),
    lambda host, rng: host.close(),
)


def post_at_random(made, rng, over):
    """The second thread: has calls posted in the name of controllers, whether they have left or not."""
    while not over.wait(0.02):
        for each in tuple(made):
            if hasattr(each, "config"):
                each.config.call_later(each.posted, rng.choice((None, None, None, ValueError, SystemExit)))


async def live_through(seed, model):
    """Let a host live with unruly controllers; return what was raised, and what the main thread was told."""
    rng, let, over, made, told = random.Random(seed), threading.Event(), threading.Event(), [], []
    classes = [unruly_class(rng, let, made) for _ in range(3)]
    items = (BodyItem(Placement("A", model), tuple(classes[:2])), BodyItem(Placement("B", model), (classes[2],)))
    poster = threading.Thread(target=post_at_random, args=(made, random.Random(seed), over), daemon=True)
    poster.start()
    host = None
    try:
        host = Host(Project(model, items, 0.001), view=View(Scene()))
        for act in rng.choices(ACTS, k=8):
            began = time.monotonic()
            try:
                done = act(host, rng)
                if done is not None:
                    await done
            except TutorialError as error:
                told.append(str(error))
            assert time.monotonic() - began < 10
            await asyncio.sleep(0)
    except TutorialError as error:  # one could not join its body
        told.append(str(error))
    finally:
        began = time.monotonic()
        if host is not None:
            host.close()
            hanging = [each for each in made if each.hangs and each.method != "called_back"]  # that is the executor's
            assert host.simulation.state is State.ABANDONED or not hanging
            assert host.controllers == {}
        assert time.monotonic() - began < 10
        over.set()
        let.set()
        poster.join()
    return [text for each in made for text in each.raised], "".join(told)


@pytest.mark.parametrize("tens", range(20))
def test_whatever_controllers_do_a_host_ends_and_no_failure_is_unseen(tens, domain, tmp_path, monkeypatch, caplog):
    for name in ("tutorial.simulation.STUCK", "tutorial.host.HUNG", "tutorial.ros.node_thread.SpinThread.patience"):
        monkeypatch.setattr(name, 0.1)
    model = tmp_path / "box.xml"
    model.write_text(BOX)
    before = threads()
    for seed in range(10 * tens, 10 * tens + 10):
        caplog.clear()
        raised, told = asyncio.run(live_through(seed, model))
        for thread in threads() - before:
            thread.join(PATIENCE)
            assert not thread.is_alive(), f"seed {seed}: {thread}"
        assert [text for text in raised if text not in told + caplog.text] == [], f"seed {seed}"
