"""Packings that go on with the springs of their contacts: our tables, dumps of LAMMPS, and a script for it."""

import re
import shutil
import subprocess
import warnings
from dataclasses import replace

import numpy as np
import pytest
from places import DATA
from refusals import refuses

import granular_response as gr
from granular_response.solvers.problem import Problem
from granular_response.state import LEFT_WALL, RIGHT_WALL, Contacts
from granular_response.store.export.lammps import NoCounterpart, winding

#: 16 disks that a load has pushed about and left: some contacts slide, between disks and on the floor.
SCENE = gr.Scene(
    packing=gr.Poured(disks=16, width=11.0, sizes=[1.0, 1.4]),
    contact=gr.Contact(friction=0.2),
    wall=gr.Wall(friction=0.15),
    loads=[gr.Load(disk="top-centre", force=(1.0, -4.0))],
    protocol=gr.Protocol(load_factors=[1.0, 0.0]),
)
LAWS = {"contact": {"friction": 0.2}, "wall": {"friction": 0.15}, "loads": []}
#: What LAMMPS of 22 Jul 2025 wrote of the last state after 736,739 steps (tests/data/README.md).
DUMP, ENTRIES = (DATA / "packings" / f"springs.{ending}" for ending in ("dump", "contacts.dump"))


@pytest.fixture(scope="module")
def result() -> gr.Result:
    found = gr.solve(SCENE, progress=False)
    assert found.loaded[-1].pairs.sliding.any() and found.loaded[-1].walls.sliding.any()
    return found


