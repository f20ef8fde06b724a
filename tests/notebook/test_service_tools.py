"""``ros2 service`` and ``ros2 param`` in a cell, on a real ROS 2."""

import pytest

from tutorial.notebook import param_dump, param_get, param_list, param_set, service_call, service_list
from tutorial.program.host import Host
from tutorial.program.project import Project
from tutorial.system.paths import find_project


async def test_in_a_cell_they_print_what_ros2_prints(domain, backend, capsys):
    if backend == "pocket":
        pytest.skip("the pocket ROS 2 has no services: see make test-ros2")
    async with Host(Project.load(find_project("step10"))):
        await service_list(show_types=True)
        await service_call("/Tank/set_motors", "std_srvs/SetBool", "{data: true}")
        await param_list("/tank")
        await param_set("/tank", "Tank.d_gain", 5.0)
        await param_set("/tank", "Tank.d_gain", 60.0)
        await param_get("/tank", "Tank.d_gain")
        await param_dump("tank")
    out = capsys.readouterr().out
    assert out.startswith("/Tank/reset [std_srvs/srv/Trigger]\n/Tank/set_motors [std_srvs/srv/SetBool]\n")
    assert out.endswith(PRINTED)


PRINTED = """\
requester: making request: std_srvs.srv.SetBool_Request(data=True)

response:
std_srvs.srv.SetBool_Response(success=False, message='the simulation is not running. Start it, and ask again.')

  Tank.d_gain
  Tank.p_gain
  start_type_description_service
  use_sim_time
Setting parameter failed: with a p_gain of 200, a d_gain of 5 lets the turret swing: 11.7 is enough
Set parameter successful
Double value is: 60.0
/tank:
  ros__parameters:
    Tank:
      d_gain: 60.0
      p_gain: 200.0
    start_type_description_service: true
    use_sim_time: false

"""
