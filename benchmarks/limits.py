"""How near the kernels and the factorisations are to what this processor gives.

`python benchmarks/limits.py OUTPUT.json`.

Kernels: operations and bytes of a step are counted by running the kernels themselves on arrays that count (in a process
with compilation off). Beside each kernel runs a loop of the same mix: as many additions, multiplications, divisions,
roots, comparisons, loads and stores for each vector, but of numbers that are in order and do not wait for each other.
The ratio of the two times is how near a kernel is to the limit of its mix.

Factorisations: operations by their closed form for the sizes of bands and fronts, against LAPACK's matrix product
on this machine (768 by 768). Times are of the processor. Fronts are also run as bare dense factorisations of the same
sizes, without what puts the matrix into them.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from granular_response.machine import floating_point

floating_point.pin()  # one thread, before numpy is loaded

import kernel  # noqa: E402
import linear  # noqa: E402
import numba as nb  # noqa: E402
import numpy as np  # noqa: E402
from scipy.linalg import blas, lapack  # noqa: E402
from timing import interleaved, write  # noqa: E402

from granular_response.machine import lanes  # noqa: E402
from granular_response.solvers.dynamics import Dynamics  # noqa: E402

LAYERS, PER_ROW, SETTLE = 15, 61, 20_000
#: Calls of a kernel that are timed together, and repeats of them.
TIMES, REPEATS = 200, 60
#: Chains of operations of the loops of the same mix, of which the fastest counts: fewer wait, more leave registers.
#: In one chain each operation waits for the one before.
CHAINS = (1, 2, 3, 4, 5)
#: Product that the rate of the machine is taken from.
PRODUCT = 768
#: Slabs whose tangents are factorised: layers, disks in the bottom row.
FACTORISED = [(15, 61), (60, 241)]
#: Kinds of operation on doubles, and what is moved.
KINDS = ("additions", "multiplications", "divisions", "roots", "selections", "loads", "stores")


def counted(friction: float) -> dict[str, dict[str, int]]:
    """For each part of a step how often each kind of operation is done, in a process with compilation off."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, str(Path(__file__).with_name("counting.py")), str(LAYERS), str(PER_ROW), str(friction)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def mix(counts: dict[str, int], numbers: int, read: int, written: int, chains: int) -> Callable[[int], None]:
    """What runs some times a loop over vectors with the mix of ``counts``, in so many chains of operations.

    ``numbers`` is how many pairs or unknowns the kernel goes through, ``read`` how many doubles it reads alone,
    ``written`` how many it writes: the loop goes through as many of each. What is read is used at once and forgotten,
    so that nothing has to be kept elsewhere than in registers.
    """
    each = {kind: round(counts[kind] / numbers) for kind in KINDS}
    sources, targets = (max(round(doubles / numbers), 1) for doubles in (read, written))
    size = numbers + lanes.WIDTH  # streams that are used more than once are read a number further
    loads, stores = each["loads"], each["stores"]
    work = ["r{c} = r{c} * x"] * each["multiplications"] + ["r{c} = select(r{c} > x, x, r{c})"] * each["selections"]
    work += ["r{c} = r{c} + x"] * each["additions"]
    order = np.random.default_rng(0).permutation(len(work))
    lines = ["def loop(times, source, target, size, numbers):", "    like = spread(0.0)", "    for _ in range(times):"]
    lines += ["        for k in range(0, numbers, WIDTH):"]
    done = 0
    for m in range(loads):
        lines.append(f"            x = take(source, {m % sources} * size + k + {m // sources}, like)")
        lines += ["            x = root(x)"] * (m < each["roots"]) + ["            x = 1.0 / x"] * (
            m < each["divisions"]
        )
        if m < chains:
            lines.append(f"            r{m} = x")
            continue
        until = round(len(work) * (m + 1 - chains) / (loads - chains))
        lines += [f"            {work[order[w]]}".format(c=w % chains) for w in range(done, until)]
        done = until
    lines += [
        f"            put(target, {m % targets} * size + k + {m // targets}, r{m % chains})" for m in range(stores)
    ]
    names: dict[str, Any] = {name: getattr(lanes, name) for name in ("spread", "take", "put", "root", "select")}
    names["WIDTH"] = lanes.WIDTH
    exec("\n".join(lines), names)
    loop = nb.njit(error_model="numpy", _nrt=False)(names["loop"])
    source = lanes.aligned(np.random.default_rng(1).uniform(0.9, 1.1, (sources + 1) * size))
    target = lanes.aligned_zeros((targets + 1) * size)
    whole = numbers - numbers % lanes.WIDTH
    return lambda times: loop(times, source, target, size, whole)