@pytest.fixture(scope="module")
def tables(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        result.export(folder / "disks.csv")
    result.export(folder / "disks.contacts.csv")
    return folder


def given(path="disks.csv", springs="disks.contacts.csv", folder=None, **changes) -> gr.Scene:
    packing = {"kind": "file", "path": str(path), "springs": str(springs)}
    return gr.Scene.from_dict({**LAWS, "packing": packing}, folder=folder).updated(changes)


def check_at_rest(again: gr.Result, state: gr.State, *, within: float) -> None:
    """The equilibrium is where the disks were given, with the same contacts and forces."""
    assert np.abs(again.rest.position - state.position).max() <= within
    for mine, theirs in ((again.rest.pairs, state.pairs), (again.rest.walls, state.walls)):
        found, wanted = (
            {(i, j): f for i, j, f in zip(c.first, c.second, c.tangential_force, strict=True) if f}
            for c in (mine, theirs)
        )
        assert found.keys() == wanted.keys()
        np.testing.assert_allclose([found[pair] for pair in wanted], list(wanted.values()), rtol=0, atol=1e-9)


def test_a_packing_that_left_with_its_springs_comes_back_at_rest(result, tables):
    state = result.loaded[-1]
    again = gr.solve(given(folder=tables), progress=False)
    check_at_rest(again, state, within=1e-10)
    assert again.certificate.stable and gr.Scene.from_text(again.scene.to_yaml(), folder=tables) == again.scene
    limit = again.rest.pairs.near_limit(0.2, 1e-9)
    assert limit.sum() == state.pairs.near_limit(0.2, 1e-9).sum() > 0
    anew = gr.solve({**LAWS, "packing": {"kind": "file", "path": str(tables / "disks.csv")}}, progress=False)
    assert np.abs(anew.rest.position - state.position).max() > 1e-5  # without springs it is another equilibrium


@pytest.mark.parametrize("cause", ["load", "law"])
def test_springs_of_disks_that_are_not_at_rest_are_no_secret(result, tables, tmp_path, cause):
    state, folder, changes = -1, tables, {"contact.normal_stiffness": 1000.0}
    if cause == "load":
        state, folder, changes = 1, tmp_path, {}
        with pytest.warns(UserWarning, match="contacts begin anew"):
            result.export(tmp_path / "disks.csv", state=state)
        result.export(tmp_path / "disks.contacts.csv", state=state)
    with pytest.warns(UserWarning, match=r"^disk \d+ comes to rest .*: with packing.springs disks must be at rest"):
        again = gr.solve(given(folder=folder, **changes), progress=False)
    given_places = (result.rest, *result.loaded)[state].position
    assert np.abs(again.rest.position - given_places).max() > 1e-4


def test_a_motion_begins_with_the_springs(tables):
    times = [0.0, 0.05, 5.0]
    moved = gr.motion(given(folder=tables), times, progress=False)
    assert moved["kinetic_energy"].max() < 1e-20
    bare = {**LAWS, "packing": {"kind": "file", "path": str(tables / "disks.csv")}}
    assert gr.motion(bare, times, progress=False)["kinetic_energy"].max() > 1e-10


def test_rolling_springs_come_back_too(tmp_path):
    rolling = {"rolling_friction": 0.05, "rolling_stiffness_ratio": 0.2}
    laws = {"contact": {"friction": 0.3, **rolling}, "wall": {"friction": 0.3, **rolling}, "loads": []}
    slab = {"kind": "slab", "layers": 3, "disks_per_row": 5, "polydispersity": 0.1}
    first = gr.solve({**laws, "packing": slab}, progress=False)
    assert first.rest.pairs.rolling_spring.any()
    with pytest.warns(UserWarning, match="contacts begin anew"):
        first.export(tmp_path / "disks.csv")
    first.export(tmp_path / "disks.contacts.csv")
    scene = given(folder=tmp_path).to_dict() | laws
    again = gr.solve(gr.Scene.from_dict(scene, folder=tmp_path), progress=False)
    check_at_rest(again, first.rest, within=1e-10)
    np.testing.assert_allclose(
        np.sort(again.rest.pairs.rolling_force), np.sort(first.rest.pairs.rolling_force), atol=1e-9
    )


def scaled(text: str, first: int, factors: list[float]) -> str:
    """The rows of a dump from a line on, with columns in other units."""
    lines = text.splitlines()
    rows = [
        " ".join(
            word if factor == 1.0 else repr(factor * float(word))
            for word, factor in zip(row.split(), factors, strict=True)
        )
        for row in lines[first:]
    ]
    return "\n".join([*lines[:first], *rows]) + "\n"


def test_dumps_of_lammps_come_back_at_rest(tmp_path):
    """In its units whatever they are: here lengths of 1 cm, masses of 3 and forces of 7."""
    found = gr.solve(given(DUMP, ENTRIES), progress=False)
    state = found.rest
    written = np.array([row.split()[2:4] for row in DUMP.read_text().splitlines()[9:]], float)
    assert np.abs(state.position - written).max() <= 1e-10 and found.certificate.stable
    between = [row.split() for row in ENTRIES.read_text().splitlines()[9:]]
    pairs = {tuple(sorted((int(one[0]) - 1, int(one[1]) - 1))): np.hypot(*map(float, one[3:5])) for one in between}
    kept = state.pairs.touching
    forces = np.abs(state.pairs.tangential_force[kept])
    bodies = zip(state.pairs.first[kept].tolist(), state.pairs.second[kept].tolist(), strict=True)
    assert {tuple(sorted(two)) for two in bodies} == pairs.keys() and len(pairs) == 20
    np.testing.assert_allclose(np.sort(forces), np.sort([*pairs.values()]), rtol=0, atol=1e-9)
    box = "ITEM: BOX BOUNDS ff fs pp\n0 0.11\n0 0.06\n-0.1 0.1\n"
    atoms = re.sub(r"ITEM: BOX.*\n.*\n.*\n.*\n", box, DUMP.read_text())
    length, mass, force = 0.01, 3.0, 7.0
    columns = [1.0, 1.0, *[length] * 4, mass, *[1.0] * 3, *[force] * 4]
    (tmp_path / "a.dump").write_text(scaled(atoms, 9, columns))
    (tmp_path / "b.dump").write_text(scaled(ENTRIES.read_text(), 9, [1.0, 1.0, *[force] * 4]))
    check_at_rest(gr.solve(given("a.dump", "b.dump", tmp_path), progress=False), state, within=1e-10)


def test_motion_of_a_script_stretches_all_springs(result):
    """Slip by the definition of each contact, on the states at rest and under load."""
    radius = result.to_dataset()["radius"].values
    for state in (result.rest, *result.loaded):
        move, turn = (lambda found: (found[:2].T, found[2]))(winding(state, radius))
        for contacts, normals in ((state.pairs, state.pair_normal()), (state.walls, None)):
            for k in np.flatnonzero(contacts.touching):
                i, j = contacts.first[k], contacts.second[k]
                nx, nz = normals[k] if normals is not None else {LEFT_WALL: (1, 0), RIGHT_WALL: (-1, 0)}.get(j, (0, 1))
                relative, rims = move[i].copy(), radius[i] * turn[i]
                if normals is not None:
                    relative, rims = relative - move[j], rims + radius[j] * turn[j]
                slip = relative[1] * nx - relative[0] * nz - rims
                assert slip == pytest.approx(contacts.spring[k], rel=0, abs=1e-15)


def test_springs_that_no_motion_stretches_are_refused(result):
    """Two springs of one contact, of which only one can be what the disk slips by."""
    state, radius = result.rest, result.to_dataset()["radius"].values
    twice = np.r_[np.arange(len(state.walls.first)), np.flatnonzero(state.walls.touching)[0]]
    walls = {name: getattr(state.walls, name)[twice] for name in vars(state.walls)}
    walls["spring"] = walls["spring"] + 1e-3 * (np.arange(len(twice)) == len(twice) - 1)
    with pytest.raises(NoCounterpart, match=r"^no motion of the disks stretches the tangential springs"):
        winding(replace(state, walls=Contacts(**walls)), radius)


def test_a_script_brings_the_springs(result, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is lost
        lines = result.export(tmp_path / "in.lammps", state=-1).read_text().splitlines()
    text = (tmp_path / "in.slip").read_text().split("\n16\n")
    assert len(text) == 3 and all(f"variable {name} atomfile in.slip" in lines for name in ("slipx", "slipy", "turn"))
    order = [lines.index(line) for line in ("run 1", "reset_timestep 0", "fix move all nve/sphere disc")]
    assert order == sorted(order)  # no disk moves while springs are stretched
    assert "variable factor equal 0.0" in lines and lines[-1].startswith("write_dump all custom in.dump")
    smooth = gr.solve(SCENE.updated({"contact.friction": 0.0, "wall.friction": 0.0}), progress=False)
    assert "run 1" not in smooth.export(tmp_path / "smooth.lammps").read_text().splitlines()
    assert not (tmp_path / "smooth.slip").exists()


@pytest.mark.skipif(shutil.which("lmp") is None, reason="LAMMPS is not installed")
def test_lammps_keeps_it_at_rest_and_gives_it_back(result, tmp_path):
    script = result.export(tmp_path / "in.lammps", state=-1)
    script.write_text(re.sub(r"^(variable end equal) \d+$", r"\1 20000", script.read_text(), flags=re.MULTILINE))
    done = subprocess.run(["lmp", "-in", script.name], cwd=tmp_path, capture_output=True, text=True, check=True)
    (start,) = re.findall(r"^ +0 +\S+ +(\S+) *$", done.stdout, re.MULTILINE)[-1:]
    assert float(start) < 1e-10
    check_at_rest(
        gr.solve(given("in.dump", "in.contacts.dump", tmp_path), progress=False), result.loaded[-1], within=1e-10
    )


ROW = re.compile(r"^1,.*\n", re.MULTILINE)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (ROW, "1,0,15,,1.0,1.0,sticking,1.0,0.1\n", "packing.springs: line 3: disks 0 and 15 do not touch"),
        (ROW, lambda row: row[0] * 2, "packing.springs = '.*': line 4: contact of disks .*: is given twice, in line 3"),
        (ROW, "", r"packing.springs: disks \d+ and \d+ overlap by .* mean radii, must be among them"),
        (ROW, "1,0,16,,1.0,1.0,sticking,1.0,0.1\n", ".*: line 3: disk 16: must be another one of the 16 disks"),
        (ROW, "1,3,3,,1.0,1.0,sticking,1.0,0.1\n", ".*: line 3: disk 3: must be another one of the 16 disks"),
        (ROW, "1,0,3,,1.0,1.0,sticking,nan,0.1\n", ".*: line 3: normal_force = 'nan': must be a finite number"),
        (ROW, "1,0,3,,1.0,1.0,sticking,0.0,0.1\n", ".*: line 3: normal force 0.0: must be greater than 0"),
        (ROW, "1,0,,ceiling,1.0,1.0,sticking,1.0,0.1\n", ".*: line 3: wall = 'ceiling': must be floor or left_wall or"),
        (ROW, "1,x,3,,1.0,1.0,sticking,1.0,0.1\n", ".*: line 3: first and second: must be numbers of disks"),
        (ROW, "1,0,3\n", ".*: line 3: has 3 values, must have 9 as the header"),
        (",normal_force", ",force", ".*: line 1: column normal_force is missing, which a .contacts.csv has"),
        (",normal_force", ",nomal_force", ".*: line 1: column nomal_force: unknown, did you mean normal_force[?]$"),
        ("sticking,", "sticking,0.0,", ".*: has 10 values, must have 9"),
        ("tial_force\n", "tial_force,rolling_force,rolling_force\n", ".*: line 1: column rolling_force is given 2"),
        (re.compile(r"\n$"), "", ".*: is cut: its last line has no end"),
    ],
)  # fmt: skip
def test_contacts_that_are_not_those_of_the_packing_are_refused(tables, tmp_path, old, new, said):
    text = (tables / "disks.contacts.csv").read_text()
    text = old.sub(new, text, count=1) if isinstance(old, re.Pattern) else text.replace(old, new)
    (tmp_path / "bad.csv").write_text(text)
    refuses(gr.SceneError, f"^{said}", gr.solve, given(springs=tmp_path / "bad.csv", folder=tables), progress=False)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"contact.friction": 0.0}, r"packing.springs: line \d+: disks .* bear a tangential force, contact.friction"),
        ({"wall.friction": 0.0}, r"packing.springs: line \d+: disk \d+ and the .*, wall.friction must be greater"),
        ({"preparation.gravity": "slow"}, "preparation.gravity = 'slow': must be at-once with packing.springs"),
        ({"packing.overlaps": "removed"}, "packing.overlaps = 'removed': must be kept with springs"),
        ({"packing.springs": 3}, "packing.springs = 3: must be the path of a file"),
        ({"packing.springs": "none.csv"}, "packing.springs = 'none.csv': no such file"),
    ],
)
def test_springs_that_the_scene_cannot_have_are_refused(tables, changes, said):
    refuses(gr.SceneError, f"^{said}", lambda: gr.solve(given(folder=tables, **changes), progress=False))


