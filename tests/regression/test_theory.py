"""The theory study and its figures, end to end through a file."""

import numpy as np
import pytest

from granular_response_paper.groups.stiffness_ratio_crossover import spring_model
from granular_response_paper.groups.theory import draw as figures


def test_predictions_are_symmetric_and_carry_the_force(datasets) -> None:
    data = datasets["predictions"]
    step = float(data["x"][1] - data["x"][0])
    for name, missing in (("slab_rough", 0.01), ("slab_smooth", 0.02), ("half_plane", 0.02), ("rays", 1e-6)):
        pressure = data[name].values
        np.testing.assert_allclose(pressure, pressure[..., ::-1], rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(pressure.sum(axis=-1) * step, 1.0, atol=missing)
    assert float(data["x"][60]) == 0.0
    assert int(data["slab_rough"].argmax("x")) == 60
    assert float(abs(data["x"][int(data["rays"][1].argmax("x"))])) == pytest.approx(np.tan(np.pi / 6), abs=step)


def test_claims_can_be_read_off(datasets) -> None:
    criterion = datasets["peak_criterion"]
    root = criterion["root"].sel(rotations="suppressed")
    assert round(float(root), 4) == 0.2915
    np.testing.assert_allclose(criterion["root"], criterion["root_closed_form"], atol=1e-14)
    r = criterion["criterion"].sel(rotations="suppressed")
    assert float(r.interp(beta=root)) == pytest.approx(0.0, abs=1e-4)
    assert float(datasets["moduli"]["error"].max()) < 1e-13


def test_figures(datasets) -> None:
    drawn = figures.draw(datasets)
    assert list(drawn) == ["fig01_predictions"]
    elliptic, hyperbolic, *_ = drawn["fig01_predictions"].axes
    np.testing.assert_array_equal(elliptic.lines[0].get_ydata(), datasets["predictions"]["slab_rough"])
    assert len(hyperbolic.get_legend().get_texts()) == 2
    springs = spring_model.draw_spring_model()["fig11_spring_model"]
    labels = sorted(text.get_text() for text in springs.axes[0].texts)
    assert labels == ["$k_1^n$", "$k_1^t$", "$k_2^n$", "$k_2^n$", "$k_2^t$", "$k_2^t$"]
