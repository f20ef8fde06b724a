"""Publishers."""

from _rosidl.message import Message
from cyclonedds.core import DDSException, DDSStatus
from cyclonedds.pub import DataWriter
from rclpy._endpoint import Endpoint
from rclpy._wire import encode
from rclpy.duration import Duration, Infinite


class Publisher(Endpoint):
    """Sends messages to a topic; made by ``Node.create_publisher``. May be used from any thread."""

    _kind = DataWriter
    _noun = "publisher"
    _incompatible = DDSStatus.OfferedIncompatibleQos
    _get_incompatible = "get_offered_incompatible_qos_status"
    _warning = (
        "New subscription discovered on topic '{topic}', requesting incompatible QoS. No messages will be sent to it."
    )

    def publish(self, msg: Message | bytes) -> None:
        """Send a message, given as such or already serialised.

        Raises:
            TypeError: it is of another type, or a field holds what its type cannot.
            AttributeError: a field holds something else than the message that belongs there.
            InvalidHandle: the publisher has been destroyed.
            RCLError: the context has been shut down, by a signal perhaps: so a loop that publishes ends.
        """
        self._require_handle()
        if isinstance(msg, self.msg_type):
            data = encode(msg)
        elif isinstance(msg, bytes):
            data = msg
        else:
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        self._require_context("Failed to publish")
        try:
            self._dds.write(self._topic.data_type(data))
        except DDSException as error:
            raise self._explain(error, "Failed to publish") from None

    def get_subscription_count(self) -> int:
        """Return the number of subscriptions that receive what is published.

        Raises:
            RCLError: the context has been shut down.
        """
        self._require_handle()
        self._require_context("failed to get subscription count")
        return self._count_matched("get_publication_matched_status", "subscription")

    def wait_for_all_acked(self, timeout: Duration = Infinite) -> bool:
        """Wait until every reliable subscription has received everything; False if time runs out.

        Args:
            timeout: how long at most.

        Raises:
            RCLError: the context is shut down meanwhile.
        """
        self.get_subscription_count()  # raises if there is no publisher any more
        try:
            return bool(self._dds.wait_for_acks(timeout.nanoseconds))
        except AttributeError:  # what cyclonedds 11.0.1 raises when time runs out
            return False
        except DDSException as error:
            raise self._explain(error, "Failed to wait for all acknowledgements") from None
