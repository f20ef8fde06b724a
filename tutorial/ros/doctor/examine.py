"""Find out why no messages arrive on a topic, even if ROS 2 cannot be used at all."""

# ruff: noqa: PLC0415 - rclpy may not be importable, which is one of the answers

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from tutorial.errors import TutorialError
from tutorial.ros.backend import ros_backend
from tutorial.ros.doctor.facts import Facts
from tutorial.ros.doctor.machine import domain_in, participants
from tutorial.ros.doctor.rules import PLACES
from tutorial.ros.loopback import loopback_is_up

if TYPE_CHECKING:
    from rclpy.node import Node

DOMAINS = range(11)
"""The domains to search by default if the topic has no publisher in this domain."""


async def examine(
    topic: str,
    make_node: Callable[[], Node],
    joints: Iterable[str] | None = None,
    domains: Sequence[int] = DOMAINS,
) -> Facts:
    """Check whether this program can create a node, and collect the facts about a topic.

    Args:
        topic: the topic's name.
        make_node: returns the node that subscribes; it must be spinning on another thread.
        joints: the names of the viewer's joints; see `tutorial.ros.doctor.observe.observe`.
        domains: the other domains to search if nobody publishes the topic.

    Raises:
        TutorialError: the topic's name is invalid, or the node could not be created for a reason that no rule covers.
        RuntimeError: rclpy could not create the node, for a reason that no rule covers.
    """
    try:
        ros_backend()
        from tutorial.ros.doctor.observe import observe
        from tutorial.ros.topics.names import full_topic
    except (TutorialError, ImportError) as error:
        return Facts(topic, import_error=str(error))
    if not loopback_is_up():
        return Facts(topic, loopback=False)
    try:
        node = make_node()
    except (TutorialError, RuntimeError):
        domain = domain_in(os.environ)
        if (taken := participants(domain)) < PLACES:
            raise
        return Facts(topic, domain, joined=False, participants=taken)
    return await observe(node, full_topic(node, topic), joints, domains)
