"""Stubs for the C functions that Cyclone DDS's ``qos`` and ``idl`` import. The page never calls them."""

from ctypes import c_void_p
from types import SimpleNamespace
from typing import Any


class DDS:
    """Base class of Cyclone DDS's classes that call C."""

    _dll_handle = SimpleNamespace(dds_set_log_mask=lambda _mask: None)


class SampleInfo:
    """The information that C would add to each sample."""

    __match_args__ = ()


class Types:
    """C's types. Any type will do, because nothing calls C; an array of `attach` is a list of keys."""

    attach = property(lambda self: self)

    def __mul__(self, size: int) -> Any:
        return lambda: [None] * size

    def __getattr__(self, _name: str) -> Any:
        return c_void_p


dds_c_t = Types()


def static_c_call(_name: str) -> Any:
    """Return a decorator that leaves a method unchanged."""
    return lambda method: method
