"""Packings from other programs, and back."""

import gzip
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from commands import succeeded
from places import ROOT
from refusals import refuses

import granular_response as gr
from granular_response.machine import memory
from granular_response.scene import FilePacking, Scene, SceneError, formats
from granular_response.scene.formats import SUFFIXES
from granular_response.solvers.size import STATICS
from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.export import export
from granular_response.store.result import to_dataset

#: Packings of other programs, with what is right in README.md beside them.
PACKINGS = ROOT / "tests" / "data" / "packings"
TABLE = "x,z,radius,density\n1,1,1,1\n3,1,1,2\n5.2,1,0.9,1\n2,2.7,1,1\n4,2.7,0.95,3\n"


def build(path: Path, text: str | None = None, **changes):
    if text is not None:
        path.write_text(text)
    return FilePacking(path=str(path), **changes).build()


#: For each format: an ending of a name, and the precision of its numbers.
ENDINGS = {name: (suffixes[0], {"lammps-data": 1e-15, "gsd": 1e-6}.get(name, 0)) for name, suffixes in SUFFIXES.items()}


def test_disks_that_need_more_memory_than_there_is_are_refused_once_a_file_is_read(tmp_path, monkeypatch):
    (tmp_path / "a.csv").write_text(TABLE)
    scene = Scene.from_dict({"packing": {"kind": "file", "path": "a.csv", "width": 6.3}}, folder=tmp_path)
    monkeypatch.setattr(memory, "available", lambda: 5 * STATICS - 1)
    refuses(SceneError, r"^packing: 5 disks need at least 2\.33e-05 GiB of memory, there are ", solve_scene, scene)


@pytest.fixture(scope="module")
def results(tmp_path_factory) -> Path:
    """Between walls, with periodic sides, and of masses of 1, which a .gsd file leaves out."""
    folder = tmp_path_factory.mktemp("formats")
    (folder / "disks.csv").write_text(TABLE)
    slab = {"kind": "slab", "layers": 2, "disks_per_row": 5, "sides": "periodic"}
    table = {"kind": "file", "path": "disks.csv", "width": 6.3}
    equal = {"kind": "file", "path": str(PACKINGS / "equal_masses.csv"), "width": 8}
    for name, packing, friction in (("walls", table, 0.3), ("periodic", slab, 0.2), ("equal", equal, 0.0)):
        loads = [{"disk": 3, "force": [0.0, -1.0]}]
        scene = {"packing": packing, "contact": {"friction": friction}, "loads": loads}
        store.write(folder / f"{name}.nc", to_dataset(solve_scene(Scene.from_dict(scene, folder=folder))))
    return folder


@pytest.mark.filterwarnings("ignore:.*read again")
@pytest.mark.parametrize("source", ["walls", "periodic", "equal"])
@pytest.mark.parametrize("name", ENDINGS)
def test_what_is_exported_is_imported(results, tmp_path, name, source):
    """Nothing has to be added but that sides are periodic: the box comes back in every format."""
    (suffix, precision), stored = ENDINGS[name], store.read(results / f"{source}.nc")[""]
    path, sides = export(results / f"{source}.nc", tmp_path / f"disks{suffix}"), stored.attrs["sides"]
    for packing in (build(path, sides=sides), build(path, sides=sides, format=name)):
        scale, width = stored["radius"].values.mean(), stored.attrs["width"]
        np.testing.assert_allclose(packing.radius * scale, stored["radius"], rtol=precision + 1e-15)
        apart = packing.position * scale - stored["position"].values[-1]
        apart[:, 0] -= packing.periodic * width * np.round(apart[:, 0] / width)
        np.testing.assert_allclose(apart, 0.0, atol=10 * precision + 1e-14)
        assert packing.width * scale == pytest.approx(width, rel=10 * precision + 1e-14)
        np.testing.assert_allclose(packing.mass, stored["mass"], rtol=10 * precision + 1e-14)
        assert packing.periodic == (source == "periodic")
    if packing.periodic:
        refuses(SceneError, r"^packing\.sides = 'walls': must be periodic, the box of .* is periodic in", build, path)
        said = r"^packing\.width = 10\.1: must be 10\.0 or left out, the period of the box"
        refuses(SceneError, said, build, path, sides=sides, width=10.1)
        build(path, sides=sides, width=10.0)


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
2 0 0 0 0 0 0
3 0 0 0 0 0 0
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


#: The walls of DATA, which the format does not say.
WALLS = {"width": 10.0, "origin": (10.0, -5.0)}


TWO = "1,1,1,1\n4,1,2,3\n"
ONE = "x,z,radius,mass\n1,1,1,1\n"
#: A frame whose bounds come last, cut before they do.
LATE_BOX = """\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
1
ITEM: ATOMS id x y z radius
1 5 1 0 1
ITEM: BOX BOUNDS ff ff pp
"""


def test_lammps_data(tmp_path):
    packing = build(tmp_path / "a.data", DATA, **WALLS)
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


