"""Captions: what they say of parameters, and letters that run on through a figure of several pictures."""

from types import SimpleNamespace

import pytest
from refusals import refusals

from granular_response.scene import PilePacking, Scene
from granular_response.store import files as store
from granular_response_paper import captions
from granular_response_paper.captions import Caption, of_scene
from granular_response_paper.pipeline import drawing
from granular_response_paper.registry import GroupError


def test_parameters_end_the_caption_in_the_papers_symbols():
    scene = Scene().updated({"contact.friction": 0.2, "contact.stiffness_ratio": 0.8, "packing.polydispersity": 0.01})
    given = of_scene(scene, force=[4.0, 10.0, 20.0], width=6.0, realizations=15)
    assert Caption("Response.", "A curve.", parameters=given).whole == (
        "Response. F_ext = 4, 10 and 20 m̄g, µ = 0.2, µ_wall = 0, k_T/k_N = 0.8, k_N = 3000 m̄g/R̄, δ = 0.01, "
        "15 realizations, w = 6 R̄, 15 layers of alternately 61 and 60 disks."
    )


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (of_scene(Scene().updated({"contact.friction": 0.5, "wall.friction": 0.5})), "µ = µ_wall = 0.5, k_T/k_N"),
        (of_scene(Scene().updated({"contact.friction": 0.0})), "µ = µ_wall = 0, k_N"),  # without tangential springs
        (of_scene(Scene(), friction=[0.0, 0.5]), "k_T/k_N"),
        (of_scene(Scene(packing=PilePacking(layers=11), loads=())), "pile of 11 layers, 31 disks in the lowest"),
        (of_scene(Scene().updated({"packing.sides": "periodic"})), "15 layers of 61 disks"),
    ],
)
def test_a_scene_is_said_in_the_words_of_its_kind(given, said):
    assert said in Caption("", "", parameters=given).whole


test_what_a_caption_lacks_is_named = refusals(
    ValueError,
    (lambda: Caption("", "", parameters={"frction": 0.2}), "parameters: unknown frction, must be among force"),
    (
        lambda: captions.document({"fig06_one": Caption("a", "b")}, {"fig06_one": [], "other": []}),
        "no caption for other",
    ),
)


@pytest.mark.parametrize(
    ("stem", "number"), [("fig06_one", 6), ("fig24b_two", 24), ("fig25_x", None), ("fig0_x", None), ("pile", None)]
)
def test_the_figure_of_a_picture(stem, number):
    assert captions.number(stem) == number


def test_fields_of_a_template_are_filled_in_and_lists_put_in_words():
    given = {"numerics": {"friction": 0.2}}
    parameters = SimpleNamespace(
        frictions=(0.2, 1.0), force=15.0, friction=0.2, restart=SimpleNamespace(forces=(1.0, 2.0, 15.0))
    )
    said = captions.of_group("numerics", given, p=parameters)["numerics"].whole
    assert "for µ = 0.2 and 1 at 15 m̄g" in said and "under 1, 2 and 15 m̄g that are put back" in said
    assert said.endswith("µ = 0.2. Not in the paper. µ = 0.2.")
    with pytest.raises(KeyError, match="p"):
        captions.of_group("numerics", given)


def test_captions_are_made_from_the_parameters_that_the_file_stores(tmp_path):
    """Other parameters than those that the code has now are refused by name."""
    store.write(tmp_path / "theory.nc", {}, {"group": "theory", "parameters": "stifness_ratio: 0.8"})
    with pytest.raises(GroupError, match=r"was made with parameters that theory does not have now: .*stifness_ratio"):
        drawing.draw("theory", tmp_path / "theory.nc", tmp_path)
