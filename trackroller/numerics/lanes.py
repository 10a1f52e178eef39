"""Arithmetic on short vectors for numba, which keeps loops over a few numbers out of vector registers.

Small systems of equations with the same pattern are solved side by side: each number of one system stands beside the
numbers of the others, and one instruction treats all of them. Arrays are (m,) of floats.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic as _intrinsic

intrinsic: Any = _intrinsic  # its calls lack the first argument of its definition

LANES = 4  # numbers beside each other: more of them would leave the fastest cache


def _vectors(context, builder, signature, given, number):
    """Return a function that gives the pointer to vector i of an array; its start follows the array."""
    array, start = given[number], given[number + 1]
    data = context.make_array(signature.args[number])(context, builder, array).data
    vector = ir.VectorType(context.get_value_type(signature.args[number].dtype), LANES)

    def at(i):
        offset = builder.add(start, builder.mul(i, ir.Constant(start.type, LANES)))
        return builder.bitcast(builder.gep(data, [offset]), vector.as_pointer())

    return at


def _size(array) -> int:
    return array.dtype.bitwidth // 8


@intrinsic
def multiply(typingctx, out, start, factors, at, count):
    """Multiply each lane by its factor: out[start + t] *= factors[at + t % LANES] for t below count LANES."""
    signature = types.void(out, types.intp, factors, types.intp, types.intp)

    def generate(context, builder, signature, given):
        target, factor = (_vectors(context, builder, signature, given, number) for number in (0, 2))
        multiplier = builder.load(factor(ir.Constant(given[1].type, 0)), align=_size(factors))
        with cgutils.for_range(builder, given[4]) as loop:
            where = target(loop.index)
            value = builder.load(where, align=_size(out))
            builder.store(builder.fmul(multiplier, value), where, align=_size(out))
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def subtract_multiple(typingctx, out, start, source, first, factors, at, count):
    """Subtract multiples: out[start + t] -= factors[at + t % LANES] * source[first + t] for t below count LANES."""
    signature = types.void(out, types.intp, source, types.intp, factors, types.intp, types.intp)

    def generate(context, builder, signature, given):
        target, origin, factor = (_vectors(context, builder, signature, given, number) for number in (0, 2, 4))
        multiplier = builder.load(factor(ir.Constant(given[1].type, 0)), align=_size(factors))
        with cgutils.for_range(builder, given[6]) as loop:
            where = target(loop.index)
            value = builder.load(origin(loop.index), align=_size(source))
            product = builder.fmul(multiplier, value, flags=("contract",))
            rest = builder.fsub(builder.load(where, align=_size(out)), product, flags=("contract",))
            builder.store(rest, where, align=_size(out))
        return context.get_dummy_value()

    return signature, generate