def test_which_frame_was_read_is_said(tmp_path):
    """A dump has no end: cut between two frames it is whole, and its last frame is an earlier one."""
    assert build(tmp_path / "a.dump", DUMP).frame == "2 of 2, time step 7"
    cut = DUMP[: DUMP.index("ITEM: TIMESTEP\n7")]
    assert build(tmp_path / "b.dump", cut).frame == "1 of 1, time step 0"
    file = {"kind": "file", "path": str(tmp_path / "a.dump")}
    result = gr.solve(Scene.from_dict({"packing": file, "protocol": {"time_step": "auto"}, "loads": []}))
    result.save(tmp_path / "result.nc")
    assert re.search(r"packing frame +2 of 2, time step 7\s", succeeded("show", tmp_path / "result.nc"))
    with pytest.raises(SceneError, match=r"line 2: 'x': must be the number of the time step"):
        build(tmp_path / "a.dump", DUMP.replace("TIMESTEP\n0", "TIMESTEP\nx"))


def test_lammps_dump_begins_without_atoms_where_disks_are_poured(tmp_path):
    empty = DUMP.replace("ATOMS\n1", "ATOMS\n0").replace("1 1 0.5 0.5 0 0.5\n", "")
    np.testing.assert_array_equal(build(tmp_path / "a.dump", empty).position, build(tmp_path / "b.dump", DUMP).position)
    with pytest.raises(SceneError, match="holds 0 of 0 atoms in its last frame"):
        build(tmp_path / "a.dump", empty[: empty.index("ITEM: TIMESTEP\n7")])


def test_lammps_dump_says_what_the_sides_are(tmp_path):
    text = DUMP.replace("ff pp ff", "pp pp ff").replace("1 0.1 0", "1 1.1 0").replace("2 0.4 0", "2 -0.6 0")
    packing = build(tmp_path / "a.dump", text, sides="periodic")
    np.testing.assert_allclose(packing.position * 1.25, [[1, 1], [4, 1.5]])
    assert packing.periodic and packing.width * 1.25 == pytest.approx(10)
    with pytest.raises(SceneError, match=r"'periodic': must be walls, the box of '.*' is not periodic in x$"):
        build(tmp_path / "a.dump", DUMP, sides="periodic")
    text, box = DUMP.replace(" ff pp ff", ""), {"width": 10.0, "origin": (-5.0, 2.0)}  # a file without flags
    for sides in ("walls", "periodic"):
        packing = build(tmp_path / "a.dump", text, sides=sides, **box)
        assert packing.periodic == (sides == "periodic")
        np.testing.assert_allclose(packing.position * 1.25, [[1, 1], [4, 1.5]])
    with pytest.raises(SceneError, match=r"^packing\.width = null: must be given, and origin .* a dump without flags"):
        build(tmp_path / "a.dump", text)


@pytest.mark.parametrize(("name", "text", "last"), [("a.data", DATA, 3), ("a.dump", DUMP, 2)])
def test_lammps_disks_are_in_the_order_of_their_ids(tmp_path, name, text, last):
    """LAMMPS writes them in any order, and loads name them by their place."""
    lines = text.splitlines(keepends=True)
    first = max(k for k, line in enumerate(lines) if "Atoms" in line or "ITEM: ATOMS" in line) + 1
    first += not lines[first].strip()
    rows = lines[first : first + last]
    walls = WALLS if name == "a.data" else {}
    ordered = build(tmp_path / name, text, **walls)
    shuffled = build(tmp_path / name, "".join([*lines[:first], *rows[::-1], *lines[first + last :]]), **walls)
    np.testing.assert_array_equal(shuffled.position, ordered.position)
    np.testing.assert_array_equal(shuffled.radius, ordered.radius)
    np.testing.assert_array_equal(shuffled.mass, ordered.mass)
    bad = "".join([*lines[:first], *rows[::-1], *lines[first + last :]]).replace(rows[0], "1" + rows[0])
    far = build(tmp_path / name, bad.replace("\n1 0 0 0", "\n11 0 0 0"), **walls)  # 11 comes after 2
    np.testing.assert_array_equal(far.position, np.roll(ordered.position, -1, axis=0))


