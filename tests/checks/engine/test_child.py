"""The judging process, seen from the inside."""

from tutorial.checks.engine.child import _findings
from tutorial.checks.engine.instruments import Instruments


def test_an_answer_that_cannot_be_loaded():
    (finding,) = _findings("tutorial.checks.aim", "aim", b"junk", Instruments())
    assert finding.text.startswith("the answer cannot run in a separate process: UnpicklingError")