def extents(dynamics: Dynamics, part: str) -> tuple[int, int, int]:
    """Pairs or unknowns that a part of a step goes through, and the doubles that it reads alone, and writes."""
    n, pairs = dynamics.model.n, dynamics.model.pairs
    frictional = pairs.spring is not None
    if part == "pair forces":
        slots = pairs.reach.size
        if frictional:  # separation and reach, with places, velocities and rims; spring and forces
            return slots, 3 * slots + 5 * n, slots + 3 * n
        return slots, 3 * slots + 4 * n, 2 * n
    unknowns = dynamics.q.size  # forces and inverse masses; places, velocities, what Beeman keeps, what forces see
    return unknowns, 2 * unknowns, 5 * unknowns


def kernels(friction: float) -> list[dict[str, Any]]:
    """One record for each part of a step."""
    parts, dynamics = kernel.parts(LAYERS, PER_ROW, friction, SETTLE, TIMES)
    counts = counted(friction)
    mixes = [mix(counts[part], *extents(dynamics, part), chains) for part in counts for chains in CHAINS]
    actions = [parts[part] for part in counts] + [lambda run=run: run(TIMES) for run in mixes]
    for action in actions:
        action()  # compiles
    seconds = interleaved(actions, REPEATS, time.process_time)
    rows = []
    for k, (part, count) in enumerate(counts.items()):
        first = len(counts) + len(CHAINS) * k
        mixed = seconds[first : first + len(CHAINS)]
        took, limit, chained = (1e6 * s / TIMES for s in (seconds[k], min(mixed), mixed[0]))
        operations = sum(count[kind] for kind in KINDS[:5])
        moved = 8 * (count["loads"] + count["stores"])
        rows.append(
            {
                "part": part, "friction": friction, "disks": dynamics.problem.n, "operations": operations,
                "divisions_and_roots": count["divisions"] + count["roots"], "bytes": moved, "microseconds": took,
                "mix_microseconds": limit, "chain_microseconds": chained, "ratio": limit / took,
                "gigaflops": 1e-3 * operations / took, "gigabytes_per_second": 1e-3 * moved / took,
            }
        )  # fmt: skip
        print(rows[-1], flush=True)
    return rows


def dense(own: int, outer: int, symmetric: bool) -> float:
    """Operations of a front that eliminates ``own`` unknowns and leaves ``outer``; of a band, one column at a time."""
    left = own + outer - 1.0 - np.arange(own)
    return float((left * left + left).sum() if symmetric else (2.0 * left * left + left).sum())


def front_sizes(fronts) -> list[tuple[int, int]]:
    """Unknowns that each front eliminates and leaves."""
    return list(zip(fronts.own.tolist(), fronts.outer.tolist(), strict=True))


