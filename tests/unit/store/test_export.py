"""Exports, read back by other means than they were written with."""

import base64
import re
import struct
import sys
from pathlib import Path
from xml.etree import ElementTree

import gsd.fl
import numpy as np
import pytest
from places import ROOT
from refusals import refuses

import granular_response as gr
from granular_response.scene import FilePacking, Scene, SceneError
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.checked import read_result
from granular_response.store.export import SUFFIXES, ExportError, contact_force_sums, export
from granular_response.store.result import ResultError, scene_of, state_from, to_dataset

pytestmark = pytest.mark.filterwarnings("ignore:.*no springs of friction")

FORCE = (0.5, -1.0)
SCENE = {
    "packing": {"kind": "slab", "layers": 3, "disks_per_row": 7},
    "contact": {"friction": 0.4},
    "loads": [{"disk": "top-centre", "force": list(FORCE)}],
}


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("export") / "result.nc"
    store.write(path, to_dataset(solve_scene(Scene.from_dict(SCENE))))
    return path


@pytest.fixture(scope="module")
def data(result):
    return store.read(result)[""]


def read_gsd(path: Path) -> dict[int, dict[str, np.ndarray]]:
    """Frames of a GSD file, each with its chunks."""
    with gsd.fl.open(str(path), "r") as file:
        names = file.find_matching_chunk_names("")
        return {
            k: {name: file.read_chunk(frame=k, name=name) for name in names if file.chunk_exists(frame=k, name=name)}
            for k in range(file.nframes)
        }


def test_gsd(result, data, tmp_path):
    frames = read_gsd(export(result, tmp_path / "result.gsd"))
    assert sorted(frames) == [0, 1]
    for index, state in enumerate(data["position"].values):
        frame = {**frames[0], **frames[index]}  # what does not change is stored once
        np.testing.assert_allclose(frame["particles/diameter"], 2.0 * data["radius"], rtol=1e-6)
        position = frame["particles/position"]
        np.testing.assert_allclose(position, np.column_stack([state, 0.0 * state[:, 0]]), atol=1e-5)
        half = 0.5 * frame["configuration/box"].ravel()[:2]
        assert (np.abs(position[:, :2]) <= half).all()  # as the format asks
        touching = data["contact_status"].values[index] != 0
        partners = np.column_stack([data["contact_disk"], data["contact_partner"]])
        np.testing.assert_array_equal(frame["bonds/group"], partners[touching])
        np.testing.assert_array_equal(
            frame["log/bonds/normal_force"].ravel(), data["contact_normal_force"].values[index][touching]
        )
    assert float(frames[1]["log/load_factor"][0]) == 1.0
    assert float(frames[0]["log/box_width"][0]) == data.attrs["width"]
    # what the load adds to the contact forces balances the load, on the loaded disk alone
    change = frames[1]["log/particles/force_change"]
    loaded = int(data["loaded_disk"][0])
    np.testing.assert_allclose(change[loaded], [-FORCE[0], -FORCE[1], 0.0], atol=1e-9)
    np.testing.assert_allclose(np.delete(change, loaded, axis=0), 0.0, atol=1e-9)


def test_xyz(result, data, tmp_path):
    lines = export(result, tmp_path / "result.xyz").read_text().splitlines()
    n = data.sizes["disk"]
    assert len(lines) == data.sizes["state"] * (n + 2)
    for index in range(data.sizes["state"]):
        count, header, *rows = lines[index * (n + 2) : (index + 1) * (n + 2)]
        assert int(count) == n
        lattice = np.array(re.search(r'Lattice="([^"]+)"', header)[1].split(), float).reshape(3, 3)
        assert lattice[0, 0] == data.attrs["width"]
        fields = re.search(r"Properties=(\S+)", header)[1].split(":")
        table, column = {}, 0
        cells = [row.split() for row in rows]
        for name, kind, width in zip(fields[::3], fields[1::3], map(int, fields[2::3]), strict=True):
            values = [cell[column : column + width] for cell in cells]
            table[name] = values if kind == "S" else np.array(values, float)
            column += width
        assert all(len(cell) == column for cell in cells)
        np.testing.assert_array_equal(table["pos"][:, :2], data["position"].values[index])
        np.testing.assert_array_equal(table["radius"][:, 0], data["radius"])
        np.testing.assert_array_equal(table["angle"][:, 0], data["angle"].values[index])
        force = table["force_change"].sum(axis=0)
        np.testing.assert_allclose(force, np.array([-FORCE[0], -FORCE[1], 0.0]) * index, atol=1e-9)
        closed = (data["contact_status"].values[index] != 0).sum() * 2
        closed += (data["wall_status"].values[index] != 0).sum()
        assert table["coordination"].sum() == closed