HEADER = "ITEM: ATOMS id xs yu z diameter mass"
#: Files that cannot be read, with what is said of each.
MARK = "# granular-response: 2 disks, width 9.0, sides walls\n"
MISTAKES = [
    # rows that would be lost
    ("a.dump", DUMP + "3 0.6 0 3.0 2.0 1.0\n", "line 19: holds 3 of 2 atoms in its last frame"),
    ("a.dump", DUMP.replace("1 1 0.5", "2 1 0.2 0.2 0 0.1\n1 1 0.5"), "line 9: holds 2 of 1 atoms in its frame 1 of 2"),
    ("a.dump", DUMP.replace("ATOMS\n2", "ATOMS\n0_2"), "line 14: '0_2': must be the number of atoms"),
    ("a.dump", DUMP.replace("ff pp ff", "ff qq ff").replace("ff ff pp", "ff qq pp"), "and have flags of three axes or"),
    ("a.data", DATA + "4 0 0 0 0 0 0\n", "section Velocities has 4 lines, must have 3, as the header atoms says"),
    ("a.data", DATA.replace("\nVelocities\n", ""), "as many atoms as it says (found 6)"),
    ("a.data", DATA.replace("3 atoms", "0_3 atoms"), "line 3: '0_3 atoms': is no header of a LAMMPS data file"),
    ("a.data", DATA + "\nDisks\n\n1 1\n", "line 26: 'Disks': is no section that atoms of style sphere have"),
    ("a.csv", 'x,z,radius,note\n1,1,1,a\n3,1,1,"big\n5,1,1,c\n7,1,1,d\n',
     "line 3: is not CSV: a quote that is not closed in its line"),
    ("a.csv", '#,"a comment\nx,z,radius\n1,1,1\n#,"\n1_0,1,1\n', "line 5: x = '1_0': must be a finite number"),
    # tables that say a thing twice
    ("a.dump", DUMP.replace("id xs", "id xs xs").replace("0.1 0", "0.1 0.2 0").replace("0.4 0", "0.4 0.4 0"),
     "line 19: column xs is given 2 times, as columns 2 and 3; must be given once"),
    ("a.dump", DUMP.replace("id xs", "id x xs").replace("0.1 0", "1 0.1 0").replace("0.4 0", "-1 0.4 0"),
     "line 20: columns x and xs contradict each other; must agree, or be one of the two"),
    ("a.dump", DUMP.replace("diameter", "radius diameter").replace("2.0 1.0", "1 2.0 1").replace("3.0 5.0", "1 3.0 5"),
     "line 21: columns radius and diameter contradict each other; must agree, or be one of the two"),
    ("a.dump", DUMP.replace("r mass", "r density mass").replace("2.0 1.0", "2 1 1").replace("3.0 5.0", "3 1 5"),
     "line 19: columns mass and density: must have one of them"),
    ("a.dump", DUMP + HEADER + "\n1 0.1 0 3.0 2.0 1.0\n2 0.4 0 3.5 3.0 5.0\n",
     "line 22: ITEM: ATOMS: is given twice in a frame, in line 19 and here"),
    ("a.data", DATA.replace("3 atoms", "2 atoms\n3 atoms"), "line 4: atoms: is given twice, in line 3 and here"),
    ("a.data", DATA.replace("-5.0 5.0 ylo yhi", "0 9 xlo xhi"),
     "line 7: bounds in x: is given twice, in line 6 and here"),
    ("a.data", DATA + DATA[DATA.index("Atoms") :], "line 25: section Atoms: is given twice, in line 14 and here"),
    ("a.data", DATA.replace("made by hand", "granular-response: 3 disks, width 8.0, sides walls"),
     "line 1: says width 8.0, the bounds xlo xhi 10.0 to 20.0; must agree"),
    ("a.csv", "x,z,radius\n1,1,1\nx,z,radius\n3,1,1\n", "line 3: header: is given twice, in line 1 and here"),
    ("a.csv", "x,z,radius,diameter\n1,1,1,2\n3,1,1,4\n", "line 3: columns radius and diameter contradict each other"),
    ("a.csv", "x,z,radius,R\n1,1,1,2\n", "column radius stands in radius and R, header must name x, z and radius"),
    ("a.csv", "x,y,z,radius\n1,1,1,1\n3,2,2,1\n", "disks must lie in one plane, y or z must be the same for all"),
    ("a.csv", "# granular-response: 1 disks, width 9.0, sides walls\nx,z,radius,99\n1,1,1,5\n",
     "column mass is missing, which tables of granular-response have"),
    ("a.csv", "# granular-response: 2 disks, width 9.0, si1 0 1 1\n3 0 1 1\n",
     "line 1: is a damaged first line of a table of granular-response"),
    ("a.csv", "x,z,radius\n1,1,1\n# a note\u20283,1,1\n", "line 3: has a line or page end of another kind within"),
    ("a.csv", "x,z,radius,vx,vx\n1,1,1,0,5\n", "line 1: column vx is given 2 times, must be given once"),
    ("a.data", DATA.replace("\n3 0 0 0", "\n4 0 0 0"), "line 24: id = '4': must be that of an atom, section"),
    ("a.data", DATA.replace("1 atom types", "2 atom types").replace("1 1.0\n", "1 1.0\n1 2.0\n"),
     "line 13: 1 in section Masses: is given twice, in line 12 and here"),
    # tables of several frames, of tracked disks, and without a header
    ("a.csv", "x,z,radius,image\n1,1,1,a.png\n3,1,1,b.png\n3,1,1,b.png\n", "line 2: image = 'a.png': must be a finite"),
    ("a.csv", "x,z,radius,t\n1,1,1,0\n3,1,1,1\n", "column t: each disk has another one; a table must have"),
    ("a.csv", "x,z,radius,trackid\n1,1,1,7\n3,1,1,7\n", "line 3: trackid '7': is given twice, in line 2 and here"),
    ("a.csv", "x,z,radius,mass,ecc\n1,1,1,300,0\n", "column mass: is a brightness where disks are tracked, as column "
     "ecc shows; must have a unit, as mass [g], or packing.columns = {mass: mass} says that it is one"),
    ("a.csv", "x,z,radius,mass,particle\n1,1,1,300,0\n", "column mass: is a brightness where disks are tracked"),
    ("a.csv", "1,1,1\n3,1,1\n", "the first line has numbers alone, must be a header that names x, z and radius"),
    ("a.csv", "x\tz\tradius\n1\t1\t1\n", "columns are separated by blanks or tabs, must be separated by commas"),
    ("a.csv", "pos,height,size\n1,1,1\n", "are missing, header must name x, z and radius; there are pos, height, size; "
     "packing.columns says which are meant, as {z: Y, radius: R}"),
    ("a.csv", "secret;a b\n", "columns x, z and radius are missing, header must name x, z and radius"),
    # files of another kind than their name says
    ("a.csv", DUMP, "is of format lammps-dump by its content, not csv: packing.format says so"),
    ("a.dump", "x,z,radius\n1,1,1\n", "is of format csv by its content, not lammps-dump"),
    ("a.dump", "---\ncreator: LAMMPS\ntimestep: 0\n", "is a LAMMPS dump of style yaml, must be one of style custom"),
    ("a.csv", '2\nLattice="1 0 0 0 1 0 0 0 1"\nX 1 1\n', "is a file of extended XYZ, which is written and not read"),
    ("a.dump", DUMP.replace("NUMBER OF ATOMS", "NUMBER OF ENTRIES"), "but of contacts, which packing.springs takes"),
    # files that are not whole
    ("a.data", DATA.replace("3 atoms", "4 atoms"), "is not a whole LAMMPS data file"),
    ("a.data", DATA[:-1], "is cut: its last line has no end"),
    ("a.dump", DUMP[: DUMP.rindex("ITEM: BOX")], "the last frame lacks its number, box or atoms"),
    ("a.dump", DUMP[:-1], "is cut: its last line has no end"),
    ("a.dump", DUMP[:-20], "holds 1 of 2 atoms in its last frame"),
    ("a.dump", LATE_BOX, "line 7: must be followed by three lines of bounds, and have flags of three axes or none"),
    ("a.gsd", "not a gsd file", "is not a GSD file with particles"),
    ("a.csv", "x,z,radius\n", "has no disks, must have a header x,z,radius and a line for each disk"),
    ("a.csv", MARK + "x,z,radius,mass\n1,1,1,1\n3,1,1,1", "is cut: its last line has no end"),
    ("a.csv", "x,z,radius\n1,1,1\n3,1\n", "line 3: has 2 values, must have 3 as the header"),
    # columns that are missing, unknown or a key's
    ("a.csv", "x,z,radius,k_n\n1,1,1,5\n", "column k_n: must be left out, contact.normal_stiffness is"),
    ("a.csv", "x,z,radius,mass,density\n1,1,1,5,1\n", "columns mass and density: must have one of them"),
    ("a.csv", f"x,z,radius,weight\n{TWO}", "column weight: unknown, did you mean mass? (mass or density, or neither)"),
    ("a.csv", f"x [mm],z [mm],radius [cm],mass\n{TWO}", "columns x, z and radius: must have the same unit of length, "
     "not mm, mm, cm; convert them in the table"),
    ("a.csv", "x;z;radius\n1,5;2;1\n", "line 2: x = '1,5': must be a finite number with a decimal point, not a comma"),
    ("a.csv", "x_mm,z_mm,radius\n1,1,1\n", "the same unit of length, not mm, mm, none; "),
    ("a.csv", "x_left,z_mm,r_mm\n1,1,1\n", "column x is missing"),
    ("a.dump", DUMP.replace("diameter", "size"), "line 19: column radius or diameter is missing; there are id, xs"),
    ("a.data", DATA.replace("# sphere", "# atomic"), "line 14: atoms must be of style sphere"),
    # values that cannot be, and those that leave no digits for the others
    ("a.csv", "x,z,radius\n1,1,1\nnan,1,1\n", "line 3: x = 'nan': must be a finite number"),
    ("a.data", DATA.replace("3 1 1.0", "1 1 1.0"), "line 18: id = 1: must differ from that of line 16"),
    ("a.dump", DUMP.replace("2 0.4", "2.5 0.4"), "line 21: id = '2.5': must be a whole number"),
    ("a.csv", "x,z,radius\n1,1,1\n3,1,1\n1,1,2\n", "line 4: disk is in the same place as that of line 2"),
    ("a.csv", "x,z,radius\n1,-1,1\n", "line 2: z = -1.0: must be above the floor 0, which packing.origin says"),
    ("a.csv", f"{ONE}1e300,1,1,1\n", "reach from 0 to 1e+300, packing.origin says where left wall and floor are"),
    ("a.csv", f"{ONE}4,1e300,1,1\n", "z = 1e+300: must be at most 1e+09, 1e9 mean radii"),
    ("a.csv", f"{ONE}4,1,1,1e-7\n", "line 3: mass = 1e-07: must be at least 1e-06, a millionth of the largest"),
    ("a.csv", f"{ONE}4,1,1e-4,1\n", "line 3: radius = 0.0001: must be at least 0.001, a thousandth of the largest"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "said"), MISTAKES)
