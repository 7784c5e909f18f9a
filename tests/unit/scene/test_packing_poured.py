"""Poured disks: the same each time, without overlaps, each at rest on what is below it."""

import numpy as np
import pytest
from refusals import refusals

import granular_response as gr

KINDS = {
    "walls": {"disks": 120, "width": 20.0},
    "periodic": {"disks": 120, "width": 20.0, "sides": "periodic"},
    "two sizes": {"disks": 150, "width": 24.0, "sizes": [1.0, 3.0], "fractions": [3, 1], "polydispersity": 0.0},
    "equal": {"disks": 80, "width": 15.0, "polydispersity": 0.0},
    "a column": {"disks": 12, "width": 3.0},
}


def gaps(packing) -> np.ndarray:
    """(n, n) distances of the rims."""
    away = packing.box.separation(packing.position[:, None], packing.position[None])
    found = np.hypot(away[..., 0], away[..., 1]) - packing.radius[:, None] - packing.radius
    np.fill_diagonal(found, np.inf)
    return found


@pytest.mark.parametrize("keys", KINDS.values(), ids=KINDS)
def test_disks_lie_on_others_and_overlap_nowhere(keys):
    packing = gr.Poured(**keys).build()
    apart, (x, z), radius = gaps(packing), packing.position.T, packing.radius
    assert packing.n == keys["disks"] and radius.mean() == pytest.approx(1.0)
    assert apart.min() > -1e-9 and (z - radius).min() > -1e-9
    if not packing.periodic:
        assert (x - radius).min() > -1e-9 and (x + radius).max() < packing.width + 1e-9
    on_others = ((apart < 1e-9) & (z[None] < z[:, None] + radius)).any(axis=1)
    assert (on_others | (z - radius < 1e-9)).all()


def test_seed_and_realization_fix_the_packing():
    packings = [
        gr.Poured(disks=40, width=12.0, seed=s, realization=r).build() for s, r in ((1, 0), (1, 0), (2, 0), (1, 1))
    ]
    first = packings[0].position
    assert [np.array_equal(first, one.position) for one in packings] == [True, True, False, False]


def test_sizes_are_as_asked():
    radius = gr.Poured(disks=4000, width=100.0, sizes=[1.0, 2.0], fractions=[3, 1], polydispersity=0.0)._radius()
    small, large = np.unique(radius.round(9))
    assert large / small == pytest.approx(2.0)
    assert (radius < 1.5 * small).mean() == pytest.approx(0.75, abs=0.03)


test_what_cannot_be_poured_is_refused = refusals(
    gr.SceneError,
    (lambda: gr.Poured(disks=0), "disks = 0: must be a whole number from 1 to 20000"),
    (lambda: gr.Poured(width=1.0), "width = 1.0: must be from"),
    (lambda: gr.Poured(sizes=[1.0, -1.0]), r"sizes = \[1.0, -1.0\]: must be a list of numbers greater than 0"),
    (lambda: gr.Poured(fractions=[1.0, 1.0]), "fractions = .*must have as many numbers as sizes, has 2, not 1"),
    (lambda: gr.Poured(width=4.0, sides="periodic"), "width = 4.0: must be from"),
)
