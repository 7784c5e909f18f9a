"""Arrays of all kinds come in by one door: as their numbers, or refused where numbers or an order are missing."""

from array import array

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from refusals import refuses

import granular_response as gr
from granular_response.api.result import _places
from granular_response.api.sweep import _values, as_dataset
from granular_response.scene.given import plain
from granular_response.solvers.solution import load_programme

NUMBERS = [1.0, 3.0]
#: Kinds of arrays that hold NUMBERS.
ARRAYS = {
    "list": NUMBERS, "tuple": tuple(NUMBERS), "range": range(1, 4, 2), "array": array("d", NUMBERS),
    "memoryview": memoryview(array("d", NUMBERS)), "DataArray": xr.DataArray(NUMBERS), "Series": pd.Series(NUMBERS),
    "Index": pd.Index(NUMBERS), "nullable": pd.array(NUMBERS, "Float64"), "object": np.array(NUMBERS, object),
    "scalars": [np.longdouble(1), np.float16(3)], "no mask": np.ma.array(NUMBERS),
    **{kind: np.array(NUMBERS, kind) for kind in ("f2", "f4", "f8", "longdouble", "i1", "u2", "i8")},
}  # fmt: skip
#: Kinds of which a value, the second, is not known.
MISSING = {
    "masked": np.ma.masked_equal(NUMBERS, 3.0), "masked longdouble": np.ma.masked_equal(np.longdouble(NUMBERS), 3),
    "masked int": np.ma.masked_equal([1, 3], 3), "constant": [1.0, np.ma.masked], "none": [1.0, None],
    "nan": np.array([1.0, np.nan]), "NA": pd.array([1.0, None], "Float64"), "NA int": pd.array([1, None], "Int64"),
    "Series": pd.Series([1, None], dtype="Int64"), "DataArray": xr.DataArray([1.0, np.nan]),
}  # fmt: skip
NAMED = dict.fromkeys(NUMBERS)
UNORDERED = {"set": {*NUMBERS}, "frozenset": frozenset(NUMBERS), "keys": NAMED.keys(), "dict": NAMED}
BOX = {"radius": 1.0, "width": 8.0, "scene": {"loads": []}}


def programme(values):
    return gr.Scene.from_dict({"protocol": {"load_factors": values}}).protocol.load_factors


def force(values):
    return gr.Scene.from_dict({"loads": [{"disk": "top-centre", "force": values}]}).loads[0].force


def reduced(values):
    return gr.LaboratoryUnits().reduced_scene({"loads": [{"disk": 0, "force": values}]})["loads"][0]["force"]


ENTRIES = {
    "x": lambda values: gr.Scene.from_arrays(x=values, z=[1, 1], **BOX).packing.x,
    "mass": lambda values: gr.Scene.from_arrays(x=[2, 6], z=[1, 1], mass=values, **BOX).packing.mass,
    "load_factors": programme, "continued": load_programme, "axis": lambda values: _values({"a.b": values})["a.b"],
    "force": force, "places": lambda values: _places("x", values).tolist(),
}  # fmt: skip


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("kind", ARRAYS)
def test_arrays_of_any_kind_are_their_numbers(entry, kind):
    found = ENTRIES[entry](ARRAYS[kind])
    assert list(found) == NUMBERS and all(type(one) in (int, float) for one in found)


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("kind", MISSING)
def test_what_is_missing_is_no_number(entry, kind):
    if entry == "axis":
        known = plain(MISSING[kind])[1]  # null is a value of some keys
        assert known is None if kind == "none" else pd.isna(known)
        return
    refuses(ValueError, None, ENTRIES[entry], MISSING[kind])


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("kind", UNORDERED)
def test_what_has_no_order_is_no_list(entry, kind):
    refuses(ValueError, r"must be|no item", ENTRIES[entry], UNORDERED[kind])


@pytest.mark.parametrize("key", ["wall.normal_stiffness", "protocol.time_step", "contact.friction"])
@pytest.mark.parametrize("missing", [np.ma.masked, np.ma.masked_equal(3.0, 3.0), np.ma.masked_equal([3], 3)[0]])
def test_what_is_missing_is_not_what_is_left_open(key, missing):
    """A mask was null, and so the default of keys that may be null."""
    part, _, name = key.partition(".")
    refuses(gr.SceneError, rf"^{key} = nan: must be", gr.Scene.from_dict, {part: {name: missing}, "loads": []})
    with pytest.raises(gr.SceneError, match=r"^packing\.width = nan: must be a number greater than 0"):
        gr.Scene.from_arrays(x=[1, 3], z=[1, 1], radius=1.0, width=missing)


def test_tasks_have_an_order():
    """Results are in that of the items: those of a set came in the order of its hashes."""
    for items in ({-1, 2}, frozenset((-1, 2))):
        refuses(gr.SweepError, r"^items = .*: must be a list, a set has no order", gr.map_tasks, abs, items, workers=1)
    assert gr.map_tasks(abs, {-1: None, 2: None}.keys(), workers=1) == [1, 2]


def test_arrays_in_laboratory_units_are_reduced():
    expected = reduced([0.0, -0.05])
    assert expected[1] < -10
    for values in (np.array([0.0, -0.05]), xr.DataArray([0.0, -0.05]), np.array([0.0, -0.05], np.longdouble)):
        assert reduced(values) == expected


def test_what_a_measure_misses_is_nan():
    measured = as_dataset({"a": np.ma.masked_equal([1, 3], 3), "b": np.ma.masked_equal([1.0, 3.0], 1.0)})
    np.testing.assert_array_equal(measured["a"], [1.0, np.nan])
    np.testing.assert_array_equal(measured["b"], [np.nan, 3.0])
