"""What messages consist of is what rosbags' store says."""

import pytest


@pytest.mark.pocket
def test_they_are_what_the_store_says():
    from record_definitions import RECORDED, written

    assert RECORDED.read_text(encoding="utf-8") == written(), "python tests/support/record_definitions.py writes it"
