"""Functions compiled to machine code on first use, and kept compiled between runs."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

from numba import njit
from numba.core import cgutils
from numba.extending import intrinsic

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function to machine code, which runs without the interpreter's lock.

    The code is made at the first call with arguments of a kind. It is cached beside the source
    file or, where that is read-only, in the user's cache folder; `NUMBA_CACHE_DIR` names another.
    Indices are not checked, as in C.
    """
    return cast(Callable[P, R], njit(cache=True, nogil=True)(function))


def compiled_loosely(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled`, allowed to add up in another order, so that sums use whole vectors.

    For one machine and version the order, and so every digit, is always the same.
    """
    loose = njit(cache=True, nogil=True, fastmath={"reassoc", "contract"})
    return cast(Callable[P, R], loose(function))


def _without_owner(typing_context: Any, array: Any) -> Any:  # noqa: ARG001 - numba's form
    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        view = context.make_array(array)(context, builder, arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        return view._getvalue()

    return array(array), code


borrowed = cast(Callable[[Any], Any], intrinsic(_without_owner))
"""Inside a compiled function: the same array, without its count of references.

Each compiled call that is not a leaf counts the references to its arrays up and down, which takes
a tenth of the time of a search that makes millions of calls. Whoever called with the array keeps
it alive; what is borrowed must not be returned.
"""