def read_vtu(path: Path) -> dict[str, np.ndarray]:
    """Arrays of a VTK unstructured grid: in base64, 8 bytes of length, then the values."""
    root = ElementTree.parse(path).getroot()
    assert (root.get("type"), root.get("header_type")) == ("UnstructuredGrid", "UInt64")
    kinds = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}
    found = {}
    for array in root.iter("DataArray"):
        raw = base64.b64decode(array.text)
        assert struct.unpack_from("<Q", raw) == (len(raw) - 8,)
        values = np.frombuffer(raw[8:], kinds[array.get("type")])
        components = int(array.get("NumberOfComponents", 1))
        found[array.get("Name")] = values.reshape(-1, components) if components > 1 else values
    piece = root.find(".//Piece")
    counts = {"points": "NumberOfPoints", "types": "NumberOfCells"}
    assert all(len(found[name]) == int(piece.get(count)) for name, count in counts.items())
    return found


@pytest.mark.parametrize("index", [0, -1])
def test_vtu(result, data, tmp_path, index):
    mesh = read_vtu(export(result, tmp_path / "result.vtu", state=index))
    state = data.isel(state=index)
    n = data.sizes["disk"]
    vertices, lines = mesh["types"] == 1, mesh["types"] == 3  # VTK's numbers of the two kinds of cells
    assert (vertices | lines).all()
    starts = np.concatenate([[0], mesh["offsets"][:-1]])
    np.testing.assert_array_equal(mesh["offsets"] - starts, np.where(lines, 2, 1))
    np.testing.assert_array_equal(mesh["connectivity"][starts[vertices]], np.arange(n))
    np.testing.assert_array_equal(mesh["points"][:n, :2], state["position"])
    np.testing.assert_array_equal(mesh["radius"][:n], state["radius"])
    normal, tangential = mesh["normal_force"][lines], mesh["tangential_force"][lines]
    stored = np.concatenate([state["contact_normal_force"], state["wall_normal_force"]])
    np.testing.assert_array_equal(normal, stored[stored > 0])
    assert not mesh["normal_force"][vertices].any()
    # forces along the lines carry every disk: weight, and load on one of them
    first, second = mesh["connectivity"][starts[lines]], mesh["connectivity"][starts[lines] + 1]
    branch = mesh["points"][first] - mesh["points"][second]
    along = branch / np.linalg.norm(branch, axis=1, keepdims=True)
    across = np.column_stack([-along[:, 1], along[:, 0], 0.0 * normal])
    force = normal[:, None] * along + tangential[:, None] * across
    total = np.zeros((len(mesh["points"]), 3))
    np.add.at(total, first, force)
    np.add.at(total, second, -force)
    expected = np.zeros((n, 3))
    expected[:, 1] = state["mass"]
    expected[int(data["loaded_disk"][0]), :2] -= np.array(FORCE) * float(state["state_load_factor"])
    np.testing.assert_allclose(total[:n], expected, atol=1e-9)
    sums = contact_force_sums(state_from(data, index))
    np.testing.assert_allclose(mesh["contact_force"][:n, :2], sums, atol=1e-12)


@pytest.mark.parametrize("index", [0, 1, -1])
def test_one_frame_is_that_of_the_whole_file(result, tmp_path, index):
    for suffix in (".xyz", ".dump"):
        whole = export(result, tmp_path / f"whole{suffix}").read_text()
        one = export(result, tmp_path / f"one{suffix}", state=index).read_text()
        lines = whole.splitlines(keepends=True)
        size = len(lines) // 2
        assert one == "".join(lines[index % 2 * size :][:size]) != whole
    whole, one = (read_gsd(export(result, tmp_path / name, state=k)) for name, k in (("w.gsd", None), ("o.gsd", index)))
    expected = {**whole[0], **whole[index % 2]}
    assert sorted(one) == [0] and sorted(whole) == [0, 1]
    for name in ("particles/position", "log/particles/force_change", "log/load_factor", "bonds/group"):
        np.testing.assert_array_equal(one[0][name], expected[name])


