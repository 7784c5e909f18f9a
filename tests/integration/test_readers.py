"""Every kind of stored file is read by other programs."""

import numpy as np
import pytest
import xarray as xr
from places import ROOT
from small_scenes import scene

import granular_response as gr
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.result import to_dataset

LABEL = {"long_name": "a quantity", "units": "1"}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Paths of files, each with one of its groups: results, studies, an ensemble, and what xarray writes of ours."""
    folder = tmp_path_factory.mktemp("readers")
    loaded = scene(contact__friction=0.3, loads=[{"disk": "top-centre", "force": [0.5, -3.0]}])
    result = to_dataset(solve_scene(loaded, load_factors=(0.5, 2.0, 0.0)))
    assert result["event_reason"].size  # texts of any length, also none
    store.write(folder / "result.nc", result.assign_attrs(scene=f"{result.attrs['scene']}# Körner\n"))
    store.write(folder / "unloaded.nc", to_dataset(solve_scene(scene(loads=[]))))
    texts = xr.Dataset(
        {
            "message": (("case", "seed"), np.array([["", "größer als 2 µ"], ["", "x" * 300]]), LABEL),
            "why": ((), "no equilibrium", LABEL),
            "none": ("nowhere", np.array([], str), LABEL),
            "empty": ("seed", np.array(["", ""], object), LABEL),
        },
        {"case": ("case", ["smooth", "π"], LABEL), "name": ("case", ["a", "bb"], LABEL)},
    )
    store.write(folder / "study.nc", {"packings": texts, "slab/rest": result})
    assert store.read(folder / "study.nc")["packings"].identical(texts.drop_attrs(deep=False))
    made = {folder / "result.nc": "", folder / "unloaded.nc": "", folder / "study.nc": "packings"}
    made |= {ROOT / "data" / "survey" / "moduli.nc": next(iter(store.read(ROOT / "data" / "survey" / "moduli.nc")))}
    result.to_netcdf(folder / "by_xarray.nc")
    axes = {"protocol.integrator": ["beeman", "verlet"], "protocol.load_factors": [[1.0], [1.0, 2.0]]}
    gr.sweep(loaded, axes, workers=1, progress=False).to_netcdf(folder / "sweep.nc")
    return made | {folder / "by_xarray.nc": "", folder / "sweep.nc": ""}


def test_files_are_read_alike_by_either_library(files):
    for path, group in files.items():
        read = [
            xr.open_dataset(path, group=group or None, engine=engine, decode_timedelta=False).load()
            for engine in ("netcdf4", "h5netcdf")
        ]
        assert read[0].variables and read[0].identical(read[1]), path


def test_no_variable_holds_strings_of_any_length(files):
    """Nor do files of the reproduction: all are written by the one function that these were."""
    import netCDF4

    def variables(group):
        yield from group.variables.values()
        for inner in group.groups.values():
            yield from variables(inner)

    for path in (*files, *(ROOT / "data" / "survey").glob("*.nc")):
        with netCDF4.Dataset(path) as file:
            assert not [one.name for one in variables(file) if one.dtype is str], path


def test_plain_xarray_sees_words_along_dimensions_and_bytes_elsewhere(files):
    with xr.open_dataset(next(iter(files))) as plain:
        assert plain["position"].sel(axis="z").dims == ("state", "disk")
        assert plain["component"].values.tolist() == ["force_x", "force_z", "torque"]
        assert plain["branch"].values.tolist() == [b"loading", b"loading", b"unloading"]
        assert plain["branch"].astype(str).values.tolist() == ["loading", "loading", "unloading"]
