"""Severities of log lines."""

from rclpy.logging import LoggingSeverity as LoggingSeverity  # noqa: PLC0414  (re-export)
