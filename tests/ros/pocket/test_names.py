"""Every public name of rclpy 7.1.3, launch and tf2_ros exists with its signature, or is reported as missing."""

import inspect
import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from pkgutil import resolve_name

import pytest
from rclpy.parameter import Parameter
from std_msgs.msg import String

DATA = Path(__file__).parent / "data"
NAMES: dict[str, dict[str, list[str] | None]] = json.loads((DATA / "rclpy_names.json").read_text(encoding="utf-8"))
"""The names of each module, and the members of its classes; as the real rclpy lists them."""
SIGNATURES: dict[str, str] = json.loads((DATA / "rclpy_signatures.json").read_text(encoding="utf-8"))
"""The parameters of each existing function and method in the real rclpy, with their defaults."""


@pytest.fixture
def objects(node, spin_until):
    """One object of each class with members that only its objects have."""
    node.create_publisher(String, "x", 10)
    spin_until(lambda: node.get_publishers_info_by_topic("x"))
    return {
        "Parameter": Parameter("x", value=1),
        "Timer": node.create_timer(100.0, print),
        "TopicEndpointInfo": node.get_publishers_info_by_topic("x")[0],
    }


def refusal(ask: Callable[..., object], *arguments: object) -> str:
    """Return the error for a missing feature, or "" if it exists."""
    try:
        ask(*arguments)
    except (ImportError, AttributeError) as error:
        return str(error)
    return ""


@pytest.fixture
def need(backend):
    """Skip a test of a package that this real ROS 2 lacks, such as launch or tf2_ros."""
    return lambda name: backend == "pocket" or pytest.importorskip(name.partition(".")[0])


@pytest.mark.filterwarnings("ignore:importing 'qos_event' is deprecated:UserWarning")
@pytest.mark.parametrize("module", NAMES)
def test_every_name_answers(module, objects, need):
    need(module)
    names: dict[str, str] = {module: refusal(import_module, module)}
    for name, members in {} if names[module] else NAMES[module].items():
        there = import_module(module)
        names[name] = refusal(getattr, there, name)
        for member in [] if names[name] else members or []:
            owner = objects.get(name, getattr(there, name))
            names[f"{name}.{member}"] = refusal(getattr, owner, member)
    assert [name for name, said in names.items() if said and "Install a real ROS 2 Jazzy" not in said] == []


@pytest.mark.parametrize("name", SIGNATURES)
def test_signature(name, need):
    need(name)
    parameters = inspect.signature(resolve_name(name)).parameters.values()
    taken = (each.name if each.default is each.empty else f"{each.name}={each.default}" for each in parameters)
    assert ", ".join(taken) == SIGNATURES[name]


@pytest.mark.pocket
def test_refused_names_do_not_exist():
    from rclpy._absent import TABLE, AbsentAttribute

    places = {owner: resolve_name(owner) for owner in TABLE["attributes"]}
    names = [(owner, name, vars(places[owner]).get(name)) for owner in places for name in TABLE["attributes"][owner]]
    assert [(owner, name) for owner, name, there in names if not isinstance(there, AbsentAttribute | None)] == []
    assert [
        place for place in places.values() if isinstance(place, type) and hasattr(place, "__getattr__")
    ] == []  # slow
    assert [name for name in TABLE["modules"] if not refusal(import_module, f"rclpy.{name}")] == []
