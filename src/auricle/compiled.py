"""Functions compiled to machine code on first use, and kept compiled between runs."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

from numba import njit

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function to machine code, which runs without the interpreter's lock.

    The code is made at the first call with arguments of a kind. It is cached beside the source
    file or, where that is read-only, in the user's cache folder; `NUMBA_CACHE_DIR` names another.
    Indices are not checked, as in C.
    """
    return cast(Callable[P, R], njit(cache=True, nogil=True)(function))


def compiled_in_place(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` a function that only changes the arrays it is given.

    It can neither make arrays nor return any, so references to them need no counting, which takes
    a tenth of the time of a search that makes millions of calls. Whoever calls it keeps them alive.
    """
    return cast(Callable[P, R], njit(cache=True, nogil=True, _nrt=False)(function))


def compiled_inline(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled_in_place`, as part of whatever calls it: where a call would be dear."""
    inline = njit(cache=True, nogil=True, _nrt=False, forceinline=True)
    return cast(Callable[P, R], inline(function))


def compiled_loosely(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled`, allowed to add up in another order, so that sums use whole vectors.

    For one machine and version the order, and so every digit, is always the same.
    """
    loose = njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
    return cast(Callable[P, R], loose(function))
