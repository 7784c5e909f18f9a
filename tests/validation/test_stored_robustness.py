"""The stored study of what moves the events of ordered slabs: entries simulated again, the control of the loss of
symmetry without sliding, and the width of the slab.
"""

import numpy as np
import pytest
from places import ROOT

from granular_response.store import files as store
from granular_response_paper.survey import robustness

#: Of a force, the largest part by which another machine may move an event.
SAME = 0.02


@pytest.fixture(scope="module")
def stored():
    return store.read(ROOT / robustness.OUTPUT)


def bracket(stored, name, variant, friction):
    events = stored["events"]
    there = (
        (events["name"].values == name)
        & (events["variant"].values == variant)
        & (events["friction"].values == friction)
    )
    return events["low"].values[there].item(), events["high"].values[there].item()


@pytest.mark.parametrize("name", ["dashpots doubled", "displaced copy 2"])
def test_an_entry_is_found_again(stored, name):
    variant = next(one for one in robustness.variants() if one.name == name)
    for event in robustness.along_path(0.2, variant):
        low, high = bracket(stored, event.name, name, 0.2)
        assert event.low == pytest.approx(low, rel=SAME) and np.isnan(event.high) == np.isnan(high)


def test_every_variant_that_decides_is_stored(stored):
    """The protocols, at each friction of Fig. 6 that a claim compares."""
    asked = {one.name for one in robustness.variants() if one.kind == "protocol"}
    events = stored["events"]
    for mu in (0.05, 0.1, 0.2, 1.0):
        assert asked <= set(events["variant"].values[events["friction"].values == mu].tolist()), mu


def test_without_sliding_the_response_stays_symmetric(stored):
    """More contacts open at friction 10 than at 1; that nothing slides keeps the symmetry."""
    again = robustness.copy_under(10.0, 95.0, 1, robustness.KICK)
    assert float(again["asymmetry"][0]) < 0.05 and float(again["sliding_contacts"][0]) == 0.0
    control = stored["control"]
    without, at_one = (control["friction"].values == mu for mu in (10.0, 1.0))
    assert control["asymmetry"].values[without].max() < 0.02 and control["asymmetry"].values[at_one].min() > 0.5
    opened = control["opened_contacts"].values
    assert opened[without].min() > opened[at_one].max()
