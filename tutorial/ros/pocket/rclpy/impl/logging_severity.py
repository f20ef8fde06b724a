"""How much a log line matters."""

from rclpy.logging import LoggingSeverity as LoggingSeverity  # noqa: PLC0414  (programs find it here)
