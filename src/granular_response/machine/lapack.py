"""LAPACK and BLAS called from kernels: those of scipy, by their addresses.

So a kernel that calls many small routines never returns to Python in between, and several threads run side by side. An
address is an argument of a kernel, not a part of its code, which is kept for other processes.

Fortran takes every argument by reference. In a call, :func:`at` stands for a place in an array; whole numbers, and real
ones in their own precision, are put where they can be referred to. Flags are the codes of their letters: a routine
looks at the first byte of what it is given, and that of a small whole number is its lowest.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache

import numpy as np
from llvmlite import ir
from numba.core import cgutils, config, types
from numba.extending import get_cython_function_address, intrinsic
from numpy.typing import NDArray

#: Routines in the order of :func:`addresses`.
ROUTINES = ("gemm", "gemv", "syrk", "trsm", "trsv", "getrf", "laswp", "potrf")
GEMM, GEMV, SYRK, TRSM, TRSV, GETRF, LASWP, POTRF = range(len(ROUTINES))

#: First letter of their names for numbers of this type.
PRECISIONS = {np.dtype(np.float64): "d", np.dtype(np.float32): "s"}

#: Letters of flags: left or right, lower or upper triangle, transposed or not, diagonal of ones or not.
LEFT, RIGHT, LOWER, UPPER, TRANSPOSED, AS_IS, ONES, GIVEN = (ord(letter) for letter in "LRLUTNUN")

assert sys.byteorder == "little"


@cache
def addresses(kind: np.dtype) -> NDArray[np.int64]:
    """(r,) addresses of ``ROUTINES`` for numbers of a type of ``PRECISIONS``."""
    found = [
        get_cython_function_address(f"scipy.linalg.cython_{library}", PRECISIONS[kind] + name)
        for name, library in zip(ROUTINES, ["blas"] * 5 + ["lapack"] * 3, strict=True)
    ]
    result = np.array(found, np.int64)
    result.flags.writeable = False
    return result


@intrinsic
def at(typing, array, k):
    """The place of ``array[k]`` of a contiguous array, for :func:`call`; nothing is checked."""

    def generate(context, builder, sig, args):
        data = context.make_array(sig.args[0])(context, builder, args[0]).data
        return builder.bitcast(builder.gep(data, [args[1]]), cgutils.voidptr_t)

    return types.voidptr(array, types.intp), generate


@intrinsic
def call(typing, address, arguments):
    """Call the routine at ``address`` with a tuple of arguments."""

    def generate(context, builder, sig, args):
        pointers = []
        for k, kind in enumerate(sig.args[1].types):
            value = builder.extract_value(args[1], k)
            if kind == types.voidptr:
                pointers.append(value)
                continue
            if isinstance(kind, types.Integer):
                value = context.cast(builder, value, kind, types.int32)
            place = cgutils.alloca_once_value(builder, value)
            pointers.append(builder.bitcast(place, cgutils.voidptr_t))
        function = ir.FunctionType(ir.VoidType(), [cgutils.voidptr_t] * len(pointers))
        builder.call(builder.inttoptr(args[0], function.as_pointer()), pointers)
        return context.get_dummy_value()

    return types.none(types.int64, arguments), generate


if config.DISABLE_JIT:
    _REAL = {np.float64: ctypes.c_double, np.float32: ctypes.c_float}

    def at(array, k):
        return ctypes.c_void_p(array.ctypes.data + array.itemsize * int(k))

    def referred(value):
        if isinstance(value, ctypes.c_void_p):
            return value
        kind = _REAL.get(type(value))
        return ctypes.byref(ctypes.c_int32(int(value)) if kind is None else kind(value))

    def call(address, arguments):
        made = [referred(value) for value in arguments]
        ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(made))(int(address))(*made)
