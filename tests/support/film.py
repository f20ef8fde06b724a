"""A picture that moves, made of screenshots: one after the other, however long each of them takes."""

import io
from pathlib import Path

from PIL import Image
from playwright.async_api import FloatRect, Page

QUALITY = 60  # of 100: what WebP may leave out


class Film:
    """Takes screenshots of a part of a page, and makes a picture of them that moves.

    Args:
        page: what to look at.
        part: which part of it, in pixels of the page.
        width: of the picture [pixels].
        frame: how long each screenshot is shown [s].
    """

    def __init__(self, page: Page, part: FloatRect, width: int, frame: float) -> None:
        self._page = page
        self._part = part
        self._size = width, round(width * part["height"] / part["width"])
        self._milliseconds = round(1000 * frame)
        self._frames: list[Image.Image] = []

    async def shoot(self) -> None:
        """Take one screenshot."""
        picture = Image.open(io.BytesIO(await self._page.screenshot(clip=self._part))).convert("RGB")
        self._frames.append(picture.resize(self._size, Image.Resampling.LANCZOS))

    def save(self, path: Path) -> None:
        """Write it as a WebP, which begins anew when it is over."""
        first, *others = self._frames
        first.save(
            path, save_all=True, append_images=others, duration=self._milliseconds, loop=0, quality=QUALITY, method=6
        )
