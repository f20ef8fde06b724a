"""The beginning of every behaviour: imports and helpers."""

import math
import re
import threading
import warnings
from contextlib import suppress
from copy import copy, deepcopy
from functools import partial

import numpy
import rclpy
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy import logging
from rclpy.clock import Clock, ROSClock
from rclpy.clock_type import ClockType
from rclpy.context import Context
from rclpy.duration import Duration, Infinite
from rclpy.exceptions import *
from rclpy.executors import SingleThreadedExecutor
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import *
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future
from rclpy.time import Time
from rclpy.utilities import remove_ros_args
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_topic_name import validate_topic_name
from sensor_msgs.msg import Image, Imu, JointState, Joy, NavSatFix
from std_msgs.msg import Bool, ByteMultiArray, ColorRGBA, Empty, Float32, Header, Int8, Int32, String, UInt8


def start(*ros_args, name="t", **options):
    """Restart ROS 2 with these ROS arguments, and return a node."""
    rclpy.try_shutdown()
    rclpy.init(args=["--ros-args", *ros_args])
    return rclpy.create_node(name, **options)


def attempt(call, *args, **options):
    """Print a call's result or exception, without the lines of rcl's source in its text."""
    try:
        print(call(*args, **options))
    except Exception as error:
        print(type(error).__name__, re.sub(r"(, at \S+:\d+)+$", "", str(error)), sep=": ")


def raised(call, *args):
    """Return the type of a call's exception, if the pocket ROS 2 words it differently."""
    try:
        call(*args)
    except Exception as error:
        return type(error).__name__


def wait(node, condition):
    """Spin a node until a condition holds."""
    while not condition():
        rclpy.spin_once(node, timeout_sec=0.01)
