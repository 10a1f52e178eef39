"""Arithmetic on short vectors for numba, which keeps loops over a few numbers out of vector
registers.

Small systems of equations with the same pattern are solved side by side: each number of one system
stands beside the numbers of the others, and one instruction treats all of them. Arrays are (m,) of
floats.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic as _intrinsic

intrinsic: Any = _intrinsic  # its calls lack the first argument of its definition

# numbers beside each other, in single precision: more of them would leave the fastest cache
LANES = 8


def _vectors(context, builder, signature, given, number):
    """Return a function that gives the pointer to vector i of argument `number`; the next argument
    is its start.
    """
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
    """Multiply each lane by its factor: out[start + t] *= factors[at + t % LANES] for t below count
    LANES.
    """
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
    """Subtract multiples: out[start + t] -= factors[at + t % LANES] * source[first + t] for t below
    count LANES.
    """
    signature = types.void(out, types.intp, source, types.intp, factors, types.intp, types.intp)

    def generate(context, builder, signature, given):
        target, origin, factor = (
            _vectors(context, builder, signature, given, number) for number in (0, 2, 4)
        )
        multiplier = builder.load(factor(ir.Constant(given[1].type, 0)), align=_size(factors))
        with cgutils.for_range(builder, given[6]) as loop:
            where = target(loop.index)
            value = builder.load(origin(loop.index), align=_size(source))
            product = builder.fmul(multiplier, value, flags=("contract",))
            remainder = builder.fsub(
                builder.load(where, align=_size(out)), product, flags=("contract",)
            )
            builder.store(remainder, where, align=_size(out))
        return context.get_dummy_value()

    return signature, generate


@intrinsic
def bilinear(typingctx, fields, first, row, plane, s, t):
    """Return two fields between four neighbours, at the shares s, t of the way to the next column
    and row.

    `first` is the place of the first neighbour in `fields` (m,), `row` and `plane` are the
    distances to the next row and to the second field; s, t are of the type of the fields. Both
    fields and two columns share a vector.
    """
    number = fields.dtype
    signature = types.UniTuple(number, 2)(
        fields, types.intp, types.intp, types.intp, number, number
    )

    def generate(context, builder, signature, given):
        data = context.make_array(fields)(context, builder, given[0]).data
        scalar, index = context.get_value_type(number), ir.IntType(32)

        def picked(one, other, *places):
            mask = ir.Constant(
                ir.VectorType(index, len(places)), [ir.Constant(index, place) for place in places]
            )
            return builder.shuffle_vector(one, other, mask)

        def pair(place):
            pointer = builder.bitcast(
                builder.gep(data, [place]), ir.VectorType(scalar, 2).as_pointer()
            )
            return builder.load(pointer, align=_size(fields))

        def four(place):
            return picked(pair(place), pair(builder.add(place, given[3])), 0, 1, 2, 3)

        def mixed(one, other, share):
            spread = builder.insert_element(
                ir.Constant(one.type, ir.Undefined), share, ir.Constant(index, 0)
            )
            spread = picked(spread, spread, *[0] * one.type.count)
            change = builder.fmul(spread, builder.fsub(other, one), flags=("contract",))
            return builder.fadd(one, change, flags=("contract",))

        line = mixed(four(given[1]), four(builder.add(given[1], given[2])), given[5])
        point = mixed(picked(line, line, 0, 2), picked(line, line, 1, 3), given[4])
        values = [builder.extract_element(point, ir.Constant(index, k)) for k in range(2)]
        return context.make_tuple(builder, signature.return_type, values)

    return signature, generate
