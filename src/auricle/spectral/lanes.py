"""Several numbers in one register, for the inner loops of compiled functions.

A compiler turns a loop over a long row into vector instructions by itself, but not a product of
small matrices, which wants a few rows' sums kept in registers. With these functions such a loop is
written down. They work on any processor: where registers are narrower the compiler splits them.
"""

from collections.abc import Callable
from typing import Any, Final, TypeVar, cast

import numpy as np
from numba.core import types
from numba.core.cgutils import ir
from numba.extending import intrinsic, models, register_model

from auricle.arrays import Floats

F = TypeVar("F", bound=Callable[..., object])

_LINE = 8
"""Numbers in a line of the cache."""
_CONTRACT = ("contract",)
"""A product and the sum it goes into may be one instruction, rounded once."""
_READ, _SOON, _DATA = 0, 2, 1
"""Of a hint to the processor: for what, how near it is to be kept, and of which kind."""
_NUMBER, _COUNT, _INDEX = ir.DoubleType(), ir.IntType(64), ir.IntType(32)


class Lanes(types.Type):
    """The compiler's type of `count` numbers side by side in a register."""

    def __init__(self, count: int) -> None:
        self.count = count
        super().__init__(name=f"Lanes({count})")


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):  # type: ignore[misc]
    """How the compiler holds lanes: as a vector."""

    def __init__(self, manager: Any, lanes: Lanes) -> None:
        super().__init__(manager, lanes, _vector(lanes))


def _vector(lanes: Lanes) -> Any:
    return ir.VectorType(_NUMBER, lanes.count)


