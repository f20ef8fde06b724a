"""The broken programs of step 9: the doctor names the fault of each."""

import pytest
from sensor_msgs.msg import JointState

from tutorial.errors import TutorialError
from tutorial.notebook import open_node, start_fault, stop_fault, until
from tutorial.ros.chaos.stream import JOINTS
from tutorial.ros.doctor.examine import examine
from tutorial.ros.doctor.report import report
from tutorial.ros.doctor.rules import diagnose
from tutorial.system.paths import HOME

CAUSES = ["name", "type", "silent", "domain", "reliability", "late", "clock", "unknown"]

pytestmark = pytest.mark.process


@pytest.mark.parametrize("cause", CAUSES)
async def test_the_doctor_names_the_fault(domain, cause):
    number = CAUSES.index(cause) + 1
    topic = f"/tank{number}/joint_state"
    await start_fault(number)
    open_node("viewer").create_subscription(JointState, topic, lambda _: None, 1)
    facts = await examine(topic, lambda: open_node("_asker"), JOINTS)
    assert [each.name for each in diagnose(facts)][:1] == [cause], report(facts)


async def test_a_repaired_program_publishes(domain):
    heard = []
    open_node("viewer").create_subscription(JointState, "/tank3/joint_state", heard.append, 1)
    source = (HOME / "notebooks" / "faults" / "tank3.py").read_text()
    broken = await start_fault(3)
    await start_fault(3, source.replace("time.sleep(0.1)", "rclpy.spin_once(node)"))
    await until(lambda: heard)
    assert broken.status is not None
    stop_fault()
    stop_fault()


async def test_a_number_without_a_fault():
    with pytest.raises(TutorialError, match=r"there is no fault 9\. The faults are numbered 1 to 8\."):
        await start_fault(9)
