"""Failures of the learner's code: an exception, or a call that cannot work."""

from tutorial.checks.engine.verdict import Place


class Misuse(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """The learner's code does something that cannot work, and the cause is known.

    Args:
        text: what the learner's code does.
        cause: the most likely cause, as a sentence.
    """

    def __init__(self, text: str, cause: str) -> None:
        super().__init__(text)
        self.cause = cause


class Failure(Exception):  # noqa: N818 - not an error of this library, but of the learner's code
    """One of the learner's methods raised an exception.

    Args:
        method: the method's name.
        error: the exception.
        place: the innermost line of the learner's code.
    """

    def __init__(self, method: str, error: BaseException, place: Place | None = None) -> None:
        super().__init__(f"{method} raised {type(error).__name__}")
        self.method = method
        self.error = error
        self.place = place

    @property
    def is_misuse(self) -> bool:
        """Whether the error is a `Misuse`, whose cause is known."""
        return isinstance(self.error, Misuse)

    @property
    def kind(self) -> tuple[type[BaseException], str]:
        """The kind of failure. Two failures of the same kind are treated as the same observation.

        The kind is the exception's type, together with the cause of a `Misuse`, or with the method's name if a required
        argument is missing.
        """
        called_in = self.method * ("required positional argument" in str(self.error))
        return type(self.error), getattr(self.error, "cause", called_in)
