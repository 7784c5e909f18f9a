"""Disks that a user gives: how far they move from there, and measured ones, whose overlaps are taken out first."""

import re
import warnings

import numpy as np
import pytest
from places import ROOT

import granular_response as gr
from granular_response.scene import Scene, SceneError
from granular_response.solvers.close_pairs import close_pairs
from granular_response.solvers.overlaps import OPTIONS, without_overlaps
from granular_response.solvers.problem import Problem
from granular_response.store.summary import summarise

#: Centres and radii in mm, with a noise of 0.1 mm on the centres: 0.03 mean radii.
MEASURED = {
    "kind": "file", "path": str(ROOT / "tests" / "data" / "packings" / "measured.csv"), "width": 114.75,
    "origin": [25.3, 11.2],
}  # fmt: skip
STIFF = {"contact": {"friction": 0.6, "normal_stiffness": 30000}, "loads": []}


def solved(**packing):
    """The result, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = gr.solve({"packing": {**MEASURED, **packing}, **STIFF}, progress=False)
    return result, [str(one.message) for one in caught]


def moved(result):
    return result.to_dataset()["distance_from_given"].values


def test_measured_disks_that_are_thrown_about_say_so(tmp_path):
    result, said = solved()
    far = moved(result)[0]
    given = Scene.from_dict({"packing": MEASURED, **STIFF}).packing.build().position
    np.testing.assert_allclose(far, np.hypot(*(result.rest.position - given).T), atol=1e-12)
    assert far.max() > 1.0
    (line,) = said
    assert line.startswith(f"disk {far.argmax()} comes to rest {far.max():.2g} mean radii from where it was given")
    assert re.search(r"; disks \d+ and \d+ overlap by 0\.1\d+ mean radii at the start, which packing\.overlaps: ", line)
    shown = f"moved from the given places: median {np.median(far):.2g}, largest {far.max():.2g} mean radii"
    assert shown in repr(result) and shown.split(": ")[1] in result._repr_html_()
    result.save(tmp_path / "a.nc")
    opened = gr.open_result(tmp_path / "a.nc")
    assert repr(opened) == repr(result)
    assert "from where they were given" in "\n".join(map(str, summarise(tmp_path / "a.nc")))


@pytest.mark.parametrize(
    ("x", "z", "named"),
    [
        (0.5, 1.0, "disk 1 and the left wall overlap by 0.5 mean radii"),
        (3.0, 0.5, "disk 1 and the floor overlap by 0.5 mean radii"),
        (3.4, 1.0, "disks 0 and 1 overlap by 0.4 mean radii"),
    ],
)
def test_an_overlap_that_shoots_disks_away_is_named(x, z, named):
    """The deepest of all, in the warning of an equilibrium elsewhere and where none is found."""
    described = {"loads": [], "contact": {"friction": 0.3}, "wall": {"friction": 0.3}}
    pressed = gr.Scene.from_arrays([5.0, x, 6.995], [1.0, z, 1.0], 1.0, width=12.0, scene=described)
    with pytest.warns(UserWarning, match=rf"; {named} at the start, which packing\.overlaps: removed takes out"):
        gr.solve(pressed.updated({"contact.normal_stiffness": 3e4}), progress=False)
    with pytest.raises(gr.SolveError, match=rf"did not come to rest under gravity.*; {named} at the start"):
        gr.solve(pressed.updated({"protocol.maximum_steps": 200}), progress=False)
    stiff = {"contact.normal_stiffness": 1e6, "contact.law": "hertz"}
    with pytest.raises(gr.SolveError, match=rf"^the motion blew up after .*; {named} at the start"):
        gr.solve(pressed.updated(stiff), progress=False)


def test_without_their_overlaps_they_stay_where_they_were_measured():
    """Nearly: the noise was 0.03 in each direction, and 189 of some 300 contacts overlapped."""
    result, said = solved(overlaps="removed")
    far = moved(result)[0]
    assert said == [] and result.certificate.stable
    assert np.median(far) < 0.08 and far.max() < 0.25


def test_what_overlaps_is_pushed_apart_and_nothing_else_moves():
    given = Scene.from_dict({"packing": MEASURED, **STIFF}).packing.build()
    apart = without_overlaps(given)
    radius = given.radius
    assert close_pairs(given.position, radius, -0.1)[0].size > 0
    assert close_pairs(apart.position, radius, -1.01 * OPTIONS.left)[0].size == 0
    for wall in given.box.walls:
        assert given.box.wall_gap(apart.position, radius, np.array(wall)).min() >= -OPTIONS.left
    assert np.array_equal(apart.given, given.position) and apart.moved(apart.position).max() < 0.25
    loose = Scene.from_arrays(x=[1, 2.9, 8, 11], z=[1, 1, 5, 5], radius=1.0, width=14).packing.build()
    expected = [[1.0, 1.0], [3.0, 1.0], [8, 5], [11, 5]]
    np.testing.assert_allclose(without_overlaps(loose).position, expected, atol=6e-3)
    assert np.array_equal(without_overlaps(loose).position[2:], loose.position[2:])
    ring = Scene.from_arrays(x=[0.5, 9.6], z=[1, 1], radius=1.0, width=10, sides="periodic").packing.build()
    one, other = without_overlaps(ring).position[:, 0]
    assert one - other == pytest.approx(-8.0, abs=1e-3)


def test_the_key_is_written_where_it_is_not_the_default_and_has_no_other_values():
    scene = Scene.from_arrays(x=[1, 3], z=[1, 1], radius=1.0, scene={"loads": []})
    assert "overlaps" not in scene.to_yaml() and Scene.from_text(scene.to_yaml()) == scene
    gentle = scene.updated({"packing.overlaps": "removed"})
    assert Scene.from_text(gentle.to_yaml()) == gentle != scene and "overlaps: removed" in gentle.to_yaml()
    assert Scene.from_arrays(x=[1, 3], z=[1, 1], radius=1.0, overlaps="removed", scene={"loads": []}) == gentle
    with pytest.raises(SceneError, match=r"^packing\.overlaps = 'gone': must be kept or removed$"):
        scene.updated({"packing.overlaps": "gone"})
    with pytest.raises(SceneError, match=r"^packing\.overlaps = 'removed': unknown key"):
        Scene.from_dict({"packing": {"kind": "poured", "overlaps": "removed"}})


def test_deep_overlaps_are_refused_or_taken_out():
    deep = {"x": [1, 3, 2], "z": [1, 1, 1.4], "radius": 1.0, "width": 6.0, "scene": {"loads": []}}
    with pytest.raises(SceneError, match=r"half the smaller radius; .* packing\.overlaps: removed takes"):
        Problem.from_scene(Scene.from_arrays(**deep))
    assert Problem.from_scene(Scene.from_arrays(**deep, overlaps="removed")).packing.moved is not None
    with pytest.raises(SceneError, match=r"must be at most 1, the smaller radius; are radii diameters"):
        Problem.from_scene(Scene.from_arrays(**{**deep, "x": [1, 3, 1.3], "z": [1, 1, 1.1]}, overlaps="removed"))
