"""The theory study and its figures, end to end through a file."""

import numpy as np
import pytest


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
