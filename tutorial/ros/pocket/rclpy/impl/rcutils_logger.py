"""What writes log lines."""

from rclpy.logging import RcutilsLogger as RcutilsLogger  # noqa: PLC0414  (programs find it here)
