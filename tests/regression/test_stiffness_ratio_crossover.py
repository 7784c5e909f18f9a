"""Figs. 10 and 11 on a slab of 7 layers, from parameters through a file to figures."""

import numpy as np
import pytest
import reduced

#: k_T/k_N at which the pressure right below the force turns from a maximum into a minimum.
TURNS = {"half plane": 0.2727, "smooth floor": 0.285}
PARAMETERS = reduced.parameters("stiffness_ratio_crossover")


def test_two_peaks_turn_into_one(datasets) -> None:
    response, events = datasets["response"], datasets["events"]
    assert response["double_peaked"].values.tolist() == [1, 1, 1, 0, 0, 0]
    assert response["methods"].values.tolist() == ["minimise", *["dynamics"] * 5]
    np.testing.assert_allclose(response["floor_response"].sum("floor_disk"), 1.0, atol=1e-9)
    for low, high in zip(events["low"], events["high"], strict=True):
        assert 0.2 <= float(low) < float(high) <= 0.3
        assert float(high - low) <= PARAMETERS["tolerance"]


def test_elastic_bodies_turn_where_theory_says(datasets) -> None:
    """Sampled at the floor disks the dip of the slab changes its sign near the curvature's own zero."""
    elastic = datasets["elastic"]
    ratio = elastic["stiffness_ratio"].values
    for body, turns in TURNS.items():
        dip = elastic["central_dip"].sel(body=body).values
        turned = ratio[np.flatnonzero(dip < 0.0)[0]]
        assert turned == pytest.approx(turns, abs=0.04)
    assert np.isnan(elastic["profile"].sel(stiffness_ratio=0.0)).all()
    shares = elastic["profile"].sel(body="smooth floor").isel(stiffness_ratio=slice(1, None)).sum("floor_disk")
    np.testing.assert_allclose(shares, 1.0, atol=1e-4)  # disks at rest are not quite 2 apart