def _register_filler(count: int) -> Any:
    lanes = Lanes(count)

    def fill(typing: Any, number: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            return _filled(builder, arguments[0], lanes)

        return lanes(types.float64), generate

    return intrinsic(fill)


def _filled(builder: Any, number: Any, lanes: Lanes) -> Any:
    undefined = ir.Constant(_vector(lanes), ir.Undefined)
    first = builder.insert_element(undefined, number, ir.Constant(_INDEX, 0))
    mask = ir.Constant(ir.VectorType(_INDEX, lanes.count), [0] * lanes.count)
    return builder.shuffle_vector(first, undefined, mask)


def _address(context: Any, builder: Any, array_type: Any, array: Any, place: Any) -> Any:
    return builder.gep(context.make_array(array_type)(context, builder, array).data, [place])


def _fused(builder: Any, total: Any, one: Any, other: Any) -> Any:
    return builder.fadd(total, builder.fmul(one, other, flags=_CONTRACT), flags=_CONTRACT)


def _zeros(typing: Any, like: Any) -> Any:
    lanes = Lanes(like.count)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return ir.Constant(_vector(lanes), [0.0] * lanes.count)

    return lanes(like), generate


def _width(typing: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return ir.Constant(_COUNT, lanes.count)

    return types.intp(lanes), generate


def _load(typing: Any, like: Any, numbers: Any, place: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _address(context, builder, signature.args[1], arguments[1], arguments[2])
        loaded = builder.load(builder.bitcast(address, _vector(like).as_pointer()))
        loaded.align = 8
        return loaded

    return like(like, numbers, types.intp), generate


def _store(typing: Any, lanes: Any, numbers: Any, place: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _address(context, builder, signature.args[1], arguments[1], arguments[2])
        stored = builder.store(arguments[0], builder.bitcast(address, _vector(lanes).as_pointer()))
        stored.align = 8
        return context.get_dummy_value()

    return types.void(lanes, numbers, types.intp), generate


def _prefetch(typing: Any, numbers: Any, place: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _address(context, builder, signature.args[0], arguments[0], arguments[1])
        pointer = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [pointer, _INDEX, _INDEX, _INDEX])
        hint = builder.module.declare_intrinsic("llvm.prefetch", [pointer], kind)
        options = [ir.Constant(_INDEX, option) for option in (_READ, _SOON, _DATA)]
        builder.call(hint, [builder.bitcast(address, pointer), *options])
        return context.get_dummy_value()

    return types.void(numbers, types.intp), generate


def _added(typing: Any, total: Any, other: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fadd(*arguments)

    return total(total, total), generate


def _subtracted(typing: Any, total: Any, other: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.fsub(*arguments)

    return total(total, total), generate


def _added_product(typing: Any, total: Any, one: Any, other: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return _fused(builder, *arguments)

    return total(total, total, total), generate


def _added_multiple(typing: Any, total: Any, numbers: Any, place: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _address(context, builder, signature.args[1], arguments[1], arguments[2])
        factor = _filled(builder, builder.load(address), total)
        return _fused(builder, arguments[0], factor, arguments[3])

    return total(total, numbers, types.intp, total), generate


def _load_fours(typing: Any, like: Any, numbers: Any, place: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address = _address(context, builder, signature.args[1], arguments[1], arguments[2])
        loaded = builder.load(builder.bitcast(address, ir.VectorType(_NUMBER, 4).as_pointer()))
        loaded.align = 8
        return _chosen(builder, loaded, loaded, [i % 4 for i in range(like.count)])

    return like(like, numbers, types.intp), generate


def _chosen(builder: Any, one: Any, other: Any, places: list[int]) -> Any:
    mask = ir.Constant(ir.VectorType(_INDEX, len(places)), places)
    return builder.shuffle_vector(one, other, mask)


def _turner(by: int) -> Any:
    def turn(typing: Any, lanes: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            places = [i - i % 4 + (i + by) % 4 for i in range(lanes.count)]
            return _chosen(builder, arguments[0], arguments[0], places)

        return lanes(lanes), generate

    return intrinsic(turn)


def _dealer(t: int) -> Any:
    def deal(typing: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            lines = [(t * a.count + i) // 4 for i in range(a.count)]
            turns = [(i - line) % 4 for i, line in enumerate(lines)]
            halves = [line + a.count * (turn % 2) for line, turn in zip(lines, turns, strict=True)]
            ab = _chosen(builder, arguments[0], arguments[1], halves)
            cd = _chosen(builder, arguments[2], arguments[3], halves)
            whole = [i + a.count * (turn // 2) for i, turn in enumerate(turns)]
            return _chosen(builder, ab, cd, whole)

        return a(a, a, a, a), generate

    return intrinsic(deal)


def _total(typing: Any, lanes: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        parts = [
            builder.extract_element(arguments[0], ir.Constant(_INDEX, i))
            for i in range(lanes.count)
        ]
        while len(parts) > 1:
            half = len(parts) // 2
            parts = [builder.fadd(parts[i], parts[i + half]) for i in range(half)]
        return parts[0]

    return types.float64(lanes), generate


def aligned(size: int) -> Floats:
    """Room for so many numbers that begins with a line of the processor's cache.

    A register of eight numbers read from there on lies within one line, and not across two.
    """
    room = np.empty(size + _LINE)
    first = -(room.ctypes.data // room.itemsize) % _LINE
    return room[first : first + size]


four: Final = cast(Callable[[float], Lanes], _register_filler(4))
"""Four lanes, the same number in each."""
eight: Final = cast(Callable[[float], Lanes], _register_filler(8))
"""Eight lanes, the same number in each."""
zeros: Final = cast(Callable[[tuple[float, ...]], Lanes], intrinsic(_zeros))
"""As many lanes as a tuple has numbers, 0 in each: for callers from outside compiled code, which
have no registers."""
width: Final = cast(Callable[[Lanes], int], intrinsic(_width))
"""How many lanes there are."""
load: Final = cast(Callable[[Lanes, Floats, int], Lanes], intrinsic(_load))
"""As many numbers as the first argument has, from a contiguous array's place on."""
store: Final = cast(Callable[[Lanes, Floats, int], None], intrinsic(_store))
"""Put lanes into a contiguous array from a place on."""
prefetch: Final = cast(Callable[[Floats, int], None], intrinsic(_prefetch))
"""Say that an array will soon be read from a place on; it may lie outside, which says nothing."""
added: Final = cast(Callable[[Lanes, Lanes], Lanes], intrinsic(_added))
"""Lane by lane, total + other."""
subtracted: Final = cast(Callable[[Lanes, Lanes], Lanes], intrinsic(_subtracted))
"""Lane by lane, total − other."""
added_product: Final = cast(Callable[[Lanes, Lanes, Lanes], Lanes], intrinsic(_added_product))
"""Lane by lane, total + one·other."""
added_multiple: Final = cast(
    Callable[[Lanes, Floats, int, Lanes], Lanes], intrinsic(_added_multiple)
)
"""Of (total, numbers, place, lanes), total + numbers[place]·lanes."""
turned_once: Final = cast(Callable[[Lanes], Lanes], _turner(1))
"""Every four lanes in a circle, each taking the place of the one before."""
turned_twice: Final = cast(Callable[[Lanes], Lanes], _turner(2))
turned_thrice: Final = cast(Callable[[Lanes], Lanes], _turner(3))
load_fours: Final = cast(Callable[[Lanes, Floats, int], Lanes], intrinsic(_load_fours))
"""Four numbers of a contiguous array from a place on, again and again up to the width."""
dealt_first: Final = cast(Callable[[Lanes, Lanes, Lanes, Lanes], Lanes], _dealer(0))
dealt_second: Final = cast(Callable[[Lanes, Lanes, Lanes, Lanes], Lanes], _dealer(1))
dealt_third: Final = cast(Callable[[Lanes, Lanes, Lanes, Lanes], Lanes], _dealer(2))
dealt_fourth: Final = cast(Callable[[Lanes, Lanes, Lanes, Lanes], Lanes], _dealer(3))
"""Of four registers that a line was multiplied into, with vectors turned 0, 1, 2 and 3 times: the
products by line, four to a line, in as many registers; this is the last of them."""
total: Final = cast(Callable[[Lanes], float], intrinsic(_total))
"""Sum over the lanes, pairwise."""