def bare(sizes: list[tuple[int, int]], symmetric: bool) -> Callable[[], float]:
    """Seconds in LAPACK and BLAS for the dense factorisations of fronts, of numbers that need no exchanges."""
    rng = np.random.default_rng(0)
    largest = max(own + outer for own, outer in sizes)
    pool = rng.uniform(-1.0, 1.0, (largest, largest)) / largest

    def run() -> float:
        seconds = 0.0
        for own, outer in sizes:
            f11 = np.asfortranarray(pool[:own, :own] + pool[:own, :own].T)
            f11[np.arange(own), np.arange(own)] += 2.0
            f21, f12 = pool[:outer, :own].copy(order="F"), pool[:own, :outer].copy(order="F")
            f22 = np.zeros((outer, outer), order="F")
            start = time.process_time()
            if symmetric:
                lower, _ = lapack.dpotrf(f11, lower=1, clean=0, overwrite_a=1)
                if outer:
                    f21 = blas.dtrsm(1.0, lower, f21, side=1, lower=1, trans_a=1, overwrite_b=1)
                    blas.dsyrk(-1.0, f21, beta=1.0, c=f22, lower=1, overwrite_c=1)
            else:
                f11, pivot, _ = lapack.dgetrf(f11, overwrite_a=1)
                if outer:
                    f12 = lapack.dlaswp(f12, pivot, overwrite_a=1)
                    f12 = blas.dtrsm(1.0, f11, f12, lower=1, diag=1, overwrite_b=1)
                    f21 = blas.dtrsm(1.0, f11, f21, side=1, overwrite_b=1)
                    blas.dgemm(-1.0, f21, f12, beta=1.0, c=f22, overwrite_c=1)
            seconds += time.process_time() - start
        return seconds

    return run


def factorisations(layers: int, per_row: int, friction: float) -> list[dict[str, Any]]:
    """One record for each of band and fronts, with the matrix product in the same turns."""
    (banded, band), (dissected, fronts) = linear.systems(layers, per_row, friction)
    symmetric = friction == 0.0
    width = linear.band_places(banded)[0]
    sizes = front_sizes(fronts)
    left = np.minimum(width, banded.shape[0] - 1 - np.arange(banded.shape[0])).astype(float)
    operations = {
        "band": float((2.0 * left * left + left).sum()),
        "fronts": sum(dense(own, outer, symmetric) for own, outer in sizes),
    }
    one = np.random.default_rng(0).uniform(size=(PRODUCT, PRODUCT))
    actions: dict[str, Callable[[], object]] = {"product": lambda: one @ one}
    if width <= linear.WIDEST:
        actions["band"] = lambda: band.factor(banded)
    actions["fronts"] = lambda: (fronts.definite_factor if symmetric else fronts.factor)(dissected)
    for action in actions.values():
        action()
    repeats = 15 if layers < 60 else 5
    seconds = dict(zip(actions, interleaved(list(actions.values()), repeats, time.process_time), strict=True))
    run = bare(sizes, symmetric)
    dense_seconds = min(run() for _ in range(repeats))
    product = 2e-9 * PRODUCT**3 / seconds["product"]
    rows = []
    for method in ("band", "fronts"):
        if method in seconds:
            rate = 1e-9 * operations[method] / seconds[method]
            is_fronts = method == "fronts"
            rows.append(
                {
                    "friction": friction, "unknowns": banded.shape[0], "method": method,
                    "size": width if method == "band" else max(own for own, _ in sizes),
                    "operations": operations[method], "milliseconds": 1e3 * seconds[method], "gigaflops": rate,
                    "product_gigaflops": product, "ratio": rate / product,
                    "bare_share": dense_seconds / seconds["fronts"] if is_fronts else None,
                    "bare_ratio": 1e-9 * operations["fronts"] / dense_seconds / product if is_fronts else None,
                }
            )  # fmt: skip
            print(rows[-1], flush=True)
    return rows


def main(path: str) -> None:
    runs = [row for friction in (0.2, 0.0) for row in kernels(friction)]
    factors = [row for friction in (0.2, 0.0) for slab in FACTORISED for row in factorisations(*slab, friction)]
    write(path, {"runs": runs, "factorisations": factors})


if __name__ == "__main__":
    main(sys.argv[1])
