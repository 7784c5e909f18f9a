"""Sweeps and events by the public namespace alone."""

import contextlib
import json
import os
import pickletools
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from commands import LONGEST, python
from places import ROOT
from refusals import refuses

import granular_response as gr
from granular_response.api import sweep as sweeping
from granular_response.scene import SceneError
from granular_response.sweeps.errors import SweepError

SCENE = gr.Scene().updated({"packing.layers": 4, "packing.disks_per_row": 9, "contact.friction": 0.0})
UNEVEN = {"packing.polydispersity": 0.05, "packing.lattice_constant": "touching-largest"}
DISORDERED = SCENE.updated({**UNEVEN, "protocol.integrator": "verlet", "protocol.time_step": "auto"})


def response_at(changes):
    return gr.solve(SCENE.updated(changes)).floor_response.values


def test_a_sweep_is_one_dataset_on_common_axes():
    frictions, layers = [0.0, 0.3], (3, 5)
    found = gr.sweep(
        SCENE,
        {"contact.friction": frictions, "packing.layers": layers},
        lambda result: {"largest": result.floor_response.max(), "disks": len(result.rest.position)},
        workers=2,
        progress=False,
    )
    assert found["largest"].dims == found["disks"].dims == ("friction", "layers")
    assert found["friction"].values.tolist() == frictions and found["layers"].values.tolist() == [3, 5]
    assert found["friction"].attrs["key"] == "contact.friction"
    assert found["disks"].dtype.kind == "i" and "error" not in found
    for friction in frictions:
        for rows in layers:
            expected = response_at({"contact.friction": friction, "packing.layers": rows}).max()
            assert found["largest"].sel(friction=friction, layers=rows) == expected


def test_the_floor_response_is_measured_where_nothing_is_named(tmp_path):
    found = gr.sweep(DISORDERED, {"packing.realization": range(3)}, workers=1, progress=False)
    assert found["floor_response"].dims == ("realization", "load", "floor_disk")
    assert found["x"].dims == ("realization", "floor_disk")  # disks lie elsewhere in each
    assert "x" in found.coords
    one = gr.solve(DISORDERED.updated({"packing.realization": 2})).floor_response
    np.testing.assert_array_equal(found["floor_response"].sel(realization=2), one)
    np.testing.assert_array_equal(found["x"].sel(realization=2), one["x"])
    found.to_netcdf(tmp_path / "sweep.nc")
    assert xr.open_dataset(tmp_path / "sweep.nc").equals(found)


def of_programme(factors, **changes):
    return gr.solve(SCENE.updated(changes), load_factors=factors).floor_response.values


@pytest.mark.parametrize("factors", [[0.5, 1.0], (1.0, 0.5, 1.0)], ids=["growing", "turning"])
def test_a_sweep_with_several_loads_has_them_as_a_dimension(factors, tmp_path):
    frictions = [0.0, 0.3]
    axes = {"contact.friction": frictions}
    found = gr.sweep(SCENE, axes, load_factors=factors, workers=1, progress=False)
    assert found["floor_response"].dims == ("friction", "load", "floor_disk")
    for name in ("load", "load_factor"):
        assert found[name].dims == ("load",) and found[name].values.tolist() == list(factors)
    assert found["step"].values.tolist() == [*range(1, len(factors) + 1)]
    for friction in frictions:
        alone = of_programme(factors, **{"contact.friction": friction})
        np.testing.assert_array_equal(found["floor_response"].sel(friction=friction), alone)
        chosen = {"load_factor": 0.5} if len(factors) == 2 else {"step": 2}  # as in a result of one scene
        place = list(factors).index(0.5)
        np.testing.assert_array_equal(found["floor_response"].sel(friction=friction, **chosen), alone[place])
    whole = gr.sweep(SCENE, axes, lambda r: r.to_dataset(), load_factors=factors, workers=1, progress=False)
    xr.testing.assert_identical(whole["floor_response"].drop_attrs(), found["floor_response"].drop_attrs())
    found.to_netcdf(tmp_path / "sweep.nc")
    assert xr.open_dataset(tmp_path / "sweep.nc").equals(found)


