"""Every malformed scene file is one line: the key, the value and what is allowed."""

import pytest
from refusals import refusals, refuses

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Contact, Load, Scene, SceneError, SlabPacking

SCENE_KEYS = "packing, contact, wall, loads, preparation, protocol, motion"
KINDS = "slab or pile or poured or file or arrays"
RATIO = "must be a number from 0 to 1e6"

MALFORMED = {
    # Not YAML, or not a mapping.
    "": "the scene is empty, must be a mapping ({} is the paper's scene)",
    "contact: {friction: 0.2": "line 1, column 24: not valid YAML: expected ',' or '}', but got '<stream end>'",
    "contact: {friction: 1}\ncontact: {friction: 2}": "line 2, column 1: not valid YAML: key 'contact' is given twice",
    "contact: !!python/object:os.system {}": (
        "line 1, column 10: not valid YAML: tag 'tag:yaml.org,2002:python/object:os.system' is not allowed"
    ),
    # Unknown keys.
    "contacts: {}": f"contacts = {{}}: unknown key, did you mean contact? (allowed: {SCENE_KEYS})",
    "loads: [{disk: 0, force: [0, -1], torqe: 1}]": (
        "loads[0].torqe = 1: unknown key, did you mean torque? (allowed: disk, force, displacement, torque)"
    ),
    # Wrong types and values out of range.
    "contact: {normal_stiffness: -3000}": (
        "contact.normal_stiffness = -3000: must be a number greater than 0, at most 1e12"
    ),
    "contact: {normal_stiffness: 6e11}": (
        "contact.normal_stiffness = 600000000000.0: "
        "must be at most 5e11 where wall.normal_stiffness, twice as much, is left open"
    ),
    "contact: {damping_ratio: .nan}": f"contact.damping_ratio = nan: {RATIO}",
    "contact: {friction: true}": f"contact.friction = true: {RATIO}",
    "contact: {friction: -1, damping_ratio: -1}": f"contact.friction = -1: {RATIO} (and 1 more mistake)",
    # Packings.
    "packing: {kind: slub}": f"packing.kind = 'slub': must be {KINDS}, did you mean slab?",
    "packing: {kind: slab, layers: 100000, disks_per_row: 100000}": (
        "packing.layers = '9999950000 disks': must have at most 100000000 disks"
    ),
    # Loads.
    "loads: [{disk: 0, force: [0, -1, 0]}]": "loads[0].force = [0, -1, 0]: must be two finite numbers [x, z]",
    "loads: [{disk: 0, force: [0, 0]}, {disk: 908, force: [0, 0]}]": (
        "loads[1].disk = 908: must be from 0 to 907, the packing has 908 disks"
    ),
    "loads: [{disk: {row: 1, offset: 31}, force: [0, 0]}]": (
        "loads[0].disk.offset = 31: must be from -29 to 30, row 1 has 60 disks"
    ),
    "loads: [{disk: 0}]": "loads[0].force = null: must be given, or displacement or torque",
    "loads: [{disk: 0, displacement: [null, null]}]": (
        "loads[0].displacement = [None, None]: must hold a direction at least"
    ),
    "loads: [{disk: 0, force: [0.0, -1.0], displacement: [null, -1.0]}]": (
        "loads[0].force = [0.0, -1.0]: must be 0 along z, where displacement holds the disk"
    ),
    "packing: {kind: slab, sides: periodic, disks_per_row: 4}": (
        "packing.disks_per_row = 4: must be at least 5 with periodic sides, so that no disk meets another on both sides"
    ),
    # Protocol and preparation.
    "protocol: {integrator: verlett}": (
        f"protocol.integrator = 'verlett': must be {' or '.join(INTEGRATORS)}, did you mean verlet?"
    ),
}


@pytest.mark.parametrize("text", MALFORMED, ids=range(len(MALFORMED)))
def test_malformed_file(text, tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text(text)
    assert refuses(SceneError, None, Scene.from_yaml, path) == f"{path}: {MALFORMED[text]}"


def test_files_that_cannot_be_read(tmp_path):
    refuses(SceneError, r"nowhere\.yaml: no such file$", Scene.from_yaml, tmp_path / "nowhere.yaml")
    refuses(SceneError, "cannot be read", Scene.from_yaml, tmp_path)
    path = tmp_path / "binary.yaml"
    path.write_bytes(b"contact: \xff\xfe")
    refuses(SceneError, r"is not a text file in UTF-8$", Scene.from_yaml, path)
    path.write_bytes(b"contact:\n  friction: \x07")
    refuses(SceneError, r"line 2: not valid YAML: special characters are not allowed$", Scene.from_yaml, path)


def test_hostile_text():
    refuses(SceneError, "nested too deeply", Scene.from_text, "[" * 3_000)
    refuses(SceneError, "is too long", Scene.from_text, f"contact: {{friction: {'9' * 10_000}}}")
    with pytest.raises(SceneError, match=r"^line 1, column 8: not valid YAML: found unconstructable recursive node"):
        Scene.from_text("loads: &a [*a]")
    bomb = "a: &a [x, x]\n" + "".join(
        f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]\n" for old, new in zip("abcdefgh", "bcdefghi", strict=True)
    )
    assert len(refuses(SceneError, None, Scene.from_text, bomb)) < 500


test_constructors_raise_the_same_error = refusals(
    SceneError,
    (lambda: Contact(friction=-1.0), f"^friction = -1.0: {RATIO}$"),
    (lambda: SlabPacking(layers=0), "^layers = 0: "),
    (lambda: Scene(contact={"friction": -1}), r"^contact\.friction = -1: "),
    (lambda: Scene(loads=[Load(disk=2000, force=(0.0, -1.0))]), r"^loads\[0\]\.disk = 2000: must be from 0 to 907"),
)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"contact.fricton": 1.0}, r"^contact\.fricton = 1\.0: unknown key, did you mean friction\?"),
        ({"friction": 1.0}, r"^friction = 1\.0: unknown key, did you mean contact\.friction or wall\.friction\? \("),
        (
            {"loads.force": [0.0, -1.0]},
            r"^loads\.force: loads has 1 items, no item 'force', did you mean loads\.0\.force",
        ),
        ({3: 1.0}, "^3: must be the path of a key"),
        ({"contact.friction": 1.0, "contact": {"friction": 1.0}}, r"^contact: 'friction' is named twice"),
        ({"loads": [], "loads.0.torque": 1.0}, r"^loads\.0\.torque: 'loads' is named twice"),
        ({"packing.layers": 2}, r"^loads\[0\]\.disk = 900: must be from 0 to 120"),
        (
            {"contact.normal_stiffness": "3000 N/m"},
            r"at most 1e12; the unit is mg / mean radius, gr\.LaboratoryUnits converts$",
        ),
        ({"protocol.ramp_time": "2 s"}, r"the unit is sqrt\(R/g\), gr\.LaboratoryUnits converts$"),
    ],
)
def test_updates_are_checked(changes, message):
    scene = Scene(loads=[Load(disk=900, force=(0.0, -1.0))])
    refuses(SceneError, message, scene.updated, changes)
