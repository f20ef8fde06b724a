"""Widgets without a notebook: what they send is taken down, and pages are played."""

import anywidget
import pytest


@pytest.fixture
def sent(monkeypatch):
    """What the widgets send to their pages: (content, buffers), in order."""
    messages = []
    monkeypatch.setattr(anywidget.AnyWidget, "send", lambda self, *message: messages.append(message))
    return messages
