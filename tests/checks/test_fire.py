"""The exercise `fire`: every wrong answer is told from the others."""

from __future__ import annotations

import pytest

from tutorial.checks.tank_controller import FireButton, fire


class Base(FireButton):
    def on_joy(self, message):
        self.fire.put(self.pressed(message.buttons))

    def pressed(self, buttons):
        return bool(buttons) and buttons[0] == 1


class WithoutBool(Base):
    def pressed(self, buttons):
        return next(iter(buttons), 0)


class Nothing(Base):
    def on_joy(self, message):
        self.pressed(message.buttons)


class SecondButton(Base):
    def pressed(self, buttons):
        return len(buttons) > 1 and buttons[1] == 1


class AnyButton(Base):
    def pressed(self, buttons):
        return any(buttons)


class AllButtons(Base):
    def pressed(self, buttons):
        return bool(buttons) and all(buttons)


class Inverted(Base):
    def pressed(self, buttons):
        return not super().pressed(buttons)


class ThereAreButtons(Base):
    def pressed(self, buttons):
        return len(buttons) > 0


class Axes(Base):
    def on_joy(self, message):
        self.fire.put(message.axes[0] == 1)


class NeverReleased(Base):
    def on_joy(self, message):
        if self.pressed(message.buttons):
            self.fire.put(True)


class NotWithoutButtons(Base):
    def on_joy(self, message):
        if message.buttons:
            self.fire.put(message.buttons[0] == 1)


class Unasked(Base):
    def pressed(self, buttons):
        return buttons[0] == 1


class Assigned(Base):
    def on_joy(self, message):
        self.fire = self.pressed(message.buttons)


class WholeList(Base):
    def pressed(self, buttons):
        return buttons


class KeepsListening(Base):
    def unconfigure(self):
        pass


CAUSES = {
    Nothing: "nothing is put",
    SecondButton: "it looks at the second button",
    AnyButton: "it looks at all buttons",
    AllButtons: "all buttons have to be pressed",
    Inverted: "True and False are exchanged",
    ThereAreButtons: "it looks whether there are buttons",
    Axes: "it looks at message.axes",
    NeverReleased: "nothing is put while the button is not pressed",
    NotWithoutButtons: "nothing is put if there are no buttons",
    Unasked: "takes for granted that there are buttons",
    Assigned: "self.fire is assigned anew",
    WholeList: "True or False",
    KeepsListening: "unconfigure",
}


@pytest.mark.parametrize("answer", [FireButton, Base, WithoutBool])
def test_right_answers_are_right(answer, domain):
    assert fire.judge(answer).right


@pytest.mark.parametrize(("answer", "cause"), CAUSES.items(), ids=lambda value: getattr(value, "__name__", None))
def test_each_wrong_answer_is_told_from_the_others(answer, cause, domain):
    verdict = fire.judge(answer)
    assert not verdict.right
    assert cause in str(verdict)