def test_errors_are_one_line(result, tmp_path, monkeypatch):
    with pytest.raises(ExportError, match=r"format '\.pdf' is unknown, must be \.contacts\.csv or .* or \.xyz$"):
        export(result, tmp_path / "result.pdf")
    with pytest.raises(ExportError, match=r"^state = 0: \S+\.pvd is a series of all states, must be left out \(.*\)$"):
        export(result, tmp_path / "result.pvd", state=0)
    refuses(ExportError, r"state = 2: must be from -2 to 1", export, result, tmp_path / "result.vtu", state=2)
    refuses(ExportError, r"state = -3: must be from -2 to 1", export, result, tmp_path / "result.xyz", state=-3)
    refuses(store.StoreError, "no such file", export, tmp_path / "absent.nc", tmp_path / "result.gsd")
    (tmp_path / "file").write_text("")
    refuses(ExportError, "cannot be written", export, result, tmp_path / "file" / "result.gsd")
    study = tmp_path / "study.nc"
    store.write(study, {"a": store.read(result)[""][["radius"]]})
    refuses(ResultError, "holds no states", export, study, tmp_path / "result.gsd")
    with pytest.raises(ExportError, match=r"in.lammps: loads\[0\].torque: must be left out"):
        lammps_lines({"loads.0.torque": 0.1}, tmp_path / "in.lammps")
    monkeypatch.setitem(sys.modules, "gsd", None)
    monkeypatch.setitem(sys.modules, "gsd.hoomd", None)
    refuses(ExportError, r"needs the package gsd.*, pip install gsd$", export, result, tmp_path / "result.gsd")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "study.nc"]


ODD = ["my slab", "a#b", "a$b", 'a"b', "a&<b>", "größe", "a%b", "a*b", "a\nshell rm b", "a\x01b"]


@pytest.mark.parametrize("stem", ODD)
def test_names_stand_in_files_as_what_they_are_or_are_refused(result, tmp_path, stem):
    """Of LAMMPS a blank ended a name, and a line end began a command."""
    said = refuses(ExportError, r"must have a name of letters a to z", export, result, tmp_path / f"{stem}.lammps")
    assert "\n" not in said and not list(tmp_path.iterdir())
    if not stem.isprintable():
        refuses(ExportError, "control characters", export, result, tmp_path / f"{stem}.pvd")
        return
    root = ElementTree.parse(export(result, tmp_path / f"{stem}.pvd")).getroot()
    assert all(read_vtu(tmp_path / entry.get("file")) for entry in root.iter("DataSet"))
    for suffix in (".gsd", ".xyz", ".data", ".csv"):
        assert export(result, tmp_path / f"{stem}{suffix}").stat().st_size > 0


def test_a_series_for_paraview(result, data, tmp_path):
    import meshio

    series = export(result, tmp_path / "result.pvd")
    entries = list(ElementTree.parse(series).getroot().iter("DataSet"))
    assert [entry.get("timestep") for entry in entries] == ["0.0", "1.0"]
    for index, entry in enumerate(entries):
        mesh = meshio.read(tmp_path / entry.get("file"))
        n = data.sizes["disk"]
        np.testing.assert_array_equal(mesh.points[:n, :2], data["position"][index])
        stress = mesh.point_data["added_stress_zz"][:n]
        assert np.all(stress == 0.0) if index == 0 else stress.max() > 0.05
        assert mesh.point_data["added_stress_xz"].shape == mesh.point_data["radius"].shape
    opened, disk = gr.open_result(result), 9
    x, z = data["position"].values[1][disk]
    stress = opened.stress(x=[x - opened.origin], z=[z])
    np.testing.assert_allclose(mesh.point_data["added_stress_zz"][disk], stress.values[0, 0, 1, 1], rtol=1e-9)


def carried() -> dict[str, dict[str, str]]:
    """The table of the user guide: for each ending of a name its columns."""
    guide = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
    head, _, *rows = re.search(r"^\| file \| states \|(?:.*\n\|)*.*", guide, re.MULTILINE)[0].splitlines()
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in (head, *rows)]
    return {
        suffix: dict(zip(cells[0][1:], row[1:], strict=True))
        for row in cells[1:]
        for suffix in re.findall(r"`([^`]+)`", row[0])
    }


@pytest.fixture(scope="module")
def periodic(tmp_path_factory) -> Path:
    """Disks of several sizes and masses that have turned and bear friction: no two quantities have the same values."""
    folder = tmp_path_factory.mktemp("carried")
    (folder / "disks.csv").write_text("x,z,radius,mass\n1,1,1,1\n3,1,1,2\n5.2,1,0.9,1.5\n2,2.7,1,1.2\n4,2.7,0.95,3\n")
    packing = {"kind": "file", "path": "disks.csv", "width": 6.4, "sides": "periodic"}
    load = {"disk": 3, "force": [0.0, -1.0]}
    scene = Scene.from_dict(
        {"packing": packing, "contact": {"friction": 0.5}, "wall": {"friction": 0.5}, "loads": [load]}, folder=folder
    )
    store.write(folder / "result.nc", to_dataset(solve_scene(scene)))
    return folder / "result.nc"


