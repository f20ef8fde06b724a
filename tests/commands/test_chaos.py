"""``tank chaos``: faults from options, a count of the hits, and a clean end."""


def test_it_prints_its_faults_and_their_hits(tank):
    run = tank("chaos -f rename -f shuffle:0.5 --seed 3", once="rename 100 %, shuffle 50 %\n")
    assert (run.status, "affected messages: " in run.output) == (0, True)
    assert "no fault\naffected messages: none\n" in tank("chaos", once="no fault\n").output
