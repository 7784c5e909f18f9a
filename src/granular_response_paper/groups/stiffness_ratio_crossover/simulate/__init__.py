"""Large friction: how the response depends on the ratio of tangential to normal stiffness (Secs. V.B, V.C).

Fig. 10 and claims K1, K6 and K7. With a coefficient of friction that is hardly ever reached, weaker tangential springs
turn one peak into two. ``response`` holds the simulated profiles; ``elastic`` those of elastic bodies with the
moduli of the spring model without its horizontal springs, which the load has opened, and ``events`` the
ratios at which the simulated profile changes its form.

The two events do not coincide: between them the middle of the profile is flat to a few thousandths of its height,
and small peaks come and go with the contacts that are open at rest. Every ratio has a rest state of its own.
At a ratio of zero there are no tangential forces: that packing is frictionless, and its states are found as minima
of the energy whatever ``method`` says.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import get_args

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.observe.peaks import central_dip
from granular_response.scene import Scene
from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.theory import half_plane, lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.slab import response_of_layers
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.stiffness_ratio_crossover.parameters import Parameters
from granular_response_paper.records import axes, column, record, table, variables
from granular_response_paper.tasks import computed

BODIES = ("half plane", "smooth floor")
ROTATIONS: tuple[lattice.Rotations, ...] = get_args(lattice.Rotations)

#: Further ratios at which the elastic bodies are computed, which costs next to nothing.
ELASTIC_RATIOS = np.round(np.arange(0.025, 1.0, 0.025), 3)

#: What happens at a ratio, and whether it has in what was measured there.
EVENTS: dict[str, tuple[str, Callable[[xr.Dataset], bool]]] = {
    "two_peaks_end": (
        "the first stiffness ratio, going up, at which the floor response has no two peaks each "
        "higher than the response at x = 0 by a thousandth of the largest response",
        lambda measured: not measured["double_peaked"][0],
    ),
    "central_maximum_begins": (
        "the stiffness ratio above which the floor response is largest at x = 0, at every ratio of the axis",
        lambda measured: bool(measured["central_dip"][0] < 0.0),
    ),
}

RATIO = "tangential stiffness over normal stiffness"


def measure(base: Scene, ratio: float, force: float) -> tuple[xr.Dataset, str]:
    """The measured response of a packing at one stiffness ratio, and the method that found it."""
    scene = base.updated({"contact.stiffness_ratio": ratio})
    path = studies.LoadPath.of(scene if ratio else scene.updated({"protocol.method": "auto"}))
    return slab.measured(studies.Measures(path), [path.at(force)]), path.method


def narrow(name: str, base: Scene, force: float, low: float, high: float, tolerance: float) -> tuple[float, float]:
    """Bisect an event of ``EVENTS`` between two ratios; every evaluation settles and loads a packing."""
    _, happened = EVENTS[name]

    def has(ratio: float) -> bool:
        return happened(measure(base, ratio, force)[0])

    return studies.bisect_event(has, low, high, tolerance, at_low=False, at_high=True).ends


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``response``, ``elastic`` and ``events``."""
    base, force, tolerance = parameters.base, parameters.force, parameters.tolerance
    ratios = np.array(parameters.ratios)
    results = computed({ratio: partial(measure, base, ratio, force) for ratio in ratios.tolist()}, "stiffness ratios")
    measured, methods = zip(*results.values(), strict=True)

    ended, central = ([happened(one) for one in measured] for _, happened in EVENTS.values())
    # the last stretch of ratios with the maximum at the centre; there may be others below it
    begun = [all(central[k:]) for k in range(len(central))]
    brackets: dict[str, tuple[float, float]] = {
        name: studies.first_change(ratios, has) for name, has in zip(EVENTS, (ended, begun), strict=True)
    }
    searches = {
        name: partial(narrow, name, base, force, low, high, tolerance)
        for name, (low, high) in brackets.items()
        if np.isfinite(high) and low > 0.0 and high - low > tolerance
    }
    brackets |= computed(searches, "crossovers")
    found = [slab.Event(name, base.contact.friction, *brackets[name], text) for name, (text, _) in EVENTS.items()]
    events = table(found, "event").drop_vars("friction")
    events["low"].attrs["long_name"] = "stiffness ratio before the event"

    further = variables(
        force=("", force, f"applied force {WEIGHTS}"),
        methods=("stiffness_ratio", methods, "method that found the loaded state"),
    )
    response = slab.measured_along("stiffness_ratio", measured).assign_coords(axes(stiffness_ratio=(ratios, RATIO)))
    packing, x = base.packing.build(), measured[0]["x"].values
    elastic = elastic_bodies(np.union1d(ratios, ELASTIC_RATIOS), x, packing.row_count.size, packing.width)
    return labelled({"response": response.assign(further), "elastic": elastic, "events": events}, base)


@record
class Elastic:
    """An elastic body."""

    profile: FloatArray = column("force on a floor disk per applied force", "floor_disk")
    central_dip: float = column("how far the profile at x = 0 is below the lower maximum beside it, per largest value")


def elastic_bodies(ratios: FloatArray, x: FloatArray, layers: int, width: float) -> xr.Dataset:
    """Elastic bodies with the moduli of the spring model without horizontal springs (Sec. V.C); claim K6.

    Disks turn. What a floor disk at ``x`` gets of a unit force is the pressure on the diameter below it, of the half
    plane at the depth of the floor or of a slab of ``layers`` disk layers between smooth walls ``width`` apart. It is
    nan at a ratio of zero, where the lattice resists some strain not at all.
    """
    node, weight = np.polynomial.legendre.leggauss(8)
    found: dict[tuple[int, int], Elastic] = {}
    for k in np.flatnonzero(ratios).tolist():
        moduli = lattice.moduli(Springs(0.0, 1.0, 0.0, ratios[k]), "free")
        plane = half_plane.pressure(x[:, None] + node, np.sqrt(3.0) * layers, moduli) @ weight
        slab = response_of_layers(x, layers=layers, moduli=moduli, floor="smooth", width=width)
        found |= {(b, k): Elastic(profile, central_dip(x, profile)) for b, profile in enumerate((plane, slab))}
    roots = [lattice.peak_criterion_root(rotations) for rotations in ROTATIONS]
    places = variables(x=("floor_disk", x, f"position of the floor disk from the load {RADII}")) | axes(
        stiffness_ratio=(ratios, RATIO),
        body=(BODIES, "elastic body that carries the force"),
        rotations=(ROTATIONS, "whether the disks turn"),
    )
    data = table(found, "body", "stiffness_ratio").assign_coords(places)
    return data.assign(variables(root=("rotations", roots, "k_2t/k_2n at which r of Sec. V.C is 0")))