@pytest.mark.parametrize(
    ("measure", "programmes"),
    [
        (lambda r: r.floor_response, [[0.5, 1.0], [0.5, 2.0], [1.0, 0.5]]),
        (lambda r: r.to_dataset(), [[0.5, 1.0], [0.5, 2.0], [1.0, 0.5]]),
        (lambda r: r.floor_response, [[0.5, 1.0], [0.5, 1.0, 0.5], [1.0]]),
    ],
    ids=["one", "all", "of other lengths"],
)
def test_programmes_lie_side_by_side_and_are_filled_up(tmp_path, measure, programmes):
    found = gr.sweep(SCENE, {"protocol.load_factors": programmes}, measure, workers=1, progress=False)
    longest = max(map(len, programmes))
    assert found["floor_response"].sizes == {"load_factors": 3, "load": longest, "floor_disk": 9}
    assert "load_factor" in found.coords and "load" not in found.variables
    assert found["step"].values.tolist() == [*range(1, longest + 1)] and found["step"].dtype.kind == "i"
    for k, factors in enumerate(programmes):
        count = len(factors)
        assert found["load_factor"][k, :count].values.tolist() == factors
        alone = of_programme(factors).reshape(count, -1)
        np.testing.assert_array_equal(found["floor_response"][k, :count], alone)
        assert np.isnan(found["floor_response"][k, count:]).all() and np.isnan(found["load_factor"][k, count:]).all()
    found.to_netcdf(tmp_path / "sweep.nc")
    assert xr.open_dataset(tmp_path / "sweep.nc").equals(found)


def test_values_of_every_kind_are_coordinates():
    loads = [[{"disk": "top-centre", "force": [0.0, -force]}] for force in (0.5, 1.0)]
    axes = {
        "loads": loads,
        "packing.lattice_constant": [2.0, "touching-largest"],
        "contact.normal_stiffness": np.array([150.0]),
        "wall.normal_stiffness": [200.0],
    }
    found = gr.sweep(SCENE, axes, lambda result: result.loaded[-1].load_factor, workers=1, progress=False)
    shape = {"loads": 2, "lattice_constant": 2, "contact_normal_stiffness": 1, "wall_normal_stiffness": 1}
    assert found["measure"].sizes == shape
    assert found["loads"].values.tolist() == [0, 1]
    assert found["lattice_constant"].values.tolist() == ["2.0", "touching-largest"]


def test_a_combination_without_equilibrium_is_missing_and_says_why():
    up = [[{"disk": "top-centre", "force": [0.0, force]}] for force in (-1.0, 30.0)]
    scene = SCENE.updated({"protocol.ramp_time": 1.0})  # a disk is seen to leave once its load has grown

    def measured(result):
        return {"largest": result.floor_response.max(), "settled": True, "name": "x"}

    with pytest.warns(UserWarning, match=r"1 of 2 combinations have no equilibrium, see the variable error; .*lifts"):
        found = gr.sweep(scene, {"loads": up}, measured, workers=1, progress=False)
    assert found["largest"].isnull().values.tolist() == [False, True]
    assert found["settled"].values[0] == 1.0 and np.isnan(found["settled"].values[1])
    assert found["name"].values.tolist() == ["x", ""]
    assert found["error"].values[0] == "" and "lifts disk" in found["error"].values[1]
    with pytest.raises(SweepError, match=r"none of 1 combinations has an equilibrium, the first: .*lifts disk"):
        gr.sweep(scene, {"loads": up[1:]}, workers=1, progress=False)


ONE = {"contact.friction": [0.1]}


@pytest.mark.parametrize(
    ("axes", "measure", "error", "said"),
    [
        ({"contact.frition": [0.1]}, None, SceneError, r"frition.*friction"),
        ({"contact.friction": [0.1, -1]}, None, SceneError, r"contact.friction = -1"),
        ({"contact.friction": []}, None, ValueError, r"contact.friction has no values"),
        ({"contact.friction": [0.1, 0.1]}, None, ValueError, r"contact.friction has 0.1 twice, must have different"),
        ({"contact.friction": 0.1}, None, ValueError, r"^axes: contact.friction = 0.1, must be a list of values$"),
        (ONE, lambda result: 1 / 0, SweepError, r"task 1 of 1 \(.*contact.friction = 0.1.*ZeroDivisionError"),
        (ONE, lambda result: result, SweepError, r"measure is a Result, must be a number"),
    ],
)
def test_mistakes_are_one_line(axes, measure, error, said):
    refuses(error, said, gr.sweep, SCENE, axes, *filter(None, [measure]), workers=1, progress=False)


