"""``tank chaos``: faults from options, what they have hit, and an end without a trace."""


def test_it_says_which_faults_hold_and_what_they_have_hit(tank):
    run = tank("chaos -f rename -f shuffle:0.5 --seed 3", once="rename 100 %, shuffle 50 %\n")
    assert (run.status, "messages hit: " in run.output) == (0, True)
    assert "no fault\nmessages hit: none\n" in tank("chaos", once="no fault\n").output