def comes_back(result: Path, path: Path) -> set[str]:
    """What reading the file gives again of the last state."""
    if path.suffix == ".nc":
        return set(carried()[".nc"]) - {"states"}  # to the last bit: test_result.py
    if path.name.endswith(".contacts.csv"):  # beside a file of the disks
        beside = {"path": str(export(result, path.with_name("disks.csv"))), "springs": str(path), "width": None}
        scene = scene_of(read_result(result), folder=result.parent).updated({"packing": {"kind": "file", **beside}})
        state = Problem.from_scene(scene).bare_state()
        last = store.read(result)[""].isel(state=-1)
        stored = np.concatenate([last["contact_spring"].values, last["wall_spring"].values])
        springs = np.concatenate([state.pairs.spring, state.walls.spring])
        np.testing.assert_allclose(springs[springs != 0.0], stored[stored != 0.0], rtol=1e-9)
        return {"tangential springs"}
    try:
        FilePacking(path=str(path), sides="periodic").build()
    except SceneError:
        return set()
    return {"position, radius", "mass", "width, sides"}  # as tests/unit/scene/test_formats.py finds them


@pytest.mark.filterwarnings("ignore:.*read again")
@pytest.mark.parametrize("ending", [".nc", *SUFFIXES])
def test_what_the_user_guide_says_comes_back(periodic, tmp_path, ending):
    assert set(carried()) == {".nc", *SUFFIXES}
    path = periodic if ending == ".nc" else export(periodic, tmp_path / f"disks{ending}")
    assert comes_back(periodic, path) == {name for name, says in carried()[ending].items() if says == "back"}


def lammps_lines(scene: dict, path: Path, state: int = -1) -> list[str]:
    made = gr.solve(Scene.from_dict(SCENE).updated(scene), progress=False).export(path, state=state)
    return made.read_text().splitlines()


def test_a_script_for_lammps_has_the_laws_the_box_and_the_load(tmp_path):
    """The same script, run by LAMMPS of 22 Jul 2025: forces of 2e-11 at step 0 and none after."""
    lines = lammps_lines({"wall.friction": 0.1, "contact.damping_ratio": 0.25}, tmp_path / "in.lammps", 0)
    k, kt = 3000.0, 2400.0
    (pair,) = (line for line in lines if line.startswith("pair_style"))
    # dashpots are per effective mass, which is 1/2
    numbers = [float(word) for word in pair.split()[2:]]
    np.testing.assert_allclose(numbers, [k, kt, k**0.5, kt**0.5, 0.4, 1], rtol=1e-14)
    assert "gran/hooke/history" in pair and "pair_coeff * *" in lines
    (floor,) = (line for line in lines if line.startswith("fix floor"))
    assert "granular hooke 6000.0" in floor and floor.endswith("yplane 0.0 NULL contacts") and " 0.1 damping" in floor
    assert "fix sides" in "\n".join(lines) and lines[-2] == "run ${end}"
    assert "group loaded0 id 17" in lines and "variable y0 equal -1.0*v_factor" in lines
    assert "variable factor equal 0.0+(1.0)*((step<40000)*step/40000+(step>=40000))" in lines
    again = FilePacking(path=str(tmp_path / "in.data"), width=14.0, origin=(0.0, 0.0)).build()
    assert again.n == 20 and "read_data in.data" in lines


def test_the_example_for_lammps_writes_what_springs_are_read_from(tmp_path):
    """Run by LAMMPS of 22 Jul 2025. Its last lines and those of a script that is exported have the same columns."""
    ours = lammps_lines({"wall.friction": 0.1}, tmp_path / "in.lammps", 0)
    example = (ROOT / "examples" / "pour.lammps").read_text().splitlines()

    def line(lines, start):
        (found,) = (one for one in lines if one.startswith(start))
        return found

    for same in ("compute pair ", "compute bears ", "dump_modify bears "):
        assert line(example, same) == line(ours, same)
    assert line(example, "dump bears ").split()[6:] == line(ours, "dump bears ").split()[6:]
    disks = [word for word in line(ours, "write_dump ").split()[4:] if word not in ("vx", "vy", "omegaz")]
    assert line(example, "write_dump ").split()[4:] == disks
    for fix in ("fix floor ", "fix sides "):
        assert line(example, fix).split()[:5] == line(ours, fix).split()[:5]
    last = line(example, "run ").split()[1]
    assert line(example, "dump bears ").split()[4] == last