def test_files_that_cannot_be_read_are_refused(tmp_path, name, text, said):
    with pytest.raises(SceneError) as caught:
        build(tmp_path / name, text, **({"width": 9.0} if name not in ("a.data", "a.dump") else {}))
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_what_is_said_twice_alike_is_taken(tmp_path):
    text = DUMP.replace("id xs yu z diameter", "id x xs yu z radius diameter")
    text = text.replace("1 0.1 0 3.0", "1 -4 0.1 0 3.0 1.0").replace("2 0.4 0 3.5", "2 -1.00001 0.4 0 3.5 1.5")
    plain = build(tmp_path / "b.dump", DUMP)
    np.testing.assert_allclose(build(tmp_path / "a.dump", text).position, plain.position, atol=1e-4)
    text = "x,y,z,radius,diameter\n1,1,0,1,2\n3,1.5,0,1,2\n"  # a camera's plane
    np.testing.assert_allclose(build(tmp_path / "a.csv", text, width=9.0).position, [[1, 1], [3, 1.5]])


FRAMES = "x,z,radius,{}\n1,1,1,8\n3,1,1,8\n2,2.7,1,8\n7,1,1,10\n9,1,1,10\n8,2.7,1,10\n5,1,1,9\n"


@pytest.mark.parametrize(
    "column",
    ["frame", "Frame No.", "time", "t_s", "STEP", "timestep", "POSITION_T", "frame#", "snapshot", "tap", "run"],
)
def test_of_a_table_of_frames_the_last_one_is_taken_and_said(tmp_path, column):
    """Both frames were one packing."""
    with pytest.warns(UserWarning, match=r"a\.csv: has several frames; taken is 3 of 3, .* 10$"):
        packing = build(tmp_path / "a.csv", FRAMES.format(column), width=12.0)
    np.testing.assert_allclose(packing.position, [[7, 1], [9, 1], [8, 2.7]])
    assert packing.frame.startswith("3 of 3, ")


