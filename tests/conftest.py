"""What all tests share. `tutorial` comes first: it is what makes rclpy importable."""

from __future__ import annotations

import tutorial  # noqa: F401
