"""Peaks of a sampled response: how many, where, and what counts as two (Secs. IV.A and V.E).

A peak is a local maximum, not at an end of the samples, whose prominence is at least ``relative_prominence``
times the largest magnitude of the response. Prominence is the height above the ground that must be crossed
on the way to higher samples, or down to the end of the samples on a side that has no higher ones. Maxima
separated by shallower dips are one peak, whose position is the middle of its highest samples; samples that
differ by less than ``ROUNDING`` times that magnitude count as equally high. So a symmetric profile has
symmetric peaks, and rounding noise neither makes nor moves one.

``x`` is measured from the loaded disk and strictly increasing. ``interior`` (a mask over the samples, see
:func:`granular_response.observe.floor.interior_mask`) leaves out what lies near the side walls; without it
all samples count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import check_positive, require
from ..state import FloatArray

#: Mask over the samples; None takes all.
Interior = NDArray[np.bool_] | None

#: A dip shallower than this fraction of the largest response does not separate two peaks. Responses of two
#: correct codes differ by about 1e-4; a dip at the limit of sight in a printed figure is about 1e-2.
RELATIVE_PROMINENCE = 1e-3

#: Samples closer than this fraction of the largest response are equally high. Responses of a symmetric slab,
#: certified to residuals of 1e-9, differ between left and right by up to a few 1e-6.
ROUNDING = 1e-5

#: A third peak is not farther than this from x = 0 (mean radii).
CENTRE = 1.0


@dataclass(frozen=True)
class Peaks:
    """Peaks of a response from left to right, arrays of shape (p,)."""

    position: FloatArray
    height: FloatArray
    prominence: FloatArray  #: equally high peaks are each other's higher ground

    def __len__(self) -> int:
        return int(self.position.size)


@dataclass
class _Hill:
    """A connected set of samples above the current level, while the level sinks."""

    top: float
    summits: list[int]  # samples as high as the top
    recorded: bool = False


def find_peaks(
    x: ArrayLike, response: ArrayLike, *, interior: Interior = None, relative_prominence: float = RELATIVE_PROMINENCE
) -> Peaks:
    """Peaks of a response sampled at ``x`` (both (k,)); the definition is in the module's docstring.

    Raises ``ValueError`` for samples that are too few (below three), not finite or not in order, and for a
    prominence that is not positive.
    """
    x, r = _samples(x, response, interior)
    check_positive(relative_prominence=relative_prominence)
    scale = float(np.max(np.abs(r)))
    threshold, tie = relative_prominence * scale, ROUNDING * scale
    last = r.size - 1
    found: list[tuple[float, float, float]] = []

    def record(hill: _Hill, dip: float) -> None:
        left, right = min(hill.summits), max(hill.summits)
        if not hill.recorded and left > 0 and right < last:
            base = dip
            if hill_at[0] is hill:
                base = max(base, float(r[:left].min()))
            if hill_at[last] is hill:
                base = max(base, float(r[right + 1 :].min()))
            prominence = hill.top - base
            if prominence >= threshold and prominence > tie:
                found.append((0.5 * (x[left] + x[right]), hill.top, prominence))
        hill.recorded = True

    # Sink a level through the samples: hills appear at maxima and meet at the dips between them.
    hill_at: list[_Hill | None] = [None] * r.size
    for i in np.argsort(-r, kind="stable"):
        left = hill_at[i - 1] if i > 0 else None
        right = hill_at[i + 1] if i < last else None
        level = float(r[i])
        if left is not None and right is not None:
            low, high = (left, right) if left.top <= right.top else (right, left)
            if low.top - level < threshold or low.top - level <= tie:
                high.summits = [s for s in high.summits + low.summits if r[s] >= high.top - tie]
            else:
                record(low, level)
                if high.top - low.top <= tie:
                    record(high, level)
            hill_at = [high if hill is low else hill for hill in hill_at]
            here = high
        else:
            here = left or right or _Hill(level, [])
        if level >= here.top - tie:
            here.summits.append(int(i))
        hill_at[i] = here

    highest = hill_at[0]
    assert highest is not None
    record(highest, -np.inf)
    found.sort()
    columns = np.array(found, dtype=float).reshape(-1, 3)
    return Peaks(position=columns[:, 0], height=columns[:, 1], prominence=columns[:, 2])


def central_dip(x: ArrayLike, response: ArrayLike, *, interior: Interior = None) -> float:
    """How far the response at x = 0 lies below the lower of the maxima beside it, per largest response.

    Continuous in the profile: negative while the maximum is at the centre, positive with two peaks, so its
    zero is where a single peak turns into two (Sec. IV.A). The response at 0 is interpolated linearly.
    Raises ``ValueError`` for bad samples, or if x = 0 has no samples on both sides.
    """
    x, r = _samples(x, response, interior)
    require(x[0] < 0.0 < x[-1], f"x: runs from {x[0]} to {x[-1]}; it must have samples on both sides of 0")
    scale = float(np.max(np.abs(r)))
    if scale == 0.0:
        return 0.0
    # A sample on the axis up to rounding belongs to neither side.
    axis = 1e-6 * (x[-1] - x[0])
    sides = min(float(r[x < -axis].max()), float(r[x > axis].max()))
    return (sides - float(np.interp(0.0, x, r))) / scale


def is_double_peaked(
    x: ArrayLike, response: ArrayLike, *, interior: Interior = None, relative_prominence: float = RELATIVE_PROMINENCE
) -> bool:
    """Whether the response has two peaks: the paper's crossover (Secs. IV.A, V.A and V.B).

    That is: on each side of x = 0 there is a peak that exceeds the response at x = 0 by at least
    ``relative_prominence`` times the largest response. A small third peak at x = 0 does not matter. Raises
    ``ValueError`` as :func:`find_peaks`, or if x = 0 has no samples on both sides.
    """
    return _outer_peaks(x, response, interior, relative_prominence) is not None


def third_peak(x: ArrayLike, response: ArrayLike, *, interior: Interior = None) -> float:
    """Prominence of the further peak of a double-peaked response within ``CENTRE`` of x = 0 (Sec. V.E, Fig. 16a).

    0 without one.
    """
    peaks = _outer_peaks(x, response, interior)
    return 0.0 if peaks is None else float(peaks.prominence[np.abs(peaks.position) <= CENTRE].max(initial=0.0))


def asymmetry(x: ArrayLike, response: ArrayLike, *, interior: Interior = None) -> float:
    """Largest ``|r(x) - r(-x)|`` per largest response (Sec. V.E, Fig. 16b): 0 for a symmetric profile.

    ``r(-x)`` is interpolated linearly, which changes nothing where the samples lie symmetrically; samples
    without a counterpart on the other side are left out. Raises ``ValueError`` for bad samples, if
    none has a counterpart, or if the response is nowhere positive.
    """
    x, r = _samples(x, response, interior)
    largest = float(r.max())
    require(largest > 0.0, f"response: its largest value is {largest}; it must be positive somewhere")
    reach = min(-float(x[0]), float(x[-1]))
    both = np.abs(x) <= reach + 1e-6 * (x[-1] - x[0])
    require(np.any(both), f"x: runs from {x[0]} to {x[-1]}; it must have samples on both sides of 0")
    return float(np.max(np.abs(r[both] - np.interp(-x[both], x, r))) / largest)


def asymmetry_sign(x: FloatArray, response: FloatArray) -> int:
    """On which side of x = 0 the response is larger: 1 right, -1 left, 0 if neither."""
    return int(np.sign(response[x > 1e-6].sum() - response[x < -1e-6].sum()))


def _outer_peaks(
    x: ArrayLike, response: ArrayLike, interior: Interior, relative_prominence: float = RELATIVE_PROMINENCE
) -> Peaks | None:
    """All peaks, if there are peaks above the centre on both sides of it; else None."""
    peaks = find_peaks(x, response, interior=interior, relative_prominence=relative_prominence)
    x, r = _samples(x, response, interior)
    require(x[0] < 0.0 < x[-1], f"x: runs from {x[0]} to {x[-1]}; it must have samples on both sides of 0")
    high = peaks.height >= np.interp(0.0, x, r) + relative_prominence * np.max(np.abs(r))
    both = np.any(high & (peaks.position < 0.0)) and np.any(high & (peaks.position > 0.0))
    return peaks if both else None


def _samples(x: ArrayLike, response: ArrayLike, interior: Interior) -> tuple[FloatArray, FloatArray]:
    x, r = np.asarray(x, dtype=float), np.asarray(response, dtype=float)
    rule = f"response: shape {r.shape} given for x of shape {x.shape}; both must be the same 1-D shape"
    require(x.ndim == 1 and x.shape == r.shape, rule)
    if interior is not None:
        mask = np.asarray(interior)
        rule = f"interior: {mask.dtype} of shape {mask.shape} given; it must be bool of shape {x.shape}"
        require(mask.shape == x.shape and mask.dtype == np.bool_, rule)
        x, r = x[mask], r[mask]
    require(x.size >= 3, f"x: {x.size} samples in the interior; at least 3 are needed")
    require(np.all(np.isfinite(x)) and np.all(np.isfinite(r)), "response: contains values that are not finite")
    require(np.all(np.diff(x) > 0.0), "x: must be strictly increasing")
    return x, r