def test_of_several_runs_of_frames_one_packing_is_taken(tmp_path):
    """The last frames of all runs were one packing; a time of each disk is none of a frame."""
    rows = "".join(f"{x + run},1,1,{frame},{run},{x}\n" for run in (0, 10) for frame in (5, 6) for x in (1, 3))
    with pytest.warns(UserWarning, match="taken is 2 of 2, run 10; of these 2 of 2, frame 6$"):
        packing = build(tmp_path / "a.csv", f"x,z,radius,frame,run,t\n{rows}", width=20.0)
    np.testing.assert_allclose(packing.position, [[11, 1], [13, 1]])


def test_heights_that_point_down_are_asked_about_and_turned(tmp_path):
    text, turned = "x_px,y_px,r_px\n20,90,10\n40,85,10\n", {"z": "-y_px"}
    with pytest.warns(UserWarning, match=r"column y is taken as the height; where it points down, .* \{z: -y\} and"):
        build(tmp_path / "a.csv", text, width=90.0)
    with warnings.catch_warnings(action="error"):
        packing = build(tmp_path / "a.csv", text, width=90.0, columns=turned, origin=(0.0, -100.0))
        assert build(tmp_path / "a.csv", text, width=90.0, columns={"z": "y"}).position[0, 1] == 9.0
    np.testing.assert_allclose(packing.position, [[2, 1], [4, 1.5]])
    refuses(SceneError, r"radius = '-r_px': there is no such", build, tmp_path / "a.csv", columns={"radius": "-r_px"})


@pytest.mark.parametrize("name", ["a.csv", "a.dump.gz", "a.data", "a.gsd"])
def test_packed_files_are_named_as_what_they_are(tmp_path, name):
    """The message went by chance of the bytes."""
    packed = {
        "(gzip)": gzip.compress(DUMP.encode()), "zip archive": b"PK\x03\x04", "UTF-16": DUMP.encode("utf-16"),
        "netCDF": b"\x89HDF\r\n\x1a\n", "Git LFS": b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n",
        "web page": b"<!DOCTYPE html>\n<title>404</title>\n", "JSON": b'{"x": [1, 3]}',
        "binary": DUMP.encode("utf-16-le"), "style xyz": b"2\nAtoms. Timestep: 0\n",
        "style yaml": b"# poured\ntimestep: 0\nnatoms: 2\n",
    }  # fmt: skip
    for said, content in packed.items():
        (tmp_path / name).write_bytes(content)
        refuses(SceneError, rf"{name}': is .*{re.escape(said)}", build, tmp_path / name)


CAMERA, TRACKED = "9,1,1,1\n8,3,1.5,1\n", "1,1,1,1,0\n3,1,1,3,0\n"
#: Places in mean radii.
OF_TWO, OF_CAMERA, OF_TRACKED = [[2 / 3, 2 / 3], [8 / 3, 2 / 3]], [[1, 1], [3, 1.5]], [[1, 1], [3, 1]]
#: Tables, keys of the scene for their columns, places, and masses in proportion.
TABLES = [
    (f"x,z,radius,density\n{TWO}", None, OF_TWO, [1, 12]),
    (f"X,Z,Radius,Mass\n{TWO}", None, OF_TWO, [1, 3]),
    (f"x [mm], z [mm], radius[mm], MASS [g]\n{TWO}", None, OF_TWO, [1, 3]),
    (f"x,z,radius,mass\n{TWO}".replace(",", ";"), None, OF_TWO, [1, 3]),
    (f"x_mm,z_mm,r_mm,mass_g\n{TWO}".replace(",", ";"), None, OF_TWO, [1, 3]),
    (f"X_UM,Z [µm],radius_μm,density_kg_m3\n{TWO}", None, OF_TWO, [1, 12]),
    (f"x,z,radius,mass [g],frame\n{TRACKED}", None, OF_TRACKED, [1, 3]),
    (f"x,z,radius,mass,signal\n{TRACKED}", {"mass": "mass"}, OF_TRACKED, [1, 3]),
    (f"id,X [mm],Y [mm],R [mm]\n{CAMERA}", None, OF_CAMERA, [1, 1]),
    ("id,x,y,d\n9,1,1,2\n8,3,1.5,2\n", None, OF_CAMERA, [1, 1]),
    (f"id,x,height,size\n{CAMERA}", {"z": "Height", "radius": "size"}, OF_CAMERA, [1, 1]),
    (f"z,x,y,radius\n{CAMERA}", {"z": "y"}, OF_CAMERA, [1, 1]),
    (f"radius,X,up,R\n{CAMERA}", {"radius": "R", "z": "up"}, OF_CAMERA, [1, 1]),
    ("x_mm,x,z,radius,radius_mm\n9,1,1,1,9\n", None, [[1, 1]], [1]),  # a name without a unit comes first
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("text", "columns", "places", "mass"), TABLES)
def test_columns_as_programs_cameras_and_scenes_name_them(tmp_path, text, columns, places, mass):
    packing = build(tmp_path / "a.csv", text, width=9.0, columns=columns)
    np.testing.assert_allclose(packing.position, places)
    np.testing.assert_allclose(packing.mass, np.array(mass) / np.mean(mass))
    np.testing.assert_allclose(packing.inertia, 0.5 * packing.mass * packing.radius**2)
    scene = Scene.from_dict({"packing": {"kind": "file", "path": "a.csv", "width": 9, "columns": columns}})
    assert Scene.from_text(scene.to_yaml()) == scene and ("columns" in scene.to_yaml()) == (columns is not None)


