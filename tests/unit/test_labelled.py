"""Datasets as plain arrays, written as xarray writes them."""

import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray as xr

from granular_response.store import files as store
from granular_response.store.labelled import Labelled, Values, labelled

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
    store.write(tmp_path / "file.nc", labelled(dataset()))
    xr.testing.assert_identical(store.read(tmp_path / "file.nc")[""].drop_attrs(), dataset().drop_attrs())
    xr.testing.assert_identical(labelled(dataset()).dataset(), dataset())


def test_values_that_no_file_can_hold():
    parts = Labelled({"when": Values(("t",), np.zeros(2, "datetime64[s]"), LABELS)})
    with pytest.raises(TypeError, match="variable when"):
        parts.encoded_variables()


def test_a_scene_is_solved_and_stored_without_loading_xarray(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text("packing: {kind: slab, layers: 3, disks_per_row: 5}\ncontact: {friction: 0.0}\n")
    code = (
        "import sys\nfrom granular_response.cli.main import commands\n"
        f"commands.app(['run', {str(scene)!r}, '-o', {str(tmp_path / 'result.nc')!r}], standalone_mode=False)\n"
        "print(sorted({'dask', 'pandas', 'xarray'} & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
    assert store.read(tmp_path / "result.nc")[""].sizes["disk"] == 14
