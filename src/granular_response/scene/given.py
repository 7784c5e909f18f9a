"""The door through which values come in: arrays of any kind as the numbers and lists that scenes hold.

Arrays of numpy, masked ones too, of xarray, pandas, dask and the standard library become lists of Python numbers, each
value where it stands. What is missing in them (a masked place) becomes nan, which no rule takes for a number; None
would be a key that is left open. Numbers of more than 64 bits are rounded. A set has no order, so it is no list: it
stays a set, and is refused.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Set as AnySet
from numbers import Real
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """Numbers, lists and arrays as Python's; all else as it is.

    Examples
    --------
    >>> from granular_response.scene.given import plain
    >>> plain(np.ma.masked_equal([1.0, 3.0], 3.0)), plain(np.array([1, 3], np.longdouble)), plain(range(2))
    ([1.0, nan], [1.0, 3.0], [0, 1])
    """
    if isinstance(value, np.generic):
        item = value.item()
        return float(item) if isinstance(item, np.floating) else item  # those of more than 64 bits are their own items
    if isinstance(value, (list, tuple, range)):
        return [plain(part) for part in value]
    if isinstance(value, (array, memoryview)) or (hasattr(value, "__array__") and not isinstance(value, type)):
        try:
            values = np.asanyarray(value)  # which keeps the mask
            if isinstance(values, np.ma.MaskedArray):
                values = np.ma.filled(values.astype(object), math.nan)
            listed = values.tolist()
        except (TypeError, ValueError):  # a dataset, which has an __array__ that refuses
            return value
        return plain(listed)
    return value


def unordered(value: Any) -> bool:
    """Whether a value has no order, so that it cannot be a list."""
    return isinstance(value, AnySet)


def finite_numbers(value: Any) -> list[float] | None:
    """The numbers of a list or of a (n,) array; None for anything that is no list of finite numbers.

    Examples
    --------
    >>> from granular_response.scene.given import finite_numbers
    >>> finite_numbers(np.array([1, 3])), finite_numbers([1.0, float("nan")]), finite_numbers({1.0}), finite_numbers(2)
    ([1.0, 3.0], None, None, None)
    """
    listed = plain(value)
    if not isinstance(listed, list) or any(isinstance(one, bool) or not isinstance(one, Real) for one in listed):
        return None
    try:
        found = [float(one) for one in listed]
    except OverflowError:
        return None
    return found if all(map(math.isfinite, found)) else None
