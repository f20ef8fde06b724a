"""What a verdict says."""

from tutorial.checks.engine.verdict import Finding, Verdict, right, wrong


def test_a_finding_has_one_line_that_can_be_sent():
    finding = wrong("\udcff" + "tank" * 300_000, "")
    assert len(finding.text) == 200
    assert finding.text.startswith("\\udcfftank")
    assert finding.text.endswith("…")


def test_a_verdict_names_a_cause_once_and_two_at_most():
    causes = ("First.", "First.", "Second.", "Third.")
    verdict = Verdict((right("a"), *(wrong(f"b{i}", cause) for i, cause in enumerate(causes)), right("c")), "Notice.")
    assert str(verdict).splitlines() == [
        "✓ a",
        *("✗ b0", "  First."),
        *("✗ b2", "  Second."),
        "✓ c",
        "There is more to fix. Start with this.",
    ]


def test_a_verdict_shortens_the_output():
    stamped = "[INFO] [1700000000.123456789] [tank]: hello"
    lines = str(Verdict((Finding(True, "a"),), "Notice.", (stamped, *["x" * 500] * 60))).splitlines()
    assert lines[:4] == ["✓ a", "All right. Notice.", "Your code printed:", "  | [INFO] [tank]: hello"]
    assert lines[-1] == "  | ... and more"
    assert len(lines) == 24
    assert max(map(len, lines)) < 210