def test_contacts_beyond_the_limit_are_named(tables):
    with pytest.warns(UserWarning, match=r"^packing.springs: \d+ contacts bear up to 0.2 of the normal .* is 0.1;"):
        Problem.from_scene(given(folder=tables, **{"contact.friction": 0.1})).bare_state()


@pytest.mark.parametrize("column", [None, "roling_force", "Rolling force"])
def test_rolling_forces_that_a_table_of_contacts_has_not_do_not_count_as_zero(tmp_path, column):
    """They were taken as 0 where the column was missing or misspelt: of 0.26 mg 0.11 were left, and no word of it."""
    rolls = {"contact.rolling_friction": 0.1, "contact.rolling_stiffness_ratio": 0.1}
    result = gr.solve(SCENE.updated(rolls), progress=False)
    with warnings.catch_warnings(action="ignore"):
        result.export(tmp_path / "disks.csv")
    table = result.export(tmp_path / "disks.contacts.csv").read_text()
    head, *rows = (line.split(",") for line in table.splitlines())
    at = head.index("rolling_force")
    assert any(float(row[at]) for row in rows)
    if column is None:
        lines = [one[:at] + one[at + 1 :] for one in (head, *rows)]
        said = "have no rolling force there, unlike contact.rolling_friction"
    else:
        lines, said = [[*head[:at], column, *head[at + 1 :]], *rows], "unknown, did you mean rolling_force?"
    (tmp_path / "bad.csv").write_text("".join(",".join(line) + "\n" for line in lines))
    scene = given(springs="bad.csv", folder=tmp_path, **rolls)
    refuses(gr.SceneError, re.escape(said), gr.solve, scene, progress=False)