def test_columns_that_are_not_there_are_named(tmp_path):
    (tmp_path / "a.csv").write_text("x,Y,y,r\n1,5,1,1\n")

    def built(columns):
        given = {"packing": {"kind": "file", "path": "a.csv", "width": 9, "columns": columns}, "loads": []}
        return Scene.from_dict(given, folder=tmp_path).packing.build().position.tolist()

    assert built({"x": "x", "z": "y"}) == [[1.0, 1.0]]
    said = r"columns\.z = 'up': there is no such column; there are x, Y, y, r; packing\.columns says"
    refuses(SceneError, said, built, {"z": "up"})
    for columns in ({"z": "y", "x": "y"}, {"z": "-y", "x": "y"}, {"height": "y"}, {"z": ""}, {}, ["y"]):
        refuses(SceneError, r"packing\.columns = ", built, columns)
    with pytest.raises(SceneError, match=r"^columns = .*format lammps-dump says what its columns are$"):
        FilePacking(path="a.dump", columns={"z": "y"})


def gsd_frame(lift=0.0, box=10, **log):
    """Two disks as other programs hand them over."""
    frame = pytest.importorskip("gsd.hoomd").Frame()
    frame.configuration.box = [box, 8, 0, 0, 0, 0]
    frame.particles.N = 2
    frame.particles.position = [[-4, -3 + lift, 0], [-1, -2.5 + lift, 0]]
    frame.particles.diameter = [2, 3]
    frame.log = {name: np.asarray(value) for name, value in log.items()}
    return frame


def written(path, *frames):
    with pytest.importorskip("gsd.hoomd").open(str(path), "w") as file:
        for frame in frames:
            file.append(frame)
    return path


def test_gsd_of_others_has_its_origin_in_the_middle(tmp_path):
    written(tmp_path / "a.gsd", gsd_frame())
    packing = build(tmp_path / "a.gsd", width=10.0, origin=(-5.0, -4.0))
    np.testing.assert_allclose(packing.position * 1.25, [[1, 1], [4, 1.5]])
    assert packing.width * 1.25 == 10 and packing.given_mass.tolist() == [1.0, 1.0]
    refuses(SceneError, r"width = null: must be given, and origin .* a GSD file does not", build, tmp_path / "a.gsd")
    periodic = build(tmp_path / "a.gsd", sides="periodic", origin=(-5.0, -4.0))  # the box of the format is a period
    np.testing.assert_allclose(periodic.position * 1.25, [[1, 1], [4, 1.5]])
    with pytest.raises(SceneError, match=r"^packing\.origin = null: must be given as \[left wall, floor\]"):
        build(tmp_path / "a.gsd", sides="periodic")


def test_a_table_is_read_and_rescaled(tmp_path):
    packing = build(tmp_path / "a.csv", "x,z,radius\n5,5,3\n15,5,5\n10,12,7\n", width=20.0)
    np.testing.assert_allclose(packing.position, [[1.0, 1.0], [3.0, 1.0], [2.0, 2.4]])
    np.testing.assert_allclose(packing.radius, [0.6, 1.0, 1.4])
    assert packing.width == 4.0 and packing.given_mass is None and packing.mass.mean() == pytest.approx(1.0)
    assert packing.left is None and packing.neighbour_pairs() is None and len(packing.row_count) == 0
    assert packing.n == 3 and list(packing.row) == [-1, -1, -1] and packing.position.flags.c_contiguous
    text = "\ufeff# lengths in mm\n\nid, radius ,z,x\n a, 1.0, 2.0, 3.0\n\n# the second\nb,1,2,5e0\n,,,\n"
    np.testing.assert_allclose(build(tmp_path / "b.csv", text, width=10.0).position, [[3.0, 2.0], [5.0, 2.0]])


def test_a_packing_in_two_scenes_is_read_where_each_is(tmp_path):
    for folder, count in (("a", 2), ("b", 3)):
        (tmp_path / folder).mkdir()
        rows = "".join(f"{2 * k + 1},1,1\n" for k in range(count))
        (tmp_path / folder / "disks.csv").write_text(f"x,z,radius\n{rows}")
    shared = Scene.from_dict({"packing": {"kind": "file", "path": "disks.csv", "width": 10.0}, "loads": []}).packing
    scenes = [Scene.from_dict({"packing": shared, "loads": []}, folder=tmp_path / folder) for folder in "ab"]
    assert [scene.packing.build().n for scene in scenes] == [2, 3] and shared.folder is None


