"""Widgets without a notebook: record their messages, and act as their pages."""

import anywidget
import pytest


@pytest.fixture
def sent(monkeypatch):
    """The widgets' messages to their pages, in order: (content, buffers)."""
    messages = []
    monkeypatch.setattr(anywidget.AnyWidget, "send", lambda self, *message: messages.append(message))
    return messages
