"""Figs. 10 and 11 on a slab of 7 layers, from parameters through a file to figures."""

import numpy as np
import reduced

PARAMETERS = reduced.parameters("stiffness_ratio_crossover")


def test_two_peaks_turn_into_one(datasets) -> None:
    response, events = datasets["response"], datasets["events"]
    assert response["double_peaked"].values.tolist() == [1, 1, 1, 0, 0, 0]
    assert response["methods"].values.tolist() == ["minimise", *["dynamics"] * 5]
    np.testing.assert_allclose(response["floor_response"].sum("floor_disk"), 1.0, atol=1e-9)
    for low, high in zip(events["low"], events["high"], strict=True):
        assert 0.2 <= float(low) < float(high) <= 0.3
        assert float(high - low) <= PARAMETERS["tolerance"]
