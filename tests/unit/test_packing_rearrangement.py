"""Where the neighbours in the lattice are all contacts that can form.

The scenes in which other disks did touch, and those near the limit in which they did not, come from simulations
without friction that followed all pairs.
"""

import numpy as np
import pytest

from granular_response.scene import FilePacking, PilePacking, SlabPacking

TOUCHED = {
    "thrown up": (SlabPacking(disks_per_row=21, polydispersity=0.1), 3000.0),
    "thrown up, soft": (SlabPacking(disks_per_row=21, polydispersity=0.2), 100.0),
    "loose rows": (SlabPacking(disks_per_row=21, polydispersity=0.1, lattice_constant="touching-largest"), 3000.0),
    "loose, soft rows": (SlabPacking(disks_per_row=21, lattice_constant=2.05), 100.0),
    "rolled off a pile": (PilePacking(polydispersity=0.03), 3000.0),
    "tall and soft": (SlabPacking(layers=40, disks_per_row=11), 200.0),
    "tall and narrow": (SlabPacking(layers=100, disks_per_row=7), 1115.0),
    "wide and soft": (SlabPacking(disks_per_row=481, polydispersity=1e-4), 500.0),
    "wide, flat and soft": (SlabPacking(layers=5, disks_per_row=481, polydispersity=1e-4), 166.0),
    "wide and tall": (SlabPacking(layers=60, disks_per_row=121), 1150.0),
    "tall pile": (PilePacking(layers=20), 1700.0),
    "very tall pile": (PilePacking(layers=35), 8750.0),
}

KEPT = {
    "the paper's slab": (SlabPacking(), 3000.0),
    "the softest of Sec. IV.C": (SlabPacking(), 1000.0),
    "the stiffest of Sec. IV.C": (SlabPacking(), 1e5),
    "30 layers": (SlabPacking(layers=30, disks_per_row=121), 3000.0),
    "slightly polydisperse": (SlabPacking(layers=13, disks_per_row=25, polydispersity=1e-3), 3000.0),
    "delta 0.01": (SlabPacking(polydispersity=0.01), 3000.0),
    "delta 0.01 without overlaps": (
        SlabPacking(disks_per_row=21, polydispersity=0.01, lattice_constant="touching-largest"),
        3000.0,
    ),
    "the paper's pile": (PilePacking(), 3000.0),
}


@pytest.mark.parametrize("name", TOUCHED)
def test_never_denied_where_it_happened(name):
    described, stiffness = TOUCHED[name]
    assert described.build().may_rearrange(stiffness)


@pytest.mark.parametrize("name", KEPT)
def test_denied_for_small_disorder(name):
    described, stiffness = KEPT[name]
    for realization in range(5):
        packing = described.model_copy(update={"realization": realization}).build()
        assert not packing.may_rearrange(stiffness)


def test_depends_on_stiffness_and_damping():
    packing = SlabPacking(polydispersity=0.01).build()
    assert not packing.may_rearrange(3000.0)
    assert packing.may_rearrange(1e5)  # the same overlap throws disks up higher
    assert packing.may_rearrange(100.0)  # sags under its own weight
    assert packing.may_rearrange(3000.0, wall_stiffness=1e6)
    assert packing.may_rearrange(3000.0, damping_ratio=0.0)


def test_files_may_always(tmp_path):
    (tmp_path / "one.csv").write_text("x,z,radius\n1,1,1\n")
    packing = FilePacking(path=str(tmp_path / "one.csv"), width=2.0).build()
    assert packing.neighbour_pairs() is None
    assert packing.may_rearrange(3000.0)
    assert np.array_equal(packing.row, [-1])
