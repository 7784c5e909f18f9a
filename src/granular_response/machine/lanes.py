"""Several numbers at once: the type that vectorised kernels calculate with.

A ``Lanes`` value holds ``WIDTH`` doubles in vector registers, of consecutive contacts or degrees of freedom.
Arithmetic, comparison, :func:`select`, :func:`root` and :func:`magnitude` act on each lane alone, with the rounding of
the scalar operation, so a lane's results do not depend on what the others hold; functions written with them serve
scalars as well. Other codes leave it to the compiler whether a loop becomes vector instructions; here they are what a
kernel asks for. Left to the compiler, with the same bits, a step of the paper's slab takes 1.2 times as long, and the
fall of a packing is nothing but steps; a banded LU, of which it vectorises nothing, takes seven times.

:func:`take` and :func:`put` move ``array[k : k + WIDTH]``, or the scalar ``array[k]``, so that one body serves a
vector loop and what is left at its end. With compilation off a ``Lanes`` value is a numpy array.
"""

from __future__ import annotations

import math
import operator
from functools import partial

import numpy as np
from llvmlite import ir
from numba.core import cgutils, config, types
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model
from numpy.typing import NDArray

#: Numbers in a value: one AVX-512 register or two of AVX.
WIDTH = 8


def aligned_zeros(*shape: int) -> NDArray[np.float64]:
    """Zeros that begin at a cache line."""
    size = math.prod(shape)
    room = np.zeros(size + 8)
    skip = -(room.__array_interface__["data"][0] // 8) % 8
    return room[skip : skip + size].reshape(shape)


def aligned(values) -> NDArray[np.float64]:
    """A copy that begins at a cache line."""
    copy = aligned_zeros(*np.shape(values))
    copy[...] = values
    return copy


class _VectorType(types.Type):
    """Type of ``WIDTH`` numbers or truth values in registers."""


LANES, MASK = _VectorType(f"Lanes({WIDTH})"), _VectorType(f"LaneMask({WIDTH})")
_DOUBLES = ir.VectorType(ir.DoubleType(), WIDTH)
_BITS = ir.VectorType(ir.IntType(1), WIDTH)


@register_model(_VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, _DOUBLES if kind == LANES else _BITS)


def _spread(builder, value):
    """The same double in every lane."""
    one = builder.insert_element(ir.Constant(_DOUBLES, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    zeros = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    return builder.shuffle_vector(one, ir.Constant(_DOUBLES, ir.Undefined), zeros)


def _alike(builder, kinds, values):
    """The values, where some are lanes or masks with the numbers among them in every lane."""
    if not {LANES, MASK} & {*kinds}:
        return values
    return [value if k in (LANES, MASK) else _spread(builder, value) for k, value in zip(kinds, values, strict=True)]


def _define(operation, result, instruction, *operands):
    """Let an operator work on lanes or masks, for these types of its operands; other numbers are taken as doubles."""

    @infer_global(operation)
    class Typing(AbstractTemplate):
        def generic(self, args, kws):
            kinds = tuple(kind if isinstance(kind, _VectorType) else types.float64 for kind in args)
            return signature(result, *kinds) if kinds in operands else None

    def lower(context, builder, sig, args):
        return instruction(builder, *_alike(builder, sig.args, args))

    for kinds in operands:
        lower_builtin(operation, *kinds)(lower)


_BINARY = {
    operator.add: (LANES, ir.IRBuilder.fadd),
    operator.sub: (LANES, ir.IRBuilder.fsub),
    operator.mul: (LANES, ir.IRBuilder.fmul),
    operator.truediv: (LANES, ir.IRBuilder.fdiv),
    operator.gt: (MASK, lambda builder, a, b: builder.fcmp_ordered(">", a, b)),
    operator.ge: (MASK, lambda builder, a, b: builder.fcmp_ordered(">=", a, b)),
    operator.lt: (MASK, lambda builder, a, b: builder.fcmp_ordered("<", a, b)),
    operator.le: (MASK, lambda builder, a, b: builder.fcmp_ordered("<=", a, b)),
    operator.ne: (MASK, lambda builder, a, b: builder.fcmp_unordered("!=", a, b)),
}
for _operator, _defined in _BINARY.items():
    _define(_operator, *_defined, (LANES, LANES), (LANES, types.float64), (types.float64, LANES))
_define(operator.neg, LANES, ir.IRBuilder.fneg, (LANES,))
_define(operator.and_, MASK, ir.IRBuilder.and_, (MASK, MASK))
_define(operator.or_, MASK, ir.IRBuilder.or_, (MASK, MASK))


def _kind(like):
    return LANES if like in (LANES, MASK) else types.float64


def _chosen(condition, *numbers):
    """Type of a choice between numbers, and of all its arguments."""
    result = _kind(condition)
    condition = MASK if result == LANES else types.boolean
    return result(condition, *(LANES if k == LANES else types.float64 for k in numbers))


def _llvm(builder, name, values):
    """Call an intrinsic function of LLVM, for lanes or doubles."""
    kind = values[0].type
    suffix = f"v{WIDTH}f64" if kind == _DOUBLES else "f64"
    function = ir.FunctionType(kind, [kind] * len(values))
    return builder.call(cgutils.get_or_insert_function(builder.module, function, f"llvm.{name}.{suffix}"), values)


def _is_line(array) -> bool:
    return isinstance(array, types.Array) and array.ndim == 1 and array.dtype == types.float64 and array.layout == "C"


def _at(context, builder, kind, array, k, element):
    place = builder.gep(context.make_array(kind)(context, builder, array).data, [k])
    return builder.bitcast(place, element.as_pointer())


def _taken(context, builder, kind, array, k, like):
    element = _DOUBLES if like == LANES else ir.DoubleType()
    return builder.load(_at(context, builder, kind, array, k, element), align=8)


@intrinsic
def take(typing, array, k, like):
    """``array[k]`` or, where ``like`` is lanes, ``array[k : k + WIDTH]``; nothing is checked. Of None it is None."""
    if array == types.none:
        return types.none(array, types.intp, like), lambda context, builder, sig, args: context.get_dummy_value()
    if not _is_line(array) or like not in (LANES, types.float64):
        return None

    def generate(context, builder, sig, args):
        return _taken(context, builder, sig.args[0], args[0], args[1], like)

    return like(array, types.intp, like), generate


@intrinsic
def put(typing, array, k, value):
    """Set what :func:`take` takes; of None nothing."""
    if array == types.none:
        return types.none(array, types.intp, value), lambda context, builder, sig, args: context.get_dummy_value()
    if not _is_line(array) or value not in (LANES, types.float64):
        return None

    def generate(context, builder, sig, args):
        builder.store(args[2], _at(context, builder, sig.args[0], args[0], args[1], args[2].type), align=8)
        return context.get_dummy_value()

    return types.none(array, types.intp, value), generate


@intrinsic
def gather(typing, array, start, table, row, column, like):
    """``array[start + table[row, column]]`` or, where ``like`` is lanes, of ``WIDTH`` rows from there on.

    Without a table (None) what :func:`take` takes at ``start + row``.
    """
    listed = isinstance(table, types.Array) and table.ndim == 2 and table.layout == "C"
    if not _is_line(array) or not (listed or table == types.none):
        return None

    def generate(context, builder, sig, args):
        array, start, table, row, column, _ = args
        if not listed:
            return _taken(context, builder, sig.args[0], array, builder.add(start, row), like)
        data = builder.gep(context.make_array(sig.args[0])(context, builder, array).data, [start])
        indices = context.make_array(sig.args[2])(context, builder, table)
        columns = builder.extract_value(indices.shape, 1)
        result = ir.Constant(_DOUBLES, ir.Undefined)
        for lane in range(WIDTH if like == LANES else 1):
            place = builder.add(builder.mul(builder.add(row, row.type(lane)), columns), column)
            value = builder.load(builder.gep(data, [builder.load(builder.gep(indices.data, [place]))]))
            result = builder.insert_element(result, value, ir.IntType(32)(lane)) if like == LANES else value
        return result

    return like(array, types.intp, table, types.intp, types.intp, like), generate


@intrinsic
def spread(typing, value):
    """Lanes that all hold ``value``."""
    return LANES(types.float64), lambda context, builder, sig, args: _spread(builder, args[0])


@intrinsic
def select(typing, condition, yes, no):
    """``yes`` where ``condition`` holds and else ``no``, without a branch; both are evaluated."""
    signed = _chosen(condition, yes, no)
    return signed, lambda context, builder, sig, args: builder.select(*_alike(builder, sig.args, args))


def _any(builder, mask):
    return builder.icmp_unsigned("!=", builder.bitcast(mask, ir.IntType(WIDTH)), ir.IntType(WIDTH)(0))


@intrinsic
def anywhere(typing, condition):
    """Whether a condition holds, or holds in some lane."""
    if condition == MASK:
        return types.boolean(MASK), lambda context, builder, sig, args: _any(builder, args[0])
    return types.boolean(types.boolean), lambda context, builder, sig, args: args[0]


@intrinsic
def root(typing, value):
    """Square root."""
    kind = _kind(value)
    return kind(kind), lambda context, builder, sig, args: _llvm(builder, "sqrt", args)


@intrinsic
def magnitude(typing, value):
    """Absolute value."""
    kind = _kind(value)
    return kind(kind), lambda context, builder, sig, args: _llvm(builder, "fabs", args)


@intrinsic
def quotient_where(typing, condition, dividend, divisor, otherwise):
    """``dividend / divisor`` where ``condition`` holds and else ``otherwise``; no lane divides when none has to."""

    def generate(context, builder, sig, args):
        condition, dividend, divisor, otherwise = _alike(builder, sig.args, args)
        if sig.return_type != LANES:
            return builder.select(condition, builder.fdiv(dividend, divisor), otherwise)
        found = cgutils.alloca_once_value(builder, otherwise)
        with builder.if_then(_any(builder, condition)):
            builder.store(builder.select(condition, builder.fdiv(dividend, divisor), otherwise), found)
        return builder.load(found)

    return _chosen(condition, dividend, divisor, otherwise), generate


@intrinsic
def less_product(typing, value, factor, other):
    """``value - factor * other`` rounded once; ``factor`` may be a float for all lanes."""
    kind = _kind(value)

    def generate(context, builder, sig, args):
        value, factor, other = _alike(builder, sig.args, (args[0], builder.fneg(args[1]), args[2]))
        return _llvm(builder, "fma", [factor, other, value])

    return kind(kind, LANES if factor == LANES else types.float64, kind), generate


@intrinsic
def total(typing, value):
    """Sum of all lanes, those of one half added to those of the other until one is left."""

    def generate(context, builder, sig, args):
        sums, size = args[0], WIDTH
        while size > 1:
            size //= 2
            low, high = (
                builder.shuffle_vector(
                    sums, sums, ir.Constant(ir.VectorType(ir.IntType(32), size), list(range(start, start + size)))
                )
                for start in (0, size)
            )
            sums = builder.fadd(low, high)
        return builder.extract_element(sums, ir.IntType(32)(0))

    return types.float64(LANES), generate


if config.DISABLE_JIT:  # the same functions for numpy arrays and floats
    spread = partial(np.full, WIDTH)
    root, magnitude, anywhere = np.sqrt, np.abs, np.any

    def less_product(value, factor, other):
        return value - factor * other

    def total(value):
        while len(value) > 1:
            value = value[: len(value) // 2] + value[len(value) // 2 :]
        return value[0]

    def take(array, k, like):
        if array is None:
            return None
        return array[k : k + WIDTH].copy() if isinstance(like, np.ndarray) else array[k]

    def put(array, k, value):
        if array is None:
            return
        if isinstance(value, np.ndarray):
            array[k : k + WIDTH] = value
        else:
            array[k] = value

    def gather(array, start, table, row, column, like):
        if table is None:
            return take(array, start + row, like)
        return array[start + table[slice(row, row + WIDTH) if isinstance(like, np.ndarray) else row, column]]

    def select(condition, yes, no):
        if isinstance(condition, np.ndarray):
            return np.where(condition, yes, no)
        return yes if condition else no

    def quotient_where(condition, dividend, divisor, otherwise):
        return select(condition, dividend / divisor, otherwise)
