"""Datasets are written as xarray writes them."""

import netCDF4
import numpy as np
import pytest
import xarray as xr

from granular_response.store import files as store
from granular_response.store.conventions import encoded_variables

LABELS = {"long_name": "a quantity", "units": "1"}


def dataset() -> xr.Dataset:
    """One variable of each kind, with coordinates along some, along none and along a dimension."""
    rng = np.random.default_rng(0)

    def made(dimensions, values):
        return xr.Variable(dimensions, values, LABELS)

    return xr.Dataset(
        {
            "real": made(("row", "column"), rng.normal(size=(3, 4))),
            "short": made(("row",), np.array([1.5, np.nan, 2.0], np.float32)),
            "whole": made(("column",), np.arange(4)),
            "small": made(("row",), np.array([0, 1, 2], np.int8)),
            "truth": made(("row",), np.array([True, False, True])),
            "words": made(("row",), np.array(["a", "bc", "def"])),
            "scalar": made((), 2.5),
            "empty": made(("none",), np.zeros(0)),
        },
        coords={
            "row": made(("row",), np.array([0.5, 1.5, 2.5])),
            "name": made(("row",), np.array(["p", "q", "r"], object)),
            "height": made(("column",), np.linspace(0.0, 1.0, 4)),
            "apart": made(("other",), np.arange(2.0)),
        },
        attrs={"title": "all kinds", "number": 3, "list": ["one", "two"]},
    )


def test_the_same_variables_and_attributes_as_xarray_writes(tmp_path):
    store.write(tmp_path / "ours.nc", dataset())
    dataset().to_netcdf(tmp_path / "theirs.nc", engine="netcdf4")
    with netCDF4.Dataset(tmp_path / "ours.nc") as ours, netCDF4.Dataset(tmp_path / "theirs.nc") as theirs:
        assert set(ours.variables) == set(theirs.variables)
        assert {d: len(size) for d, size in ours.dimensions.items()} == {
            d: len(size) for d, size in theirs.dimensions.items()
        }
        ours.set_auto_mask(False)
        theirs.set_auto_mask(False)
        for name, variable in theirs.variables.items():
            found = ours[name]
            assert (found.dimensions, found.dtype) == (variable.dimensions, variable.dtype)
            assert set(found.ncattrs()) == set(variable.ncattrs())
            for attribute in variable.ncattrs():
                assert np.array_equal(found.getncattr(attribute), variable.getncattr(attribute)) or (
                    attribute == "_FillValue" and np.isnan(found.getncattr(attribute))
                )
            numbers = found.dtype is not str and variable.dtype.kind == "f"
            assert np.array_equal(found[...], variable[...], equal_nan=numbers)
        wanted = {name: theirs.getncattr(name) for name in theirs.ncattrs()}
        assert {name: ours.getncattr(name) for name in wanted} == wanted


def test_there_and_back(tmp_path):
    store.write(tmp_path / "file.nc", dataset())
    xr.testing.assert_identical(store.read(tmp_path / "file.nc")[""].drop_attrs(), dataset().drop_attrs())


def test_values_that_no_file_can_hold():
    with pytest.raises(TypeError, match="variable when"):
        encoded_variables(xr.Dataset({"when": ("t", np.zeros(2, "datetime64[s]"), LABELS)}))
