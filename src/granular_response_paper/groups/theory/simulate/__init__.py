"""Predictions without simulation, Fig. 1: the pressure on the floor by the elliptic and the hyperbolic description."""

from __future__ import annotations

import numpy as np
import xarray as xr

from granular_response.theory import half_plane, lattice, rays
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab
from granular_response_paper.groups.theory.parameters import Parameters
from granular_response_paper.records import axes, variables


def simulate(p: Parameters) -> dict[str, xr.Dataset]:
    """Dataset ``predictions``; fractions of a second."""
    x = np.linspace(-p.half_width, p.half_width, p.points)
    poisson_ratio = lattice.poisson_ratio(1.0, p.stiffness_ratio)
    solid = Moduli.isotropic(poisson_ratio)
    rough, smooth = (Slab(1.0, solid, floor).floor_pressure(x) for floor in ("rough", "smooth"))
    ray = {"angle": np.radians(p.ray_angle), "diffusion_length": p.diffusion_length}
    hyperbolic = [depth * rays.pressure(x * depth, depth, **ray) for depth in p.depths]
    pressure = "floor pressure times slab height / force"
    below = half_plane.pressure(x, 1.0, solid), "pressure times depth / force in a half plane, same depth"
    predictions = xr.Dataset(
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
    return {"predictions": predictions}