def test_dumps_that_say_too_little_are_refused(tmp_path):
    def refused(said, disks=DUMP, springs=ENTRIES, **changes):
        refuses(gr.SceneError, said, lambda: gr.solve(given(disks, springs, tmp_path, **changes)))

    entries, disks = ENTRIES.read_text(), DUMP.read_text()
    narrow = entries.replace(" c_bears[4]", "").replace(" -0 \n", "\n")
    for text, said in (
        (narrow, "line 9: must have the six columns patom1 .* p3, not 5$"),
        (entries.replace("\n8 3 ", "\n8 33 "), "line 10: atoms 8 and 33: must be ids of disks$"),
        (entries[: entries[:-1].rindex("\n") + 1], "line 9: holds 19 of 20 entries in its last frame$"),
    ):
        (tmp_path / "a.dump").write_text(text)
        refused(said, springs="a.dump")
    (tmp_path / "b.dump").write_text(disks.replace("f_floor", "f_bottom"))
    refused(r"^packing.springs: disk 0 and the floor overlap by .* be among them$", "b.dump")
    (tmp_path / "b.dump").write_text(disks.replace("ATOMS id", "ATOMS number"))
    refused("calls disks by their ids, so the file of the disks must have ids$", "b.dump")
    rolling = {"contact.rolling_friction": 0.1, "contact.rolling_stiffness_ratio": 0.1}
    refused("line 10: disks 2 and 7 have no rolling force there, unlike contact", **rolling)


BALLS = gr.Scene.from_arrays(
    x=[5.0, 2.0], z=[3.0, 4.0], radius=1.0, width=10.0, vx=[0.5, -1.0], vz=0.25, spin=[2.0, 0.0], scene={"loads": []}
)