def test_files_that_cannot_be_opened_and_those_that_say_too_little(tmp_path):
    (tmp_path / "a.csv").write_bytes(b"x,z,radius\n\xff,1,1")
    (tmp_path / "b.csv").write_text("x,z,radius\n1,1,1\n")
    for path, said in (
        ("nowhere.csv", r"^packing\.path = 'nowhere\.csv': no such file$"),
        (tmp_path, "cannot be read: "),
        (tmp_path / "a.csv", r"is not a text file in UTF-8$"),
        (tmp_path / "b.csv", r"packing\.width = null: must be given, the file has no box"),
    ):
        refuses(SceneError, said, build, path)
    with pytest.raises(SceneError, match=r"packing\.format = 'vtk': must be csv or lammps-data or"):
        Scene.from_dict({"packing": {"kind": "file", "path": "a", "format": "vtk"}})


def test_periodic_sides_take_any_place(tmp_path):
    text = "x,z,radius\n-1,1,1\n3,1,1\n10,1,1\n"
    packing = build(tmp_path / "a.csv", text, width=8.0, sides="periodic")
    np.testing.assert_allclose(packing.position[:, 0], [7, 3, 2])
    assert packing.box.periodic
    refuses(SceneError, r"line 2: x = -1.0: must be between the side walls", build, tmp_path / "a.csv", text, width=8.0)


def floor_of(packing: dict, **changes) -> np.ndarray:
    """Floor response under a force on the first disk of the upper row."""
    load = {"disk": 3, "force": [0, -1]}
    result = gr.solve({"packing": packing, "contact": {"friction": 0}, "loads": [load], **changes})
    return result.floor_response.values[-1]


def test_a_box_that_follows_the_disks_is_not_their_walls():
    """Bounds s of LAMMPS were taken for walls, and the response was [1.0003, -0.0003]."""
    packing = {"kind": "file", "path": str(PACKINGS / "shrink_wrapped.dump")}
    assert refuses(SceneError, None, gr.solve, {"packing": packing, "loads": []}) == (
        "packing.width = null: must be given, and origin as [left wall, floor] in coordinates of the file, the bounds "
        "are ss in x and ss in y, those of walls and a floor ff (pp) and f"
    )
    with pytest.raises(SceneError, match=r"^packing\.origin = null: must be given as"):
        gr.solve({"packing": {**packing, "width": 6}, "loads": []})
    expected = [0.5084, 0.4834, 0.0082]  # LAMMPS
    np.testing.assert_allclose(floor_of({**packing, "width": 6, "origin": [0, 0]}), expected, atol=3e-3)
    table = {"kind": "file", "path": str(PACKINGS / "shrink_wrapped.csv"), "width": 6}
    np.testing.assert_allclose(floor_of(table), expected, atol=3e-4)


@pytest.mark.parametrize(
    ("flags", "key"),
    [
        ("ss ff pp", "width"), ("fm ff pp", "width"), ("mm ff pp", "width"), ("ff pp pp", "origin"),
        ("ff sf pp", "origin"), ("ff ms pp", "origin"), ("ff fs pp", None), ("pp ff pp", "sides"),
    ],
)  # fmt: skip
def test_only_fixed_bounds_are_walls(tmp_path, flags, key):
    text = DUMP[: DUMP.index("ITEM: TIMESTEP\n7")].replace("ff ff pp", flags)
    if key is None:  # what is above the disks does not matter
        assert build(tmp_path / "a.dump", text).n == 1
        return
    refuses(SceneError, rf"^packing\.{key} = ", build, tmp_path / "a.dump", text)


TILTED = "ITEM: BOX BOUNDS xy xz yz pp ff pp\n0 6 0\n0 10 0\n-1 1 0\n"


def test_boxes_of_newer_lammps_are_read_where_they_are_upright(tmp_path):
    text = (PACKINGS / "general_box.dump").read_text()
    plain = build(tmp_path / "a.dump", text, sides="periodic")
    assert plain.periodic and plain.width == 6
    np.testing.assert_allclose(plain.position, [[1, 1], [3, 1], [5, 1], [2, 2.75], [4, 2.75]])
    box = text[text.index("ITEM: BOX") : text.index("ITEM: ATOMS")]
    tilted = build(tmp_path / "a.dump", text.replace(box, TILTED), sides="periodic")
    np.testing.assert_array_equal(tilted.position, plain.position)
    for turned in (text.replace("6 0 0 0", "6 1 0 0"), text.replace(box, TILTED.replace("0 6 0", "0 6 1.5"))):
        with pytest.raises(SceneError, match=r"line 6: the box must not be tilted or turned"):
            build(tmp_path / "a.dump", turned, sides="periodic")
    upright = DATA.replace(
        "10.0 20.0 xlo xhi\n-5.0 5.0 ylo yhi\n-1.0 1.0 zlo zhi", "10 0 0 avec\n0 10 0 bvec\n0 0 2 cvec"
    )
    upright = upright.replace("cvec\n", "cvec\n10.0 -5.0 -1.0 abc origin\n")
    given = {"sides": "periodic", "origin": (10.0, -5.0)}
    np.testing.assert_array_equal(
        build(tmp_path / "a.data", upright, **given).position, build(tmp_path / "b.data", DATA, **given).position
    )
    with pytest.raises(SceneError, match=r"line 7: the box must not be tilted or turned"):
        build(tmp_path / "a.data", upright.replace("0 10 0 bvec", "1 10 0 bvec"), **given)


