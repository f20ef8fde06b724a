"""The logger class."""

from rclpy.logging import RcutilsLogger as RcutilsLogger  # noqa: PLC0414  (re-export)
