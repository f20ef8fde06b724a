"""A simulation's time on /clock, as nodes of other programs go by it."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack
from dataclasses import replace

import pytest
from programs import until

from tutorial.host import Host
from tutorial.paths import find_project
from tutorial.project import Project
from tutorial.ros.clock_publisher import ClockPublisher
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation
from tutorial.world import Placement

SIM_TIME = ("--ros-args", "-p", "use_sim_time:=true")
STEP = 1_000_000  # [ns]


def clock_subscription(node):
    (found,) = [each for each in node.subscriptions if each.topic_name == "/clock"]
    return found


@pytest.fixture
def project(domain):
    return replace(Project.load(find_project("step2")), clock=True)


def test_nodes_and_their_timers_go_by_the_simulations_time(domain):
    calls = []
    with ExitStack() as stack:
        source = stack.enter_context(NodeThread("simulation"))
        listener = stack.enter_context(NodeThread("listener", SIM_TIME))
        clock = listener.node.get_clock()
        controller = ClockPublisher(source.node)
        tank = Placement("Tank", find_project("step2").parent / "models/tank.xml")
        simulation = Simulation([tank], [("", controller)])
        subscription = clock_subscription(listener.node)
        until(lambda: controller.publisher.get_subscription_count() and subscription.get_publisher_count(), "the match")

        def advance(messages):
            for _ in range(messages):
                simulation.advance(0.01)
                until(lambda: clock.now().nanoseconds == (simulation.step - 1) * STEP, "the clock")

        assert clock.now().nanoseconds == 0
        listener.node.create_timer(0.1, lambda: calls.append(clock.now().nanoseconds))
        simulation.advance(0.001)
        advance(100)
        until(lambda: len(calls) == 10, "the timer")
        assert calls == [100 * i * STEP for i in range(1, 11)]

        advance(5)
        simulation.stop()
        simulation = Simulation([tank], [("", controller)])
        simulation.advance(0.001)
        until(lambda: clock.now().nanoseconds == 0, "the time to jump back")
        advance(10)
        until(lambda: len(calls) == 11, "the timer")
        assert calls[-1] == 100 * STEP
        assert {meter.topic: meter.count for meter in source.node.meters} == {"/clock": 1 + 100 + 5 + 1 + 10}


@pytest.mark.parametrize(("time_step", "every"), [(0.0001, 100), (0.001, 10), (0.0015, 6), (0.006, 1), (0.01, 1)])
def test_the_clock_is_told_a_hundred_times_a_second_or_more(domain, time_step, every):
    with NodeThread("simulation") as source:
        tank = Placement("Tank", find_project("step2").parent / "models/tank.xml")
        simulation = Simulation([tank], [("", ClockPublisher(source.node))], time_step)
        simulation.advance(3 * every * time_step)
        assert source.node.meters[0].count == 3


def test_a_program_publishes_its_time_whichever_bodies_go(project):
    async def scenario():
        viewing = Project.load(find_project("step3"))
        async with Host(project) as simulating, Host(viewing, (*SIM_TIME, "-r", "__node:=viewer")) as viewer:
            clock, subscription = viewer.node.get_clock(), clock_subscription(viewer.node)
            until(lambda: subscription.get_publisher_count() and simulating.node.count_subscribers("/clock"), "both")
            for name in ("Labo", "Tank"):
                simulating.remove(name)
            until(lambda: simulating.simulation.advance(0.01) or clock.now().nanoseconds > 0, "the clock")
            now = (simulating.simulation.step - 1) // 10 * 10 * STEP
            until(lambda: clock.now().nanoseconds == now, "the newest time")
            assert simulating.record()["topics"]["/clock"]["published"] == simulating.simulation.step // 10
            assert "/clock" not in viewer.record()["topics"], "nothing that its controllers receive"

    asyncio.run(scenario())


def test_two_programs_that_publish_their_time_are_said_once(project, caplog):
    async def scenario():
        async with Host(project) as one, Host(replace(project, clock=False), ("--ros-args", "-r", "__node:=b")) as two:
            two.refresh()
            until(lambda: one.node.count_publishers("/clock") == 1, "its own")
            async with Host(project, ("--ros-args", "-r", "__node:=c")):
                until(lambda: one.refresh() or "there are 2 publishers on /clock" in caplog.text, "the warning")
                one._looked = 0.0
                one.refresh()
        assert caplog.text.count("publishers on /clock") == 1

    asyncio.run(scenario())
