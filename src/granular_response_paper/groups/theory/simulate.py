"""Predictions without simulation: Fig. 1, the peak criterion of Sec. V.C, and the lattice moduli tested.

``predictions`` holds the pressure on the floor under the elliptic and the hyperbolic description,
``peak_criterion`` the function r and its roots, ``moduli`` eqs. (7)-(10) beside the moduli of a periodic
lattice that was strained.
"""

from __future__ import annotations

from typing import get_args

import numpy as np
import xarray as xr

from granular_response.store.variables import variable
from granular_response.theory import crossover, half_plane, lattice, rays
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab
from granular_response_paper.groups.theory.parameters import Parameters
from granular_response_paper.records import axes

#: Lattices whose moduli are measured: equal bonds, normal springs alone, no horizontal ones, all different.
SPRINGS = (
    Springs.uniform(1.0, 0.0),
    Springs.uniform(1.0, 0.8),
    Springs(0.25, 1.0),
    Springs(0.0, 1.0, 0.0, 0.3),
    Springs(0.7, 1.3, 0.2, 0.9),
    Springs(2.0, 0.5, 1.7, 0.1),
)
ROTATIONS = get_args(lattice.Rotations)
BODIES = get_args(crossover.Body)

_BETA = np.linspace(0.0, 1.0, 101)


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``predictions``, ``peak_criterion`` and ``moduli``; fractions of a second."""
    return {
        "predictions": _predictions(parameters),
        "peak_criterion": _peak_criterion(),
        "moduli": _moduli(),
    }


def _predictions(values: Parameters) -> xr.Dataset:
    x = np.linspace(-values.half_width, values.half_width, values.points)
    poisson_ratio = lattice.poisson_ratio(1.0, values.stiffness_ratio)
    solid = Moduli.isotropic(poisson_ratio)
    pressure = "floor pressure times slab height / force"
    hyperbolic = [
        depth
        * rays.pressure(
            x * depth,
            depth,
            angle=np.radians(values.ray_angle),
            diffusion_length=values.diffusion_length,
        )
        for depth in values.depths
    ]
    return xr.Dataset(
        {
            "slab_rough": variable("x", Slab(1.0, solid, "rough").floor_pressure(x), f"{pressure}, rough floor"),
            "slab_smooth": variable("x", Slab(1.0, solid, "smooth").floor_pressure(x), f"{pressure}, smooth floor"),
            "half_plane": variable(
                "x",
                half_plane.pressure(x, 1.0, solid),
                "pressure times depth / force in a half plane, same depth",
            ),
            "rays": variable(("depth", "x"), np.stack(hyperbolic), f"{pressure}, two diffusing rays"),
            "poisson_ratio": variable((), poisson_ratio, "two-dimensional Poisson ratio of the elastic slab"),
            "ray_angle": variable((), values.ray_angle, "angle of the rays to the vertical in degrees"),
            "diffusion_length": variable(
                (), values.diffusion_length, "squared width of a ray over depth, in mean disk radii"
            ),
        },
        coords=axes(
            x=(x, "distance from the force in slab heights"), depth=(values.depths, "slab height in mean disk radii")
        ),
    )


def _peak_criterion() -> xr.Dataset:
    names = ("rotations", "beta")
    criterion = [[lattice.peak_criterion(beta, rotations) for beta in _BETA] for rotations in ROTATIONS]
    ratio = [[crossover.stiffness_ratio(body, rotations) for body in BODIES] for rotations in ROTATIONS]
    return xr.Dataset(
        {
            "criterion": variable(names, criterion, "r of the lattice without horizontal springs; two peaks if < 0"),
            "root": variable(
                "rotations", [lattice.peak_criterion_root(r) for r in ROTATIONS], "k_2t/k_2n at which r = 0"
            ),
            "root_closed_form": variable("rotations", [2.0 * np.sqrt(7.0) - 5.0, 3.0 / 11.0], "the same, closed form"),
            "crossover": variable(
                ("rotations", "body"),
                ratio,
                "k_2t/k_2n at which the pressure below the force turns into a minimum",
            ),
        },
        coords=axes(
            beta=(_BETA, "k_2t/k_2n"),
            rotations=(ROTATIONS, "whether the disks turn"),
            body=(BODIES, "elastic body that carries the force"),
        ),
    )


def _moduli() -> xr.Dataset:
    component = ["xx", "zz", "xz"]
    formula = [[lattice.moduli(springs, r).matrix() for springs in SPRINGS] for r in ROTATIONS]
    measured = [[lattice.measured_moduli(springs, r) for springs in SPRINGS] for r in ROTATIONS]
    error = np.abs(np.subtract(measured, formula)).max(axis=(2, 3)) / np.max(formula, axis=(2, 3))
    dims = ("rotations", "case", "stress", "strain")
    return xr.Dataset(
        {
            "formula": variable(dims, formula, "modulus of eqs. (7)-(10), or with free rotations"),
            "measured": variable(dims, measured, "modulus of the strained periodic lattice, relaxed"),
            "error": variable(dims[:2], error, "largest difference of the two / largest modulus"),
            "springs": variable(
                ("case", "spring"),
                [[s.k1n, s.k2n, s.k1t, s.k2t] for s in SPRINGS],
                "stiffness of the lattice's springs",
            ),
        },
        coords=axes(
            rotations=(ROTATIONS, "whether the disks turn"),
            spring=(["k1n", "k2n", "k1t", "k2t"], "spring of Fig. 11"),
            stress=(component, "stress component"),
            strain=(component, "strain component (tensor)"),
        ),
    )
