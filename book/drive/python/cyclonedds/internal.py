"""What Cyclone DDS's own ``qos`` and ``idl`` take from its C part, and nobody calls in a page."""

from ctypes import c_void_p
from types import SimpleNamespace
from typing import Any


class DDS:
    """Base of what calls into C."""

    _dll_handle = SimpleNamespace(dds_set_log_mask=lambda _mask: None)


class SampleInfo:
    """What C would make of each sample."""

    __match_args__ = ()


class Types:
    """C's types, of which one is as good as another where nothing is called; an array of `attach` is a list of keys."""

    attach = property(lambda self: self)

    def __mul__(self, size: int) -> Any:
        return lambda: [None] * size

    def __getattr__(self, _name: str) -> Any:
        return c_void_p


dds_c_t = Types()


def static_c_call(_name: str) -> Any:
    """Leave a method as it is."""
    return lambda method: method