def test_the_sweep_of_the_notes_runs_as_a_script_with_workers(tmp_path):
    text = (ROOT / "docs" / "many-scenes.md").read_text()
    code = re.search(r"```python\n(.*?)```", text, re.DOTALL)[1]
    smaller = 'gr.Scene().updated({"packing.layers": 4, "packing.disks_per_row": 9})'
    for old, new in {
        "gr.Scene()": smaller,
        "[0, 0.1, 0.2, 0.5]": "[0, 0.2]",
        "[5, 10, 15]": "[2, 3]",
        'checkpoint="kept"': 'checkpoint="kept", workers=2',
        "layers=10": "layers=3",
    }.items():
        assert code.count(old) == 1
        code = code.replace(old, new)
    (tmp_path / "script.py").write_text(code)
    python("-W", "error::UserWarning:__main__", "script.py", folder=tmp_path)
    assert any((tmp_path / "kept").iterdir())


def test_a_sweep_continues_from_its_checkpoint(tmp_path, monkeypatch):
    calls = []

    def count(done, total, what):
        calls.append((done, total, what))

    def largest(result):
        return result.floor_response.max()

    kept = {"workers": 1, "checkpoint": tmp_path / "kept"}
    one = gr.sweep(SCENE, {"contact.friction": [0.0]}, largest, progress=count, **kept)
    two = gr.sweep(SCENE, {"contact.friction": [0.0, 0.1]}, largest, progress=count, **kept)
    counts = [(0, 1, "scenes"), (1, 1, "scenes"), (1, 2, "kept"), (0, 2, "scenes"), (1, 2, "scenes"), (2, 2, "scenes")]
    assert calls == counts
    assert one["floor_response"][0] == two["floor_response"][0]
    monkeypatch.setattr(sweeping, "solve_scene", None)  # another measure takes what was solved
    whole = gr.sweep(SCENE, {"contact.friction": [0.0, 0.1]}, lambda result: result.to_dataset(), **kept)
    np.testing.assert_array_equal(whole["floor_response"].max(["load", "floor_disk"]), two["floor_response"])


def test_what_is_kept_is_what_was_computed_and_reading_it_runs_no_code(tmp_path):
    """To the last bit, the solution itself: another measure may sum over it in its own order."""
    changes = {"loads.0.force": [0.3, -6.0], "contact.friction": 0.4, "packing.realization": 1}
    scene = DISORDERED.updated({**changes, "protocol.load_factors": [0.5, 1.0]})

    whole = {"measure": lambda result: result.to_dataset(), "workers": 1, "checkpoint": tmp_path / "kept"}
    axes = {"packing.layers": [4]}
    first = gr.sweep(scene, axes, progress=False, **whole)
    for path in (tmp_path / "kept").rglob("*.kept"):
        named = {text for _, text, _ in pickletools.genops(path.read_bytes()[:-32]) if isinstance(text, str)}
        assert not any("Problem" in one or "pydantic" in one for one in named)
    again = gr.sweep(scene, axes, progress=False, **whole)
    xr.testing.assert_identical(first, again)


def test_an_event_along_a_key_is_bracketed():
    ends = [response_at({"contact.friction": friction}).max() for friction in (0.0, 1.0)]

    def beyond_the_middle(result):
        return bool((result.floor_response.max() > np.mean(ends)) == (ends[1] > ends[0]))

    calls = []
    bracket = gr.find_event(
        SCENE, beyond_the_middle, 0.0, 1.0, key="contact.friction", tolerance=0.2,
        progress=lambda *call: calls.append(call),
    )  # fmt: skip
    assert bracket.width <= 0.2 and bracket.at_low is False
    assert not beyond_the_middle(gr.solve(SCENE.updated({"contact.friction": bracket.low})))
    assert beyond_the_middle(gr.solve(SCENE.updated({"contact.friction": bracket.high})))
    assert calls == [(done, bracket.evaluations, "event") for done in range(bracket.evaluations + 1)]


