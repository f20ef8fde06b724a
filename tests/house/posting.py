"""Wrongly posted calls, for the type checker: mypy also fails if one of these errors does not occur."""

from tutorial.controller import ControllerConfig


class Poster:
    def __init__(self, config: ControllerConfig) -> None:
        config.call_later(self.update, "news", 1)
        config.call_later(self.update, "news")  # type: ignore[arg-type]
        config.call_later(self.update, 1, "news")  # type: ignore[arg-type]
        config.call_later(self.update("news", 1))  # type: ignore[arg-type]
        config.call_latest("key", self.update, "news", 1)
        config.call_latest("key", self.update, 1)  # type: ignore[arg-type]
        config.call_latest(self.update, "news", 1)  # type: ignore[arg-type]

    def update(self, news: str, count: int) -> str:
        return news * count
