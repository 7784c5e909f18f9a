"""The numbers of one group, from its own datasets."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from claims_data import pile_study
from places import ROOT

from granular_response.store import files as store
from granular_response_paper.groups import NAMES
from granular_response_paper.groups.sensitivity.numbers import numbers as sensitivity
from granular_response_paper.groups.stability.numbers import numbers as stability
from granular_response_paper.pipeline import GroupError, measuring


@pytest.mark.parametrize("group", NAMES)
def test_every_group_has_something_to_compare(group):
    assert measuring.contents(group) != (None, None)


def test_claims_are_measured_on_the_group_alone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    store.write("data/pile_dip.nc", pile_study(), {"group": "pile_dip"})
    assert measuring.measure("pile_dip") == Path("figures/metrics/pile_dip.json")
    found = json.loads(Path("figures/metrics/pile_dip.json").read_text())
    assert found["holds"] == "P1 P2 P3" and found["P1 dip per largest value"] == 0.07
    assert len(found) == 4
    store.write("data/pile_dip.nc", {"piles": pile_study()["piles"]}, {"group": "pile_dip"})
    measuring.measure("pile_dip")
    missing = json.loads(Path("figures/metrics/pile_dip.json").read_text())
    assert missing == {
        "holds": "P3",
        "not measured": "P1 P2",
        "P3 size with friction per without": found["P3 size with friction per without"],
    }


@pytest.mark.parametrize("path", sorted(ROOT.glob("figures/metrics/*.json")), ids=lambda p: p.stem)
def test_stored_numbers_are_few_and_have_names_in_words(path):
    """Flat, so that ``dvc metrics show`` has them as they stand; the number of a claim beside its code."""
    found = json.loads(path.read_text())
    assert 0 < len(found) <= 50
    for name, value in found.items():
        assert isinstance(value, (int, float, str)), name
        assert " " in name or isinstance(value, str), name
        assert not re.search("[a-z0-9]_[a-z0-9]", name), name


def test_numbers_of_variants():
    study = xr.Dataset(
        {"variant": ("variant", ["reference", "path"]), "largest_difference": ("variant", np.array([0.0, 0.25]))}
    )
    assert sensitivity({"mu_0.2": study}) == {"path, friction 0.2": 0.25}


def test_numbers_of_stress_tests():
    """A kick without a rest state says nothing about the step; residuals are those of certified scenes."""
    ratio = ("ratio", np.array([0.5, 0.9, 1.1, 2.0]))
    kicks = xr.Dataset({"outcome": (("integrator", "friction", "ratio"), np.array([[[0, 0, 2, 2]], [[3, 0, 0, 1]]]))})
    scenes = xr.Dataset(
        {
            "outcome": ("scene", np.array([0, 1, 0, 6])),
            **{name: ("scene", np.array([1e-12, 1.0, 2e-12, 9.0])) for name in
               ("force_residual", "torque_residual", "coulomb_excess")},
        }
    )  # fmt: skip
    scenes["outcome"].attrs["long_name"] = "what became of the scene: 0 certified, 1 uncertified, 6 wrong"
    found = stability({"time_step_friction": kicks.assign_coords(ratio=ratio), "random_scenes": scenes})
    assert (found["stable step"], found["unstable step"]) == (0.9, 2.0)
    assert (found["scenes certified"], found["scenes uncertified"], found["scenes wrong"]) == (2.0, 1.0, 1.0)
    assert found["max. unbalanced force"] == 2e-12


def test_datasets_of_another_group_are_refused(tmp_path):
    path = tmp_path / "torque.nc"
    store.write(path, pile_study(), {"group": "pile_dip"})
    with pytest.raises(GroupError, match=r"torque\.nc: .*those of pile_dip, must be those of torque"):
        measuring.measure("torque", path, tmp_path / "torque.json")
    assert not (tmp_path / "torque.json").exists()
