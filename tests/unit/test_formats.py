"""Packings from other programs, and back."""

from pathlib import Path

import numpy as np
import pytest
from commands import call

from granular_response.machine import memory
from granular_response.scene import FilePacking, Scene, SceneError, formats
from granular_response.scene.errors import show
from granular_response.solve import solution, solve_scene
from granular_response.solve.size import STATICS, check_memory
from granular_response.store import files as store
from granular_response.store.export import export
from granular_response.store.result import to_dataset

TABLE = "x,z,radius,density\n1,1,1,1\n3,1,1,2\n5.2,1,0.9,1\n2,2.7,1,1\n4,2.7,0.95,3\n"


@pytest.fixture(scope="module")
def result(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("formats")
    (folder / "disks.csv").write_text(TABLE)
    packing = {"kind": "file", "path": "disks.csv", "width": 6.3}
    load = {"disk": 3, "force": [0.0, -1.0]}
    scene = Scene.from_dict({"packing": packing, "contact": {"friction": 0.3}, "loads": [load]}, folder=folder)
    store.write(folder / "result.nc", to_dataset(solve_scene(scene)))
    return folder / "result.nc"


@pytest.fixture(scope="module")
def periodic(tmp_path_factory) -> Path:
    packing = {"kind": "slab", "layers": 2, "disks_per_row": 5, "sides": "periodic"}
    load = {"disk": 7, "force": [0.0, -1.0]}
    path = tmp_path_factory.mktemp("periodic") / "result.nc"
    store.write(path, to_dataset(solve_scene(Scene.from_dict({"packing": packing, "loads": [load]}))))
    return path


def build(path: Path, text: str | None = None, **changes):
    if text is not None:
        path.write_text(text)
    return FilePacking(path=str(path), **changes).build()


#: For each format: an ending of a name, and the precision of its numbers.
ENDINGS = {"csv": (".csv", 0), "lammps-data": (".data", 1e-15), "lammps-dump": (".dump", 0), "yade": (".txt", 0)}
ENDINGS["gsd"] = (".gsd", 1e-6)


def test_every_format_is_tried():
    assert set(ENDINGS) == set(formats.SUFFIXES)


@pytest.mark.parametrize("name", ENDINGS)
def test_disks_that_need_more_memory_than_there_is_are_refused_once_they_are_counted(
    result, tmp_path, name, monkeypatch
):
    """A lattice is refused before it is built; what a file holds is known when it has been read."""
    path = export(result, tmp_path / f"disks{ENDINGS[name][0]}")
    scene = Scene.from_dict({"packing": {"kind": "file", "path": str(path), "width": 6.3}})
    started: list[object] = []
    monkeypatch.setattr(solution, "rest_state", lambda problem, **_: started.append(problem))
    monkeypatch.setattr(memory, "available", lambda: 5 * STATICS - 1)
    with pytest.raises(SceneError, match=r"^packing: 5 disks need at least 2\.33e-05 GiB of memory, there are "):
        solve_scene(scene)
    assert not started
    monkeypatch.setattr(memory, "available", lambda: 5 * STATICS)
    check_memory(scene, 5)


def exported(result, folder, name):
    """A result, the file of its disks, how precise that is, and what a scene has to add to it."""
    suffix, precision = ENDINGS[name]
    stored = store.read(result)[""]
    width = {"width": stored.attrs["width"]} if name in ("csv", "yade") else {}
    return stored, export(result, folder / f"disks{suffix}"), precision, width


@pytest.mark.parametrize("name", ENDINGS)
def test_what_is_exported_is_imported(result, tmp_path, name):
    stored, path, precision, width = exported(result, tmp_path, name)
    for packing in (build(path, **width), build(path, format=name, **width)):
        scale = stored["radius"].values.mean()
        np.testing.assert_allclose(packing.radius * scale, stored["radius"], rtol=precision + 1e-15)
        np.testing.assert_allclose(packing.position * scale, stored["position"][-1], atol=10 * precision + 1e-14)
        assert packing.width * scale == pytest.approx(stored.attrs["width"], rel=10 * precision + 1e-14)
        if name != "yade":  # its text has no masses
            np.testing.assert_allclose(packing.mass, stored["mass"], rtol=10 * precision + 1e-14)


@pytest.mark.parametrize("name", ENDINGS)
def test_a_periodic_result_comes_back_periodic(periodic, tmp_path, name):
    stored, path, precision, width = exported(periodic, tmp_path, name)
    packing = build(path, sides="periodic", **width)
    assert packing.periodic and packing.width == pytest.approx(stored.attrs["width"], rel=1e-14)
    apart = packing.position - stored["position"].values[-1]
    apart[:, 0] -= packing.width * np.round(apart[:, 0] / packing.width)
    np.testing.assert_allclose(apart, 0.0, atol=10 * precision + 1e-14)
    if name in ("csv", "yade"):  # which do not say
        assert formats.read(path, name).periodic is None
        return
    with pytest.raises(SceneError) as caught:
        build(path)
    assert (
        str(caught.value) == f"packing.sides = 'walls': must be periodic, the box of {show(str(path))} is periodic in x"
    )
    with pytest.raises(
        SceneError, match=r"^packing\.width = 10\.1: must be 10\.0 or left out, the period of the box of "
    ):
        build(path, sides="periodic", width=10.1)
    build(path, sides="periodic", width=10.0)


def test_density_makes_mass(tmp_path):
    packing = build(tmp_path / "a.csv", "x,z,radius,density\n1,1,1,1\n4,1,2,3\n", width=9.0)
    np.testing.assert_allclose(packing.mass, np.array([1.0, 12.0]) / 6.5)
    np.testing.assert_allclose(packing.inertia, 0.5 * packing.mass * packing.radius**2)
    packing = build(tmp_path / "a.csv", "x,z,radius,mass\n1,1,1,1\n4,1,2,3\n", width=9.0)
    np.testing.assert_allclose(packing.mass, [0.5, 1.5])
    assert build(tmp_path / "a.csv", "x,z,radius\n1,1,1\n4,1,2\n", width=9.0).given_mass is None


def test_a_heavy_disk_weighs_on_the_floor(tmp_path):
    (tmp_path / "a.csv").write_text("x,z,radius,density\n2,1,1,1\n5,1,1,3\n")
    packing = {"kind": "file", "path": "a.csv", "width": 7}
    scene = Scene.from_dict({"packing": packing, "contact": {"friction": 0.0}, "loads": []}, folder=tmp_path)
    force = solve_scene(scene).rest.walls
    floor = force.second == 0
    np.testing.assert_allclose(force.normal_force[floor], [0.5, 1.5], atol=1e-9)


DATA = """\
made by hand

3 atoms
1 atom types

10.0 20.0 xlo xhi
-5.0 5.0 ylo yhi
-1.0 1.0 zlo zhi

Masses

1 1.0

Atoms # sphere

1 1 2.0 1.0 11.0 -4.0 0.0
2 1 2.0 1.0 13.0 -4.0 0.0 0 0 0
3 1 1.0 4.0 15.0 -4.5 0.0

Velocities

1 0 0 0 0 0 0
"""
DUMP = """\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
1
ITEM: BOX BOUNDS ff ff pp
0 1
0 1
0 1
ITEM: ATOMS id type x y z radius
1 1 0.5 0.5 0 0.5
ITEM: TIMESTEP
7
ITEM: NUMBER OF ATOMS
2
ITEM: BOX BOUNDS ff pp ff
-5 5
-1 1
2 12
ITEM: ATOMS id xs yu z diameter mass
1 0.1 0 3.0 2.0 1.0
2 0.4 0 3.5 3.0 5.0
"""


def test_lammps_data(tmp_path):
    packing = build(tmp_path / "a.data", DATA)
    scale = 2.5 / 3
    np.testing.assert_allclose(packing.position * scale, [[1, 1], [3, 1], [5, 0.5]])
    np.testing.assert_allclose(packing.radius * scale, [1, 1, 0.5])
    assert packing.width * scale == pytest.approx(10)
    np.testing.assert_allclose(packing.mass, np.array([8, 8, 4]) / (20 / 3))


def test_lammps_dump_has_the_last_frame(tmp_path):
    packing = build(tmp_path / "a.lammpstrj", DUMP)
    np.testing.assert_allclose(packing.position * 1.25, [[1, 1], [4, 1.5]])
    np.testing.assert_allclose(packing.radius * 1.25, [1, 1.5])
    np.testing.assert_allclose(packing.mass, [1 / 3, 5 / 3])
    assert packing.width * 1.25 == pytest.approx(10)


def test_lammps_dump_says_what_the_sides_are(tmp_path):
    text = DUMP.replace("ff pp ff", "pp pp ff").replace("1 0.1 0", "1 1.1 0").replace("2 0.4 0", "2 -0.6 0")
    packing = build(tmp_path / "a.dump", text, sides="periodic")
    np.testing.assert_allclose(packing.position * 1.25, [[1, 1], [4, 1.5]])
    assert packing.periodic and packing.width * 1.25 == pytest.approx(10)
    with pytest.raises(
        SceneError, match=r"^packing\.sides = 'walls': must be periodic, the box of '.*' is periodic in x$"
    ):
        build(tmp_path / "a.dump", text)
    with pytest.raises(SceneError, match=r"'periodic': must be walls, the box of '.*' is not periodic in x$"):
        build(tmp_path / "a.dump", DUMP, sides="periodic")
    for sides in ("walls", "periodic"):  # a file without flags
        assert build(tmp_path / "a.dump", DUMP.replace(" ff pp ff", ""), sides=sides).periodic == (sides == "periodic")


@pytest.mark.parametrize(("name", "text", "last"), [("a.data", DATA, 3), ("a.dump", DUMP, 2)])
def test_lammps_disks_are_in_the_order_of_their_ids(tmp_path, name, text, last):
    """LAMMPS writes them in any order, and loads name them by their place."""
    lines = text.splitlines(keepends=True)
    first = max(k for k, line in enumerate(lines) if "Atoms" in line or "ITEM: ATOMS" in line) + 1
    first += not lines[first].strip()
    rows = lines[first : first + last]
    ordered = build(tmp_path / name, text)
    shuffled = build(tmp_path / name, "".join([*lines[:first], *rows[::-1], *lines[first + last :]]))
    np.testing.assert_array_equal(shuffled.position, ordered.position)
    np.testing.assert_array_equal(shuffled.radius, ordered.radius)
    np.testing.assert_array_equal(shuffled.mass, ordered.mass)
    bad = "".join([*lines[:first], *rows[::-1], *lines[first + last :]]).replace(rows[0], "1" + rows[0])
    far = build(tmp_path / name, bad)  # 11 comes after 2
    np.testing.assert_array_equal(far.position, np.roll(ordered.position, -1, axis=0))


def test_yade_in_either_plane(tmp_path):
    for text in ("# by hand\n1 0 1 1\n3 0 1.5 1\n", "#format x_y_z_r_matId\n1 1 2 1 0\n3 1.5 2 1 0\n"):
        packing = build(tmp_path / "a.txt", text, width=9.0)
        np.testing.assert_allclose(packing.position, [[1, 1], [3, 1.5]])


def test_gsd_of_others_has_its_origin_in_the_middle(tmp_path):
    hoomd = pytest.importorskip("gsd.hoomd")
    frame = hoomd.Frame()
    frame.configuration.box = [10, 8, 1, 0, 0, 0]
    frame.particles.N = 2
    frame.particles.position = [[-4, -3, 0], [-1, -2.5, 0]]
    frame.particles.diameter = [2, 2]
    with hoomd.open(str(tmp_path / "a.gsd"), "w") as file:
        file.append(frame)
    packing = build(tmp_path / "a.gsd")
    np.testing.assert_allclose(packing.position, [[1, 1], [4, 1.5]])
    assert packing.width == 10 and packing.given_mass is None


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.csv", "x,z,radius,stiffness\n1,1,1,5\n", "column stiffness: must be left out, contact.normal_stiffness is"),
        ("a.csv", "x,z,radius,mass,density\n1,1,1,5,1\n", "columns mass and density: must have one of them"),
        ("a.csv", "x,z,radius,density\n1,1,1,0\n", "line 2: density = 0.0: must be greater than 0"),
        ("a.data", DATA.replace("3 atoms", "4 atoms"), "is not a whole LAMMPS data file"),
        ("a.data", DATA.replace("# sphere", "# atomic"), "line 14: atoms must be of style sphere"),
        ("a.data", DATA.replace("2.0 1.0 13.0", "2.0 one 13.0"), "line 17: density = 'one': must be a finite number"),
        ("a.data", DATA.replace("3 1 1.0", "1 1 1.0"), "line 18: id = 1: must differ from that of line 16"),
        ("a.dump", DUMP.replace("2 0.4", "1 0.4"), "line 21: id = 1: must differ from that of line 20"),
        ("a.dump", DUMP.replace("2 0.4", "2.5 0.4"), "line 21: id = '2.5': must be a whole number"),
        ("a.dump", DUMP.replace("2 0.4", "9" * 5000 + " 0.4"), "must be a whole number"),
        ("a.data", "", "is not a whole LAMMPS data file"),
        ("a.dump", DUMP.replace("diameter", "size"), "line 19: column radius or diameter is missing"),
        ("a.dump", DUMP[:-20], "holds 1 of 2 atoms in its last frame"),
        ("a.dump", "x,z,radius\n", "is not a LAMMPS dump file of text"),
        ("a.dump", DUMP.replace("yu", "vy"), "line 19: column y is missing"),
        ("a.txt", "1 0 1\n", "line 1: has 3 values, must have x y z r"),
        ("a.txt", "1 0 1 1\n2 1 2 1\n", "disks must lie in one plane"),
        ("a.txt", "", "has no spheres"),
        ("a.gsd", "not a gsd file", "is not a GSD file with particles"),
    ],
)
def test_mistakes_are_one_line(tmp_path, name, text, said):
    with pytest.raises(SceneError) as caught:
        build(tmp_path / name, text, width=9.0)
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_periodic_sides_take_any_place(tmp_path):
    text = "x,z,radius\n-1,1,1\n3,1,1\n10,1,1\n"
    packing = build(tmp_path / "a.csv", text, width=8.0, sides="periodic")
    np.testing.assert_allclose(packing.position[:, 0], [7, 3, 2])
    assert packing.box.periodic
    with pytest.raises(SceneError, match=r"line 2: x = -1.0: must be between the side walls"):
        build(tmp_path / "a.csv", text, width=8.0)


def test_a_file_without_a_box_needs_a_width(tmp_path):
    with pytest.raises(SceneError, match=r"packing\.width = null: must be given, the file has no box"):
        build(tmp_path / "a.csv", "x,z,radius\n1,1,1\n")
    with pytest.raises(SceneError, match=r"packing\.format = 'vtk': must be csv or lammps-data or"):
        Scene.from_dict({"packing": {"kind": "file", "path": "a", "format": "vtk"}})


def test_on_the_command_line(result, tmp_path):
    """What a program of others hands over is solved, and handed back."""
    (tmp_path / "a.data").write_text(DATA)
    (tmp_path / "scene.yaml").write_text("packing: {kind: file, path: a.data}\ncontact: {friction: 0.2}\nloads: []\n")
    for arguments in (["run", "scene.yaml", "-o", "a.nc"], ["export", "a.nc", "-o", "b.lmp"]):
        finished = call(*arguments, folder=tmp_path)
        assert finished.returncode == 0, finished.stderr
    assert "3 atoms" in (tmp_path / "b.lmp").read_text()
