"""Hashes that identify definitions of message types."""

from dataclasses import dataclass


@dataclass(repr=False)
class TypeHash:
    """The hash of a type (REP 2016).

    Attributes:
        version: version of the algorithm; -1 if there is no hash.
        value: the 32 bytes of the hash.
    """

    version: int = -1
    value: bytes = bytes(32)

    def __str__(self) -> str:
        is_valid = self.version > 0 and len(self.value) == 32
        return f"RIHS{self.version:02}_{self.value.hex()}" if is_valid else "INVALID"
