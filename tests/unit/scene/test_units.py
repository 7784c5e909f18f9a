"""Reduced units against the laboratory's, by hand for the paper's disks."""

from functools import partial

import numpy as np
import pytest
from refusals import refusals

from granular_response.scene import (
    Contact,
    FilePacking,
    LaboratoryUnits,
    Load,
    RowSelector,
    Scene,
    SceneError,
    SlabPacking,
    TopSelector,
)

#: pi (3.75 mm)^2 6.6 mm 1150 kg/m3 = 0.3353 g; weight 3.286 mN; sqrt(3.75 mm / 9.8 m/s2) = 19.56 ms.
BY_HAND = {
    "length": 3.75e-3,
    "mass": 3.353159e-4,
    "time": 1.956152e-2,
    "velocity": 0.1917029,
    "acceleration": 9.8,
    "force": 3.286096e-3,
    "torque": 1.232286e-5,
    "energy": 1.232286e-5,
    "stiffness": 0.8762923,
    "damping": 1.714161e-2,
    "inertia": 4.715380e-9,
    "stress": 0.8762923,
    "pressure": 132.7716,
}


@pytest.mark.parametrize("quantity", BY_HAND)
def test_units_of_the_paper(quantity):
    units = LaboratoryUnits()
    assert units.unit(quantity) == pytest.approx(BY_HAND[quantity], rel=5e-7)
    assert units.to_laboratory(quantity, 3000.0) == pytest.approx(3000.0 * BY_HAND[quantity], rel=5e-7)


test_impossible_disks = refusals(
    SceneError,
    (lambda: LaboratoryUnits(radius=0.0), r"^radius = 0\.0: must be a finite number greater than 0$"),
    (lambda: LaboratoryUnits(gravity=np.inf), "^gravity = inf: must be a finite number greater than 0$"),
    (lambda: LaboratoryUnits(thickness="6.6 mm"), r"^thickness = '6\.6 mm': must be a finite number greater than 0$"),
)


test_reduced_numbers_are_not_taken_for_those_in_si = refusals(
    SceneError,
    *(
        (
            partial(LaboratoryUnits().reduced_scene, data),
            f"^a {name} holds reduced numbers, must be a mapping for those",
        )
        for name, data in {
            "Load": {"loads": [Load(disk=0, force=(0.0, -0.05))]},
            "Contact": {"contact": Contact(normal_stiffness=2629.0)},
            "TopSelector": {"loads": [{"disk": TopSelector(x=0.01), "force": [0.0, -0.05]}]},
            "SlabPacking": {"packing": SlabPacking(lattice_constant=0.0075)},
        }.items()
    ),
    (lambda: LaboratoryUnits().reduced_scene(Scene()), r"^scene = Scene.*: must be a mapping with its keys$"),
)


def test_a_row_has_no_unit():
    data = {"loads": [{"disk": RowSelector(row="top"), "force": [0.0, 0.0]}]}
    assert LaboratoryUnits().reduced_scene(data) == data


def test_the_box_of_poured_disks_has_a_width_in_metres():
    units = LaboratoryUnits()
    poured = units.reduced_scene({"packing": {"kind": "poured", "disks": 20, "width": 0.0375}})
    assert poured["packing"]["width"] == pytest.approx(10.0)
    own = {"packing": {"kind": "file", "path": "disks.csv", "width": 0.0375}}
    assert units.reduced_scene(own) == own


@pytest.mark.parametrize("header", ["x_mm,z_mm,diameter_mm", "X [mm];Z [mm];Diameter [mm]"])
def test_a_table_that_names_its_unit_has_the_mean_radius_of_the_units(tmp_path, header):
    """Diameters in the place of radii, or a radius of one species, would make every force wrong without a word."""
    between = ";" if ";" in header else ","
    rows = [between.join(map(str, row)) for row in ((3.75, 3.7, 7.4), (11.25, 3.8, 7.6))]
    (tmp_path / "disks.csv").write_text("\n".join([header, *rows]) + "\n")
    packing = {"kind": "file", "path": str(tmp_path / "disks.csv"), "width": 15.1}
    for given in (packing, FilePacking(**packing)):
        assert LaboratoryUnits(radius=3.77e-3).reduced_scene({"packing": given}) == {"packing": given}
        with pytest.raises(SceneError) as caught:
            LaboratoryUnits(radius=7.5e-3).reduced_scene({"packing": given})
    assert str(caught.value) == (
        f"radius = 0.0075: must be within 1% of 0.00375, the mean radius of {tmp_path / 'disks.csv'} in m"
    )
    for unit in ("", "_px"):  # of no known size
        (tmp_path / "disks.csv").write_text(f"x{unit},z{unit},radius{unit}\n1,1,1\n")
        assert LaboratoryUnits().reduced_scene({"packing": packing})
