"""What goes wrong in the learner's code: an exception that it raises, or a call that cannot work."""

from tutorial.checks.engine.verdict import Place


class Misuse(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """Something is used in a way that cannot work, for a reason that the check knows.

    Args:
        text: what the learner's code does.
        cause: the most likely reason, as a sentence.
    """

    def __init__(self, text: str, cause: str) -> None:
        super().__init__(text)
        self.cause = cause


class Failure(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """One of the learner's methods raised an exception.

    Args:
        method: its name.
        error: what it raised.
        place: the innermost line of the learner's code.
    """

    def __init__(self, method: str, error: BaseException, place: Place | None = None) -> None:
        super().__init__(f"{method} raised {type(error).__name__}")
        self.method = method
        self.error = error
        self.place = place

    @property
    def is_misuse(self) -> bool:
        """Whether the check knows the reason."""
        return isinstance(self.error, Misuse)

    @property
    def kind(self) -> tuple[type[BaseException], str]:
        """What two failures share if they count as the same observation.

        A `Misuse` is identified by its cause, and a call that lacks a required argument by the method.
        """
        called_in = self.method * ("required positional argument" in str(self.error))
        return type(self.error), getattr(self.error, "cause", called_in)
