"""Figs. 13 to 15 on a slab of 7 layers, from parameters through a file to figures."""

import numpy as np

from granular_response.state import FLOOR
from granular_response_paper.groups.friction_fields import draw as figures


def test_stress_carries_the_load(datasets) -> None:
    """Over a line between load and floor sigma_zz of the added forces sums to the force, in every medium."""
    stress = datasets["stress"]
    row = stress.sel(z=6.0)
    step = float(stress["x"][1] - stress["x"][0])
    np.testing.assert_allclose(row["stress_zz_lattice"].sum("x") * step, 1.0, atol=1e-3)
    np.testing.assert_allclose(row["stress_zz"][0].sum("x") * step, 1.0, atol=0.01)  # some lies beyond the walls
    # frictional side walls take a little of it, or add to it
    np.testing.assert_allclose(row["stress_zz"][1:].sum("x") * step, 1.0, atol=0.03)


def test_the_floor_carries_what_is_drawn_there(datasets) -> None:
    """At the floor the drawn stress is the smoothed floor force, which is stored, within a twentieth."""
    forces, stress = datasets["forces"], datasets["stress"]
    on_floor = forces["wall_index"].values == FLOOR
    w, disks = float(stress["stress_width"]), forces["wall_disk"].values[on_floor]
    for index, field in enumerate(stress["stress_zz"].values):
        at = forces["position"].values[index, disks, 0] - 0.5 * float(forces["width"])
        pushed = forces["wall_added_force"].values[index, on_floor, 1] / float(forces["force"])
        near = np.exp(-(((stress["x"].values[:, None] - at) / w) ** 2)) / (np.sqrt(np.pi) * w)
        drawn = figures.to_floor(field, stress["z"].values, w)[0]
        np.testing.assert_allclose(drawn, near @ pushed, atol=0.05 * drawn.max())
