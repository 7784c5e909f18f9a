"""Counts what the kernels of a step do: `NUMBA_DISABLE_JIT=1 python benchmarks/counting.py LAYERS PER_ROW FRICTION`.

The kernels run as they are on arrays that count; a comparison with its choice is one selection, and a division that
slides alone would need is not done where nothing slides, as in the compiled kernel. Prints JSON.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from typing import Any

import numpy as np

TALLY: Counter[str] = Counter()
#: What an operation of numpy counts as; comparisons count with their choice.
NAMES = {
    "add": "additions", "subtract": "additions", "negative": "additions", "multiply": "multiplications",
    "divide": "divisions", "true_divide": "divisions", "sqrt": "roots", "absolute": "selections",
}  # fmt: skip


class Counted(np.ndarray):
    """An array whose arithmetic is counted, number by number."""

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **kwargs: Any) -> Any:
        plain = [x.view(np.ndarray) if isinstance(x, Counted) else x for x in inputs]
        result = np.asarray(getattr(ufunc, method)(*plain, **kwargs))
        if ufunc.__name__ in NAMES:
            TALLY[NAMES[ufunc.__name__]] += result.size
        return result.view(Counted)


def take(array: np.ndarray, k: int, like: Any) -> Counted:
    """As of `machine.lanes`, counted."""
    wide = np.ndim(like) == 1
    found = array[k : k + len(like)].copy() if wide else np.array(array[k])
    TALLY["loads"] += found.size
    return found.view(Counted)


def put(array: np.ndarray, k: int, value: Any) -> None:
    """As of `machine.lanes`, counted."""
    TALLY["stores"] += np.size(value)
    if np.ndim(value):
        array[k : k + np.size(value)] = value
    else:
        array[k] = value


def select(condition: Any, yes: Any, no: Any) -> Counted:
    """As of `machine.lanes`, counted with the comparison that it takes."""
    result = np.where(np.asarray(condition), np.asarray(yes), np.asarray(no))
    TALLY["selections"] += result.size
    return result.view(Counted)


def quotient_where(condition: Any, dividend: Any, divisor: Any, otherwise: Any) -> Counted:
    """As of `machine.lanes`: no lane divides when none has to."""
    return select(condition, dividend / divisor if np.any(condition) else otherwise, otherwise)


def main(layers: str, per_row: str, friction: str) -> None:
    from granular_response.machine import lanes

    for name in ("take", "put", "select", "quotient_where"):  # before the kernels take them over
        setattr(lanes, name, globals()[name])
    import kernel

    from granular_response.kernels import forces
    from granular_response.kernels.integrators import stepping
    from granular_response.solvers.dynamics import Dynamics

    problem = kernel.slab(int(layers), int(per_row), float(friction))
    dynamics = Dynamics(problem, problem.bare_state(), "beeman", kernel.TIME_STEP)
    model, memory = dynamics.model, dynamics.rows
    found = {}
    TALLY.clear()
    pairs = model.pairs
    q, v, force = dynamics.q, dynamics.v, memory.force
    forces.add_pair_forces(q, v, model.rim, force, model.n, pairs.spring, pairs.shape, pairs, None, model.rule, 0.0)
    found["pair forces"] = dict(TALLY)
    TALLY.clear()
    a, b, c, force, seen = memory
    scheme = dynamics.integrator.scheme
    stepping.end_and_begin(scheme, q, v, a, b, c, force, model.inverse_mass, seen, 0.0)
    found["integration"] = dict(TALLY)
    kinds = ("additions", "multiplications", "divisions", "roots", "selections", "loads", "stores")
    print(json.dumps({part: {kind: tally.get(kind, 0) for kind in kinds} for part, tally in found.items()}))


if __name__ == "__main__":
    main(*sys.argv[1:])