def test_an_event_along_the_load_needs_loads():
    calls = []
    with pytest.raises(SceneError, match=r"^loads: none in this scene, must be one or more"):
        gr.find_event(SCENE.updated({"loads": []}), calls.append, 0.1, 1.0, progress=False)
    assert calls == []


def test_what_solve_warns_of_is_said_once():
    with pytest.warns(UserWarning) as said:
        gr.sweep(SCENE, {"preparation.ramp_time": [100.0, 3.0], "packing.layers": [3, 4]}, workers=1, progress=False)
    (line,) = [str(warning.message) for warning in said]
    first = "the first: preparation.ramp_time = 3.0, packing.layers = 3"
    assert line.startswith(f"2 of 4 combinations ({first}): preparation.ramp_time = 3.0 has no effect")


def test_a_warning_of_one_preparation_names_it():
    ways = {"frictionless": {"gravity": "frictionless"}, "at once": {"gravity": "at-once", "ramp_time": 3.0}}
    with pytest.warns(UserWarning) as said:
        gr.preparations(SCENE.updated({"contact.friction": 0.2}), ways, workers=1, progress=False)
    (line,) = [str(warning.message) for warning in said]
    assert line.startswith("1 of 2 combinations (preparation = Preparation(ramp_time=3.0)): preparation.ramp_time")


@pytest.mark.parametrize(
    "axes", [{"protocol.method": ["path", "minimise"]}, {"loads.0.force": [[0.0, -1.0], [0.0, -1e9]]}]
)
def test_a_combination_that_is_no_scene_is_refused_before_anything_is_solved(axes):
    def measure(result):
        raise AssertionError("solved")

    scene = SCENE.updated({"contact.friction": 0.2})
    refuses(SceneError, "must be", gr.sweep, scene, axes, measure, workers=1, progress=False)


def test_floor_disks_that_differ_are_in_order_along_x():
    changes = {"packing.polydispersity": 0.3, "packing.disks_per_row": 6, "contact.friction": 0.2}
    found = gr.sweep(DISORDERED.updated(changes), {"packing.realization": range(2)}, workers=1, progress=False)
    assert "floor_disk" not in found.coords  # other disks in each
    for place, row in enumerate(found["x"].values):
        known = np.isfinite(row)
        assert (np.diff(row[known]) > 0).all() and known[: known.sum()].all()
        one = gr.solve(DISORDERED.updated({**changes, "packing.realization": place})).floor_response
        np.testing.assert_array_equal(found["floor_disk_index"].values[place][known], one["floor_disk"])
        np.testing.assert_array_equal(found["floor_response"].values[place][:, known], one)


def test_packings_of_ones_own_are_told_apart():
    places = {"z": [1.0, 1.0, 1.0, 2.75, 2.75], "radius": [1.0] * 5}
    near, far = (gr.Arrays(x=[1.0, x, 5.0, 2.0, 4.0], **places) for x in (3.0, 3.1))
    assert gr.sweep(gr.Scene(), {"packing": [near, far]}, workers=1, progress=False).sizes["packing"] == 2
    with pytest.raises(ValueError, match=r"packing has .* twice"):
        gr.sweep(gr.Scene(), {"packing": [near, near.model_copy()]}, workers=1)


def peak(result):
    return result.floor_response.max()


