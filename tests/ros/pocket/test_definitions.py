"""The message definitions are the same as in rosbags' store."""

import pytest


@pytest.mark.pocket
def test_they_equal_the_store():
    from record_definitions import RECORDED, written

    assert RECORDED.read_text(encoding="utf-8") == written(), "support/record_definitions.py writes it"