def test_a_script_for_lammps_of_a_loaded_state_keeps_its_load(tmp_path):
    lines = lammps_lines(
        {"packing.sides": "periodic", "wall.friction": 0.2, "loads.0.force": [0.0, -1.0]}, tmp_path / "in.lammps"
    )
    assert "variable factor equal 1.0" in lines and "boundary p fs p" in lines
    assert not any(line.startswith("fix sides") for line in lines)
    hertz = lammps_lines({"contact.law": "hertz", "protocol.tensile_dashpot": False}, tmp_path / "in.lammps")
    (pair,) = (line for line in hertz if line.startswith("pair_coeff"))
    constant = float(pair.split()[4])  # of sqrt(1/2) xi^(3/2) between two mean disks
    assert pair.split()[3] == "hertz" and constant * 0.5**0.5 == pytest.approx(2000.0**1.5)
    assert pair.endswith("damping velocity limit_damping")
    smooth = lammps_lines({"contact.friction": 0.0, "contact.damping_ratio": 0.25}, tmp_path / "in.lammps")
    (pair,) = (line for line in smooth if line.startswith("pair_coeff"))
    smooth = f"hooke 3000.0 {0.5 * 3000.0**0.5!r} tangential linear_nohistory 0.0 0.0"
    assert pair == f"pair_coeff * * {smooth} damping velocity"


def test_a_mesh_moves_as_the_disks_do(periodic, tmp_path):
    """A point of a contact without a disk moves with the disk, along its wall or across the side."""
    states, mesh = store.read(periodic)[""], read_vtu(export(periodic, tmp_path / "disks.vtu"))
    n, moved = states.sizes["disk"], np.diff(states["position"].values[[0, -1]], axis=0)[0]
    assert np.abs(moved).max() > 1e-5 and len(mesh["points"]) > n
    np.testing.assert_array_equal(mesh["displacement"][:n, :2], moved)
    ends, pairs = mesh["displacement"][n:], mesh["connectivity"][n:].reshape(-1, 2)
    bottom = mesh["points"][n:, 1] == 0.0
    owner = {int(point): int(disk) for disk, point in pairs if point >= n}
    np.testing.assert_array_equal(ends[bottom, 1], 0.0)
    for point in np.flatnonzero(bottom):
        assert ends[point, 0] == moved[owner[n + point], 0]
    for point in np.flatnonzero(~bottom):  # an image: there is a disk that moves alike
        assert (ends[point, :2] == moved).all(axis=1).any()
    assert bottom.any() and not bottom.all()
    assert not read_vtu(export(periodic, tmp_path / "rest.vtu", state=0))["displacement"].any()


@pytest.mark.parametrize(
    ("factors", "times"), [([0.25, 1.0], [0.0, 0.25, 1.0]), ([0.5, 1.0, 0.5], [0, 1, 2, 3]), ([0.0], [0, 1])]
)
def test_the_times_of_a_series_are_its_loads_where_these_grow(tmp_path, factors, times):
    solved = gr.solve(Scene.from_dict(SCENE), load_factors=factors, progress=False)
    series = ElementTree.parse(solved.export(tmp_path / "path.pvd")).getroot()
    assert [float(entry.get("timestep")) for entry in series.iter("DataSet")] == times
    for entry, factor in zip(series.iter("DataSet"), [0.0, *factors], strict=True):
        assert read_vtu(tmp_path / entry.get("file"))["load_factor"].tolist() == [factor]


def test_a_script_never_replaces_the_disks_that_its_scene_reads(tmp_path, monkeypatch):
    """``in.lammps`` has an ``in.data`` beside it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "in.csv").write_text("x,z,radius\n2,1,1\n5,1,1\n")
    scene = {"packing": {"kind": "file", "path": "in.csv", "width": 10}, "contact": {"friction": 0.0}, "loads": []}
    export(gr.solve(scene, progress=False), "in.data")
    disks = (tmp_path / "in.data").read_bytes()
    scene["packing"]["path"] = "in.data"
    scene["packing"].pop("width")
    result = gr.solve(scene, progress=False)
    result.save("result.nc")
    for one in (result, "result.nc", result.to_dataset()):
        refuses(gr.ExportError, "in.lammps: cannot be written: is read by the same", gr.export, one, "in.lammps")
    assert (tmp_path / "in.data").read_bytes() == disks