def test_velocities_go_to_lammps_and_come_back(tmp_path):
    moved = gr.motion(BALLS, [0.0, 1.0], progress=False)
    lines = gr.export(moved, tmp_path / "in.lammps", state=0).read_text().splitlines()
    assert "fix weight all gravity 1.0 vector 0 -1 0" in lines and "run 1" not in lines
    assert [one for one in lines if one.startswith("timestep")] == [f"timestep {moved.attrs['time_step']!r}"]
    rows = (tmp_path / "in.data").read_text().split("Velocities # sphere\n\n")[1].splitlines()
    assert rows == ["1 0.5 0.25 0.0 0.0 0.0 2.0", "2 -1.0 0.25 0.0 0.0 0.0 0.0"]
    columns = dict.fromkeys(("vx", "vz", "spin"), "column")
    back = {"packing": {"kind": "file", "path": "in.data", "width": 10.0, "origin": [0.0, 0.0]}, "motion": columns}
    again = gr.motion(gr.Scene.from_dict({**back, "loads": []}, folder=tmp_path), [0.0, 1.0], progress=False)
    for name in ("position", "velocity", "angular_velocity"):
        np.testing.assert_array_equal(again[name], moved[name])
    with pytest.warns(UserWarning, match="a motion has no springs of contacts: those that are closed begin anew"):
        later = gr.export(moved, tmp_path / "later.data")
    assert float(later.read_text().split("\n")[-3].split()[2]) == moved["velocity"].values[-1, 0, 1] < 0.0
    pushed = BALLS.updated({"loads": [gr.Load(disk="top-centre", force=(1.0, 0.0))]})
    started = gr.motion(pushed, [0.0, 0.5, 5.0], progress=False)
    assert started["velocity"].values[1, 0, 0] > 0.5  # the load is on the first disk
    with pytest.warns(UserWarning, match="begin anew"):
        script = gr.export(started, tmp_path / "in.lammps", state=2).read_text()
    assert "group loaded0 id 1\n" in script  # a quarter of the ramp is over
    steps = round(15.0 / started.attrs["time_step"])  # the rest of the ramp, with the step of the motion
    assert f"variable factor equal 0.25+(0.75)*((step<{steps})*step/{steps}+(step>={steps}))\n" in script
    weightless = gr.motion(BALLS.updated({"motion.weightless": True}), [0.0], progress=False)
    assert "gravity" not in gr.export(weightless, tmp_path / "in.lammps").read_text()
    with pytest.raises(gr.ExportError, match=r"a.xyz: a motion has no contacts, must be .csv or .data or"):
        gr.export(moved, tmp_path / "a.xyz")
    for wrong in (moved.isel(time=0), BALLS, moved["energy"]):
        with pytest.raises(gr.ExportError, match="must be written of a result, its file or dataset, or of what"):
            gr.export(wrong, tmp_path / "a.data")


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("1 0.5 0.25 0.0 0.0 0.0 2.0", "1 fast 0.25 0.0 0.0 0.0 2.0", "line 17: vx = 'fast': must be a finite number"),
        ("1 0.5 0.25 0.0 0.0 0.0 2.0", "1 0.5 0.25 0.0", "line 17: has 4 values, must have id vx vy vz wx wy wz"),
    ],
)
def test_velocities_that_are_none_are_refused(tmp_path, old, new, said):
    path = gr.export(gr.motion(BALLS, [0.0], progress=False), tmp_path / "a.data")
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    refuses(gr.SceneError, f"a.data': {said}", gr.File(path=str(path), width=10.0, origin=(0.0, 0.0)).build)


@pytest.mark.parametrize(("axes", "spin", "sign"), [("x y z", "omegaz", 1.0), ("x z y", "omegay", -1.0)])
def test_velocities_of_a_dump_are_read_in_either_plane(tmp_path, axes, spin, sign):
    up = axes.split()[1]
    head = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n" + "0 9\n" * 3
    rows = "1 2 1 0 1 1 0.5 -0.25 3\n2 6 2 0 1 1 0 0 0\n"
    (tmp_path / "a.dump").write_text(f"{head}ITEM: ATOMS id {axes} radius mass vx v{up} {spin}\n{rows}")
    columns = gr.File(path=str(tmp_path / "a.dump")).build().columns
    assert columns["vx"].tolist() == [0.5, 0.0] and columns["vz"].tolist() == [-0.25, 0.0]
    assert columns["spin"].tolist() == [3.0 * sign, 0.0]
