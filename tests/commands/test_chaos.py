"""``tank chaos``: faults from options, what they have hit, and an end without a trace."""


def test_it_says_which_faults_hold_and_what_they_have_hit(tank):
    run = tank("chaos -f nan -f drop:0.5 --duration 0.8")
    assert run.status == 0
    assert run.stdout.startswith("nan 100 %, drop 50 %\nmessages hit: nan ")
    assert tank("chaos --duration 0.2").stdout == "no fault\nmessages hit: none\n"


def test_ctrl_c_ends_it(tank):
    said = "rename 100 %, shuffle 50 %\n"
    run = tank("chaos -f rename -f shuffle:0.5 --seed 3", once=said)
    assert (run.status, "messages hit: " in run.output) == (0, True)
