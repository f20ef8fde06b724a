"""Step 8: record the joint states of the body."""

from datetime import datetime
from pathlib import Path
from queue import SimpleQueue
from threading import Thread

from rosbags.interfaces import Connection
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import JointState

from tutorial.controller import ControllerConfig, SimpleController


def open_bag(folder: Path, topic: str) -> tuple[Writer, Connection]:
    """Open a new bag for joint states. The bag's name contains the current time, as with `ros2 bag record`."""
    name = f"rosbag2_{datetime.now():%Y_%m_%d-%H_%M_%S}"
    bag = Writer(folder / name, version=9, storage_plugin=StoragePlugin.MCAP)  # as of Jazzy
    bag.open()
    store = get_typestore(Stores.ROS2_JAZZY)
    return bag, bag.add_connection(topic, "sensor_msgs/msg/JointState", typestore=store)


class BagRecorder(SimpleController):
    """Record the joint states that other programs publish for the body, byte for byte."""

    folder = Path()  # of the bags: the current directory

    def configure(self, config: ControllerConfig) -> None:  # main thread
        """Open a bag, start a thread that writes into it, and subscribe."""
        self.node = config.node
        topic = self.node.resolve_topic_name(f"{config.body.name}/joint_state")
        self.bag, self.connection = open_bag(self.folder, topic)
        self.received: SimpleQueue[tuple[int, bytes] | None] = SimpleQueue()
        self.writer = Thread(target=self.write, name="bag", daemon=True)
        self.writer.start()
        self.subscription = self.node.create_subscription(JointState, topic, self.on_joint_state, 1000, raw=True)

    def on_joint_state(self, payload: bytes) -> None:  # executor's thread: put it into the queue and return
        """Put the message and its time of receipt into the writing thread's queue."""
        if self.writer.is_alive():  # it ends when the disk is full
            self.received.put((self.node.get_clock().now().nanoseconds, payload))

    def write(self) -> None:  # the recorder's own thread: writing to a disk takes time
        """Write the messages from the queue into the bag until the queue yields None."""
        while received := self.received.get():
            self.bag.write(self.connection, *received)

    def unconfigure(self) -> None:  # main thread
        """Stop listening, let the thread write the remaining messages, and close the bag."""
        self.node.destroy_subscription(self.subscription)
        self.received.put(None)
        self.writer.join()
        self.bag.close()
