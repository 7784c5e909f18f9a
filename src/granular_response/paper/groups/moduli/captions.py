"""What the figures of this group show."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import xarray as xr

from granular_response.paper.captions import Caption, of_scene, values

from .parameters import Parameters


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    packing = f"slabs with periodic sides, {parameters.disks_per_layer} disks in a row for each layer"
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None, packing=packing)
    group = parameters.lattice
    most = [max(map(sum, zip(case.realizations, case.further, strict=True))) for case in parameters.cases]
    surveyed: Counter[int] = Counter()
    for case in parameters.cases:
        surveyed.update(dict(zip(case.layers, case.further, strict=True)))
    stored = [f"{count} of {layers} layers" for layers, count in sorted(surveyed.items()) if count]
    survey = f" Packings of the survey, which the pipeline reads: {', '.join(stored)}." if stored else ""
    edges = " Black edges: at least half of the packings are the survey's." if stored else ""
    ensemble = f"{min(most)} to {max(most)}" if min(most) != max(most) else f"{most[0]}"
    tolerances = values([100.0 * tolerance for tolerance in parameters.tolerances])
    lattice = {"wall_friction": 0.0, "packing": None, "stiffness_ratio": None}
    return {
        "moduli_packings": Caption(
            "Not in the paper: moduli of disordered packings over k_N, from the change of their contact forces under "
            "uniform strain, against their contacts per disk (those of disks that bear something; the more layers, the "
            "more contacts). (a) Bulk and (b) shear modulus of the isotropic solid nearest to them, (c) horizontal "
            "over vertical modulus. Open symbols: every disk moves with the strain, and none turns; filled: disks move "
            "and turn as equilibrium wants. Bars are standard deviations over realizations, up to "
            f"{ensemble} of each size.{survey}",
            "Three panels of symbols against the number of contacts; filled symbols lie below open ones, most of all "
            "for the shear modulus, and the horizontal modulus below the vertical one but for large polydispersity.",
            said,
        ),
        "moduli_response": Caption(
            "Response of the floor to a small vertical force on the top, mean over all disks of the top row "
            f"(smoothed, w = {parameters.width:g}; band: standard deviation over packings), and that of elastic slabs "
            "with the moduli measured by straining these packings: no parameter is fitted. Exact in the limit of small "
            "forces; contacts at the limit of Coulomb stick. (a) to (f) packings as named. The floor has the friction "
            f"of the disks.{survey}",
            "Six panels of single peaks; with friction the measured curve and those of the slabs lie on each other, "
            "without friction they do not.",
            said,
        ),
        "moduli_size": Caption(
            "Largest difference of the response to the slab of the packing's own moduli, against the number of layers, "
            "with 95 % intervals of the mean over packings: (a) of one load, smoothed over "
            f"{parameters.wide:.3g} of the height; (b) of the mean over the loads of one packing. Grey lines: "
            f"{tolerances} %.{edges}",
            "Double logarithmic panels: falling lines for packings with friction, flat ones near and above 1 without.",
            said,
        ),
        "moduli_lattice": Caption(
            "Moduli a, b, c, d of eq. (6) over k_N of lattices with free rotations, measured (symbols) and in closed "
            "form (lines): horizontal contacts (a) closed and (b) open. (c) k_T/k_N at which the response turns from "
            "two peaks to one without horizontal contacts: by the closed form (lines), by the measured moduli (symbols "
            "at 0) in a half plane and in a slab on a smooth floor, with rotations free and suppressed, and in "
            "lattices under a small force (diamonds), which tend to the slab with free rotations.",
            "Symbols on lines in two panels; in the third one four horizontal lines and diamonds that rise towards "
            "the second lowest as the number of layers grows.",
            of_scene(parameters.base, friction=group.friction, **lattice),
        ),
    }
