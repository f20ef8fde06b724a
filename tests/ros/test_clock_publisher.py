"""A simulation's time on /clock, and nodes in other programs that follow it."""

import asyncio
from dataclasses import replace

import pytest
from programs import until

from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.ros.clock_publisher import ClockPublisher
from tutorial.ros.node_thread import NodeThread
from tutorial.simulation import Simulation
from tutorial.system.paths import find_project
from tutorial.world import Placement

SIM_TIME = ("--ros-args", "-p", "use_sim_time:=true")
STEP = 1_000_000  # [ns]


@pytest.fixture
def project(domain):
    return replace(Project.load(find_project("step2")), clock=True)


@pytest.mark.parametrize(("time_step", "every"), [(0.0001, 100), (0.001, 10), (0.0015, 6), (0.006, 1), (0.01, 1)])
def test_the_time_is_published_at_least_a_hundred_times_a_second(domain, time_step, every):
    with NodeThread("simulation") as source:
        tank = Placement("Tank", find_project("step2").parent / "models/tank.xml")
        simulation = Simulation([tank], [("", ClockPublisher(source.node))], time_step)
        simulation.advance(3 * every * time_step)
        (meter,) = source.node.meters
        assert (meter.count, meter.last.clock.nanosec) == (3, round(2 * every * time_step * 1e9))


def test_a_program_publishes_its_time_even_without_bodies(project):
    async def scenario():
        viewing = Project.load(find_project("step3"))
        async with Host(project) as simulating, Host(viewing, (*SIM_TIME, "-r", "__node:=viewer")) as viewer:
            clock = viewer.node.get_clock()
            (subscription,) = (each for each in viewer.node.subscriptions if each.topic_name == "/clock")
            until(lambda: subscription.get_publisher_count() and simulating.node.count_subscribers("/clock"), "both")
            for name in ("Labo", "Tank"):
                simulating.remove(name)
            until(lambda: simulating.simulation.advance(0.01) or clock.now().nanoseconds > 0, "the clock")
            now = (simulating.simulation.step - 1) // 10 * 10 * STEP
            until(lambda: clock.now().nanoseconds == now, "the newest time")
            assert simulating.record()["topics"]["/clock"]["published"] == simulating.simulation.step // 10
            assert "/clock" not in viewer.record()["topics"], "the record lists only the controllers' topics"

    asyncio.run(scenario())


def test_two_clock_publishers_are_reported_once(project, caplog):
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
