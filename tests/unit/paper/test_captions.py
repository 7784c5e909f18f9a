"""Captions: what they say of parameters, and letters that run on through a figure of several pictures."""

import numpy as np
import pytest
import xarray as xr

from granular_response.scene import Scene
from granular_response.store import files as store
from granular_response_paper import captions
from granular_response_paper.captions import Caption, of_scene
from granular_response_paper.groups.stiffness_ratio_crossover import draw as ratio
from granular_response_paper.groups.symmetry_breaking import draw as symmetry
from granular_response_paper.pipeline import drawing
from granular_response_paper.registry import GroupError, collections


def test_parameters_end_the_caption_in_the_papers_symbols():
    scene = Scene().updated({"contact.friction": 0.2, "contact.stiffness_ratio": 0.8, "packing.polydispersity": 0.01})
    given = of_scene(scene, force=[4.0, 10.0, 20.0], width=6.0, realizations=15)
    assert Caption("Response.", "A curve.", parameters=given).whole == (
        "Response. F_ext = 4, 10 and 20 m̄g, µ = 0.2, µ_wall = 0, k_T/k_N = 0.8, k_N = 3000 m̄g/R̄, δ = 0.01, "
        "15 realizations, w = 6 R̄, 15 layers of alternately 61 and 60 disks."
    )


def test_fields_of_a_template_are_filled_in_and_lists_put_in_words():
    stem = "fig09_contacts_mu1"
    given = {stem: {"friction": 0.5, "force": [5.0, 12.0]}}
    (said,) = captions.of_group("friction_linear_range", given, {stem: "What is found."}).values()
    assert said.whole.startswith("What is found. Contact network")
    assert said.whole.endswith("F_ext = 5 and 12 m̄g, µ = 0.5.")
    assert "at friction 0.5, one for each force" in said.alternative and said.alternative.endswith("What is found.")
    assert said.title == "Contacts under load, large friction"
    with pytest.raises(KeyError, match="least"):
        captions.of_group("symmetry_breaking", {"fig16s_symmetry_breaking": {}})


@pytest.mark.parametrize("group", [name for one in collections() for name in one.groups])
def test_every_picture_has_a_title_of_its_own(group):
    titles = [one["title"] for name, one in captions._templates(group).items() if name != "question"]
    assert len(set(titles)) == len(titles)


def test_a_finding_follows_the_data():
    """With friction 0.2 no force of these runs breaks the symmetry; the caption does not say the paper's finding."""
    runs = xr.Dataset(
        {
            "force": ("run", [80.0, 92.0, 93.0]), "ramp_time": ("run", [20.0] * 3),
            "asymmetry": ("run", [0.0, 0.001, 1.9]),
        }
    )  # fmt: skip
    assert symmetry._finding(runs) == "Symmetry is lost at 92 to 93 m̄g with a ramp of 20 sqrt(R/g)."
    kept = symmetry._finding(runs.assign(asymmetry=0.0 * runs["asymmetry"]))
    assert kept == "Symmetry is kept up to 93 m̄g with a ramp of 20 sqrt(R/g)."
    events = xr.Dataset({"low": ("event", [0.29, 0.3]), "high": ("event", [0.3, 0.31])})
    assert "below k_T/k_N = 0.29 and one above 0.31" in ratio._finding(events)
    assert "two peaks up to k_T/k_N = 0.29." in ratio._finding(events.assign(high=events["high"] * np.nan))


def test_captions_are_made_from_the_parameters_that_the_file_stores(tmp_path):
    """Other parameters than those that the code has now are refused by name."""
    store.write(tmp_path / "theory.nc", {}, {"group": "theory", "parameters": "stifness_ratio: 0.8"})
    with pytest.raises(GroupError, match=r"was made with parameters that theory does not have now: .*stifness_ratio"):
        drawing.draw("theory", tmp_path / "theory.nc", tmp_path)
