"""Publishers."""

from _rosidl.message import Message
from rclpy._endpoint import Endpoint
from rclpy._middleware import TransportError
from rclpy._transport import Participant, Writer
from rclpy._wire import encode
from rclpy.duration import Duration, Infinite


class Publisher(Endpoint):
    """Sends messages to a topic; created by ``Node.create_publisher``. Can be used from any thread."""

    _noun = "publisher"
    _warning = (
        "New subscription discovered on topic '{topic}', requesting incompatible QoS. No messages will be sent to it."
    )
    _wire: Writer

    def _create(self, participant: Participant, topic_name: str, type_name: str) -> Writer:
        return participant.create_writer(topic_name, type_name, self.qos_profile)

    def publish(self, msg: Message | bytes) -> None:
        """Publish a message, given as an object or as serialized bytes.

        Raises:
            TypeError: the message is of a different type, or a field holds a value that does not match its type.
            AttributeError: a field that must hold a message holds something else.
            InvalidHandle: the publisher has been destroyed.
            RCLError: the context has been shut down, perhaps by a signal; a publishing loop ends with this error.
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
            self._wire.write(data)
        except TransportError as error:
            raise self._explain(error, "Failed to publish") from None

    def get_subscription_count(self) -> int:
        """Return the number of subscriptions that receive the published messages.

        Raises:
            RCLError: the context has been shut down.
        """
        self._require_handle()
        self._require_context("failed to get subscription count")
        return self._count_matched("subscription")

    def wait_for_all_acked(self, timeout: Duration = Infinite) -> bool:
        """Wait until every reliable subscription has received all messages; return False on a timeout.

        Args:
            timeout: maximum wait.

        Raises:
            RCLError: the context was shut down during the wait.
        """
        self.get_subscription_count()  # raises if the publisher no longer works
        try:
            return self._wire.wait_for_acks(timeout.nanoseconds)
        except TransportError as error:
            raise self._explain(error, "Failed to wait for all acknowledgements") from None