@pytest.mark.parametrize(
    ("column", "mass"),
    [("mass", (1, 5)), ("rmass", (1, 5)), ("Mass", (1, 5)), ("c_mass", (1, 5)), ("v_mass", (1, 5)),
     ("f_mass[1]", (1, 5)), ("d_mass", (1, 5)), ("density", (8, 135)), ("c_density", (8, 135))],
)  # fmt: skip
def test_masses_of_a_dump_by_any_of_their_names(tmp_path, column, mass):
    packing = build(tmp_path / "a.dump", DUMP.replace("diameter mass", f"diameter {column}"))
    np.testing.assert_allclose(packing.mass, np.array(mass) / np.mean(mass))


def test_a_dump_without_masses_says_what_is_taken(tmp_path):
    text = DUMP.replace("diameter mass", "diameter vx")
    with pytest.warns(UserWarning, match=r"a\.dump: has no masses; taken as those of one material"):
        packing = build(tmp_path / "a.dump", text)
    np.testing.assert_allclose(packing.mass, np.array([4, 9]) / 6.5)
    with pytest.raises(SceneError, match=r"line 19: columns 'c_mass', 'v_mass': must have one of them"):
        build(tmp_path / "a.dump", DUMP.replace("z diameter mass", "z diameter c_mass v_mass")
              .replace("3.0 2.0 1.0", "3.0 2.0 1.0 1.0").replace("3.5 3.0 5.0", "3.5 3.0 5.0 5.0"))  # fmt: skip


def test_a_start_deep_inside_others_is_asked_about(tmp_path):
    """Diameters in the place of radii, and walls that are none."""
    (tmp_path / "a.csv").write_text("x,z,radius\n1,1,2\n3,1,2\n5,1,2\n")
    packing = {"kind": "file", "path": "a.csv", "width": 6}
    with pytest.raises(SceneError) as caught:
        solve_scene(Scene.from_dict({"packing": packing, "loads": []}, folder=tmp_path))
    assert str(caught.value) == (
        "packing: disks 0 and 1 (counted from 0) overlap by 1 mean radii at the start, must be at most 0.5, half the "
        "smaller radius; are radii diameters, and walls and floor where they should be? For measured disks "
        "packing.overlaps: removed takes overlaps of up to a radius out"
    )
    (tmp_path / "a.csv").write_text("x,z,radius\n0.4,1,1\n3,1,1\n5,1,1\n")
    with pytest.raises(SceneError, match=r"^packing: disk 0 and the left wall \(counted from 0\) overlap by 0\.6 mean"):
        solve_scene(Scene.from_dict({"packing": packing, "loads": []}, folder=tmp_path))
    (tmp_path / "a.csv").write_text("x,z,radius\n0.51,1,1\n3,1,1\n5,1,1\n")
    assert solve_scene(Scene.from_dict({"packing": packing, "loads": []}, folder=tmp_path)).rest.certificate.stable
    lattice = {"kind": "slab", "layers": 3, "disks_per_row": 5, "polydispersity": 0.9}
    with pytest.raises(SceneError, match=r"take lattice_constant touching-largest or less polydispersity$"):
        solve_scene(Scene.from_dict({"packing": lattice, "loads": []}))


def test_gsd_takes_from_the_first_frame_what_the_last_one_leaves_out(tmp_path):
    """As the library of the format does."""
    hoomd = pytest.importorskip("gsd.hoomd")
    frames = [gsd_frame(lift) for lift in (0.0, 0.25)]
    for frame in frames:
        frame.particles.mass = [4, 1]
        frame.log["note"] = "a text"  # values of a kind that no disk has
    written(tmp_path / "a.gsd", *frames)
    with hoomd.open(str(tmp_path / "a.gsd"), "r") as file:
        expected = file[1].particles
        assert not file.file.chunk_exists(frame=1, name="particles/mass")
    table = formats.read(tmp_path / "a.gsd", "gsd")
    assert table.frame == "2 of 2"
    np.testing.assert_array_equal(table.radius, 0.5 * expected.diameter)
    np.testing.assert_array_equal(table.mass, expected.mass)
    np.testing.assert_array_equal(np.column_stack([table.x, table.z]), expected.position[:, :2])


@pytest.mark.filterwarnings("ignore:.*read again")
@pytest.mark.parametrize("damaged", [b"particles/masr", b"qarticles/mass"])
def test_a_damaged_name_of_a_gsd_file_is_no_missing_chunk(results, tmp_path, damaged):
    """Masses that stood under it were taken as 1, and the last positions as the first."""
    content = export(results / "walls.nc", tmp_path / "a.gsd").read_bytes()
    (tmp_path / "a.gsd").write_bytes(content.replace(b"particles/mass", damaged))
    refuses(SceneError, "its list of names has one that the format does not have", build, tmp_path / "a.gsd")
    (tmp_path / "a.gsd").write_bytes(content + b"\0")
    refuses(SceneError, r"its parts end at byte \d+, it has \d+$", build, tmp_path / "a.gsd")


def test_velocities_with_a_unit_are_not_taken_for_reduced_ones(tmp_path):
    (tmp_path / "a.csv").write_text("x,z,radius,vx [mm/s]\n1,1,1,40\n")
    packing = {"kind": "file", "path": "a.csv", "width": 9}
    scene = Scene.from_dict({"packing": packing, "motion": {"vx": "column"}, "loads": []}, folder=tmp_path)
    with pytest.raises(SceneError, match=r"^motion\.vx = 'column': must be .* a column vx in reduced units$"):
        scene.motion.of(scene.packing.build())
