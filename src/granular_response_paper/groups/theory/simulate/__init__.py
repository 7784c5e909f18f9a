"""Predictions without simulation: Fig. 1, the peak criterion of Sec. V.C, and the lattice moduli tested.

``predictions`` holds the pressure on the floor under the elliptic and the hyperbolic description,
``peak_criterion`` the function r and its roots, ``moduli`` how far eqs. (7)-(10) are from the moduli of a periodic
lattice that was strained.
"""

from __future__ import annotations

from typing import get_args

import numpy as np
import xarray as xr

from granular_response.theory import half_plane, lattice, rays
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab
from granular_response_paper.groups.theory.parameters import Parameters
from granular_response_paper.records import axes, variables

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
TURNING = axes(rotations=(ROTATIONS, "whether the disks turn"))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``predictions``, ``peak_criterion`` and ``moduli``; fractions of a second."""
    return {"predictions": _predictions(parameters), "peak_criterion": _peak_criterion(), "moduli": _moduli()}


def _predictions(p: Parameters) -> xr.Dataset:
    x = np.linspace(-p.half_width, p.half_width, p.points)
    poisson_ratio = lattice.poisson_ratio(1.0, p.stiffness_ratio)
    solid = Moduli.isotropic(poisson_ratio)
    rough, smooth = (Slab(1.0, solid, floor).floor_pressure(x) for floor in ("rough", "smooth"))
    ray = {"angle": np.radians(p.ray_angle), "diffusion_length": p.diffusion_length}
    hyperbolic = [depth * rays.pressure(x * depth, depth, **ray) for depth in p.depths]
    pressure = "floor pressure times slab height / force"
    below = half_plane.pressure(x, 1.0, solid), "pressure times depth / force in a half plane, same depth"
    return xr.Dataset(
        variables(
            slab_rough=("x", rough, f"{pressure}, rough floor"),
            slab_smooth=("x", smooth, f"{pressure}, smooth floor"),
            half_plane=("x", *below),
            rays=("depth x", hyperbolic, f"{pressure}, two diffusing rays"),
            poisson_ratio=("", poisson_ratio, "two-dimensional Poisson ratio of the elastic slab"),
            ray_angle=("", p.ray_angle, "angle of the rays to the vertical in degrees"),
        ),
        axes(x=(x, "distance from the force in slab heights"), depth=(p.depths, "slab height in mean disk radii")),
    )


def _peak_criterion() -> xr.Dataset:
    beta = np.linspace(0.0, 1.0, 101)
    criterion = [[lattice.peak_criterion(one, rotations) for one in beta] for rotations in ROTATIONS]
    root = [lattice.peak_criterion_root(rotations) for rotations in ROTATIONS]
    return xr.Dataset(
        variables(
            criterion=("rotations beta", criterion, "r of the lattice without horizontal springs; two peaks if < 0"),
            root=("rotations", root, "k_2t/k_2n at which r = 0"),
            root_closed_form=("rotations", [2.0 * np.sqrt(7.0) - 5.0, 3.0 / 11.0], "the same, closed form"),
        ),
        axes(beta=(beta, "k_2t/k_2n")) | TURNING,
    )


def _moduli() -> xr.Dataset:
    formula = [[lattice.moduli(springs, rotations).matrix() for springs in SPRINGS] for rotations in ROTATIONS]
    measured = [[lattice.measured_moduli(springs, rotations) for springs in SPRINGS] for rotations in ROTATIONS]
    error = np.abs(np.subtract(measured, formula)).max(axis=(2, 3)) / np.max(formula, axis=(2, 3))
    off = "largest difference of the moduli of a strained periodic lattice from eqs. (7)-(10) / largest modulus"
    return xr.Dataset(variables(error=("rotations case", error, off)), TURNING)
