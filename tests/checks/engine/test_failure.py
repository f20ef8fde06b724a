"""Which failures count as the same observation."""

from tutorial.checks.engine.failure import Failure, Misuse


def test_kinds():
    asks = TypeError("f() missing 1 required positional argument: 'x'")
    assert Failure("f", KeyError(1)).kind == Failure("g", KeyError(2)).kind
    assert Failure("f", Misuse("a", "because")).kind == Failure("g", Misuse("b", "because")).kind
    assert Failure("f", Misuse("a", "because")).kind != Failure("f", Misuse("a", "of that")).kind
    assert Failure("f", asks).kind != Failure("g", asks).kind
