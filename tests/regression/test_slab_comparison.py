"""Small forces on small slabs beside the elastic slab, from parameters through a file to the figure."""

import numpy as np
import pytest
import reduced

from granular_response.plot import style
from granular_response_paper.groups.slab_comparison import draw as figures
from granular_response_paper.groups.slab_comparison import simulate as study


def case(friction, floor, layers, gravity="at-once"):
    return {"friction": friction, "floor": floor, "gravity": gravity, "disks_per_layer": 6, "layers": layers}


PARAMETERS = reduced.parameters("slab_comparison")


def test_distances(datasets, num_regression) -> None:
    slabs = datasets["slabs"]
    num_regression.check(
        {name: slabs[name].values for name in ("distance", "distance_other_floor", "open_at_rest")},
        default_tolerance={"rtol": 1e-4, "atol": 1e-9},
    )


def test_deeper_slabs_are_nearer_to_the_elastic_one(datasets) -> None:
    slabs = datasets["slabs"]
    distance = slabs["distance"].values
    for first, last in ((0, 2), (3, 4), (5, 6)):
        assert distance[last] < 0.5 * distance[first] < 0.03
    # the right floor is told from the wrong one
    assert (distance < 0.4 * slabs["distance_other_floor"].values).all()


def test_the_force_is_small(datasets) -> None:
    slabs = datasets["slabs"]
    assert float(slabs["nonlinearity"].max()) < 1e-5
    assert not slabs["opened"].any() and not slabs["sliding"].any()
    assert float(slabs["certificate_force_residual"].max()) < 1e-10
    smooth = slabs["floor"].values == "smooth"
    np.testing.assert_allclose(slabs["response_sum"].values[smooth], 1.0, atol=1e-8)


def test_profiles_are_padded_to_the_longest_row(datasets) -> None:
    slabs = datasets["slabs"]
    disks = np.isfinite(slabs["x"].values).sum(axis=1)
    assert disks.tolist() == [24, 48, 96, 24, 43, 24, 43]
    for k, count in enumerate(disks):
        x = slabs["x"].values[k, :count]
        np.testing.assert_allclose(x, -x[::-1], atol=1e-12)
        np.testing.assert_allclose(slabs["elastic"].values[k, :count].sum(), 1.0, atol=2e-3)


def test_figure(datasets) -> None:
    drawn = figures.draw(datasets)
    assert list(drawn) == ["fig01b_slab_comparison"]
    profiles, distances = drawn["fig01b_slab_comparison"].axes
    np.testing.assert_array_equal(distances.lines[0].get_ydata(), datasets["slabs"]["distance"].values[:3])
    assert [text.get_text() for text in profiles.get_legend().get_texts()][2] == "elastic slab, smooth"
    assert style.render(drawn["fig01b_slab_comparison"])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"force": 0.0}, r"force = 0\.0: must be a number greater than 0"),
        ({"cases": []}, r"cases = \[\]"),
        ({"cases": [{"friction": 0.2}]}, r"cases\[0\]\.floor: missing"),
        ({"cases": [case(0.0, "rough", [4])]}, "floor = 'rough': must be smooth, or rough with friction above 0"),
        ({"cases": [case(0.2, "smooth", [4], "never")]}, "gravity = 'never': must be at-once or slow"),
        ({"cases": [case(0.2, "smooth", [4.5])]}, r"cases\[0\]\.layers\[0\] = 4\.5"),
        ({"cases": [{**case(0.2, "smooth", [4]), "disks_per_layer": 1}]}, "disks_per_layer = 1"),
    ],
)
def test_bad_parameter_is_named(change, message) -> None:
    with pytest.raises(ValueError, match=message):
        study.Parameters(**{**PARAMETERS, **change})