def test_a_sweep_says_what_it_was_made_from(tmp_path):
    axes = {"packing.realization": range(2), "preparation": [{"gravity": "at-once"}, gr.Preparation(gravity="slow")]}
    found = gr.sweep(DISORDERED, axes, peak, load_factors=[0.5, 1.0], workers=1, progress=False)
    found.to_netcdf(tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as stored:
        told = stored.attrs
    assert told == found.attrs
    assert gr.Scene.from_text(told["scene"]) == DISORDERED.updated({"protocol.load_factors": [0.5, 1.0]})
    assert json.loads(told["axes"])["packing.realization"] == [0, 1]
    assert json.loads(told["axes"])["preparation"][1]["gravity"] == "slow"
    assert json.loads(told["load_factors"]) == [0.5, 1.0]
    assert told["measure"] == f"{__name__}.peak" and told["package_version"] == gr.__version__
    assert json.loads(told["versions"]).keys() == {"python", "numba", "numpy", "scipy", "xarray"}
    ways = {"one": {}, "other": {"gravity": "frictionless"}}
    of_ways = gr.preparations(SCENE, ways, workers=1, progress=False).attrs
    assert of_ways["measure"] == "granular_response.api.sweep.floor_response"
    assert json.loads(of_ways["axes"])["preparation"][1]["gravity"] == "frictionless"


CLUSTER = ROOT / "examples" / "cluster"
#: What takes the place of SLURM: jobs run at once, each part of an array, and write the file that a job would.
SBATCH = """\
#!/bin/bash
set -e
for script; do :; done
tasks=$(sed -n 's/^#SBATCH --array=0-//p' "$script")
export SLURM_CPUS_PER_TASK=$(sed -n 's/^#SBATCH --cpus-per-task=//p' "$script")
export SLURM_JOB_ID=$((1 + $(ls slurm-*.out 2>/dev/null | wc -l)))
for k in $(seq 0 "${tasks:-0}"); do
    [ -z "$tasks" ] || export SLURM_ARRAY_TASK_ID=$k SLURM_ARRAY_TASK_COUNT=$((tasks + 1))
    bash "$script" > "slurm-${SLURM_JOB_ID}_$k.out" 2>&1
done
echo "$SLURM_JOB_ID"
"""
#: Takes over no number of cores, so that it must be told.
SRUN = """\
#!/bin/bash
if [ -n "$SLURM_CPUS_PER_TASK" ]; then [ "$1" = "--cpus-per-task=$SLURM_CPUS_PER_TASK" ] && shift || exit 1; fi
exec "$@"
"""


def test_the_scripts_for_a_cluster_run_as_they_stand(tmp_path):
    """Those of the page, in their order, with a smaller sweep and fewer parts."""
    for path in CLUSTER.iterdir():
        text = path.read_text()
        smaller = {'layers": 10': 'layers": 3', 'row": 41': 'row": 7', "range(200)": "range(4)", "0-9": "0-1"}
        for old, new in smaller.items():
            text = text.replace(old, new)
        (tmp_path / path.name).write_text(text)
    programs = tmp_path / "bin"
    programs.mkdir()
    for name, text in {"sbatch": SBATCH, "srun": SRUN}.items():
        (programs / name).write_text(text)
        (programs / name).chmod(0o755)
    page = (ROOT / "docs" / "many-scenes.md").read_text()
    commands = [line.strip() for line in page.splitlines() if "sbatch" in line and line.startswith("    ")]
    scripts = [re.search(r"(\w+)\.sh", line)[1] for line in commands]
    assert scripts == ["node", "array", "node", "mpi", "dask"]
    path = os.pathsep.join([str(programs), str(Path(sys.executable).parent), os.environ["PATH"]])

    def run(*lines):
        with contextlib.suppress(FileNotFoundError):
            (tmp_path / "sweep.nc").unlink()
        options = {"cwd": tmp_path, "env": {**os.environ, "PATH": path}, "capture_output": True, "text": True}
        done = subprocess.run(["bash", "-ec", "\n".join(lines)], **options)
        logs = "".join(one.read_text() for one in sorted(tmp_path.glob("slurm-*.out")))
        assert done.returncode == 0, done.stderr + logs
        with xr.open_dataset(tmp_path / "sweep.nc") as found:
            return found.load(), logs

    alone, logs = run(commands[0])
    assert alone["response_below"].sizes == {"friction": 2, "realization": 4} and "kept" not in logs
    shutil.rmtree(tmp_path / "kept")
    whole, logs = run(*commands[1:3])
    assert [line for line in logs.splitlines() if line.endswith("kept")] == ["8 of 8 kept"]
    xr.testing.assert_identical(whole, alone)
    pytest.importorskip("distributed")
    shutil.rmtree(tmp_path / "kept")
    of_dask, _ = run(commands[4])
    xr.testing.assert_identical(of_dask, alone)
    (programs / "dask").write_text("#!/bin/bash\nexit 3\n")
    (programs / "dask").chmod(0o755)
    given = {"cwd": tmp_path, "env": {**os.environ, "PATH": path, "SLURM_JOB_ID": "9"}}
    failed = subprocess.run(["bash", "dask.sh"], capture_output=True, timeout=LONGEST, **given)
    assert failed.returncode == 3  # no wait for a scheduler that is not there
