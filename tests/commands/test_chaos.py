"""``tank chaos``: faults from options or a script, said as they change, and an end without a trace."""


def test_it_says_which_faults_hold_and_what_they_have_hit(tank, tmp_path):
    path = tmp_path / "script.yaml"
    scenes = "{at: 0, for: 0.4, faults: [shuffle]}", "{at: 0.4, for: 0.4, faults: [nan, drop:0.5]}"
    path.write_text("chaos:\n" + "".join(f"  - {scene}\n" for scene in scenes))
    run = tank("chaos --script", path)
    assert run.status == 0
    for said in ("s  shuffle 100 %\n", "s  nan 100 %, drop 50 %\n", "messages hit: shuffle 20, nan 20, drop "):
        assert said in run.output


def test_ctrl_c_ends_it(tank):
    said = "s  rename 100 %, shuffle 50 %\n"
    run = tank("chaos -f rename -f shuffle:0.5 --seed 3", once=said)
    assert (run.status, "messages hit: " in run.output) == (0, True)
