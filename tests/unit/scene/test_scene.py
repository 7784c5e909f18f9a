"""A scene's defaults, derived values, updates and way to YAML and back."""

import pickle

import pytest

from granular_response.scene import (
    Contact,
    Load,
    PilePacking,
    Protocol,
    RowSelector,
    Scene,
    SceneError,
    SlabPacking,
    Wall,
)
from granular_response.scene.protocol import PAPERS_TIME_STEP


def test_defaults_are_the_papers():
    scene = Scene()
    assert scene.packing == SlabPacking(layers=15, disks_per_row=61, polydispersity=0.0, lattice_constant=2.0)
    assert scene.contact == Contact(normal_stiffness=3000.0, stiffness_ratio=0.8, friction=0.2, damping_ratio=0.5)
    assert scene.resolved_wall == Contact(normal_stiffness=6000.0, stiffness_ratio=0.8, friction=0.0, damping_ratio=0.5)
    assert scene.loads == (Load(disk="top-centre", force=(0.0, -15.0), torque=0.0),)
    protocol = scene.protocol
    assert (protocol.integrator, protocol.stop_kinetic_energy) == ("beeman", 1e-13)
    assert protocol.time_step is None and PAPERS_TIME_STEP == 5e-4
    assert scene.preparation.gravity == "at-once"
    assert Scene.from_text("{}") == scene


def test_wall_follows_the_contacts_unless_told():
    contact = Contact(normal_stiffness=1000.0, stiffness_ratio=0.5, friction=0.9, damping_ratio=0.1)
    assert Wall(friction=0.3).resolved(contact) == Contact(
        normal_stiffness=2000.0, stiffness_ratio=0.5, friction=0.3, damping_ratio=0.1
    )
    own = Wall(normal_stiffness=7.0, stiffness_ratio=0.0, friction=0.1, damping_ratio=0.0)
    assert own.resolved(contact) == Contact(normal_stiffness=7.0, stiffness_ratio=0.0, friction=0.1, damping_ratio=0.0)


def test_text_is_complete_and_exact():
    scene = Scene(
        contact=Contact(friction=0.1 + 0.2, normal_stiffness=1e5 / 3),
        protocol=Protocol(stop_kinetic_energy=1e-13),
        loads=[Load(disk=RowSelector(row="top", offset=-3), force=(1 / 3, -5e-324), torque=-0.0)],
    )
    text = scene.to_yaml()
    assert Scene.from_text(text) == scene
    assert Scene.from_text(text).to_yaml() == text
    assert Scene.from_dict(scene.to_dict()) == scene
    written = Scene().to_dict()
    assert list(written) == ["packing", "contact", "wall", "loads", "preparation", "protocol"]
    assert set(written["protocol"]) == set(Protocol.model_fields)


@pytest.mark.parametrize("number", ["1e-13", "1E-13", "1.0e-13", ".1e-12", "0.0000000000001", "+1e-13"])
def test_numbers_as_people_write_them(number):
    scene = Scene.from_text(f"protocol: {{stop_kinetic_energy: {number}}}")
    assert scene.protocol.stop_kinetic_energy == 1e-13


@pytest.mark.parametrize(
    "changes",
    [
        {"contact": {"stiffness_ratio": 0.5}, "contact.friction": 1.0},
        {"contact.friction": 1.0, "contact": {"stiffness_ratio": 0.5}},
        {"contact": {"friction": 1.0, "stiffness_ratio": 0.5}},
        {"contact.stiffness_ratio": 0.5, "contact.friction": 1.0},
    ],
)
def test_updated_never_resets_what_it_does_not_name(changes):
    scene = Scene(contact={"normal_stiffness": 1e4, "stiffness_ratio": 0.3}, packing=SlabPacking(layers=7))
    assert scene.updated(changes).contact == Contact(normal_stiffness=1e4, stiffness_ratio=0.5, friction=1.0)
    assert scene.updated({"packing": {"disks_per_row": 9}}).packing == SlabPacking(layers=7, disks_per_row=9)
    assert scene.updated({"wall": {"friction": 0.5}}).wall == Wall(friction=0.5)
    torque = scene.updated({"loads.0.force": [0.0, -4.0], "loads[0].torque": 2.0})
    assert torque.loads == (Load(disk="top-centre", force=(0.0, -4.0), torque=2.0),)
    torque = scene.updated({"loads.0": {"torque": 1.0}})
    assert torque.loads == (Load(disk="top-centre", force=(0.0, -15.0), torque=1.0),)
    row = scene.updated({"loads.0.disk": {"row": "top"}}).updated({"loads.0.disk.offset": 2})
    assert row.loads[0].disk == RowSelector(row="top", offset=2)


def test_a_packing_of_another_kind_and_a_description_replace_what_is_there():
    scene = Scene(packing=SlabPacking(layers=7, polydispersity=0.1), contact=Contact(friction=1.0))
    assert scene.updated({"packing": {"kind": "pile"}}).packing == PilePacking()
    assert scene.updated({"packing.layers": 5, "packing.kind": "pile"}).packing == PilePacking(layers=5)
    assert scene.updated({"packing.layers": 5, "packing": PilePacking()}).packing == PilePacking(layers=5)
    assert scene.updated({"contact": Contact(stiffness_ratio=0.5)}).contact == Contact(stiffness_ratio=0.5)
    assert scene.updated({"loads": []}).loads == ()
    assert scene.updated({"loads": scene.loads * 2}).loads == scene.loads * 2
    # a wall that was left open follows the new contacts
    assert scene.updated({"contact.normal_stiffness": 1e4}).resolved_wall.normal_stiffness == 2e4
    assert scene == Scene(packing=SlabPacking(layers=7, polydispersity=0.1), contact=Contact(friction=1.0))


def test_file_packing_belongs_to_the_folder_of_its_scene(tmp_path):
    (tmp_path / "disks.csv").write_text("x,z,radius\n1,1,1\n")
    (tmp_path / "scene.yaml").write_text("packing: {kind: file, path: disks.csv, width: 4}\nloads: []\n")
    scene = Scene.from_yaml(tmp_path / "scene.yaml")
    assert scene.folder == str(tmp_path)
    assert "disks.csv" in scene.to_yaml() and str(tmp_path) not in scene.to_yaml()
    for other in (
        scene.updated({"contact.friction": 0.0}),
        Scene.from_text(scene.to_yaml(), folder=scene.folder),
        pickle.loads(pickle.dumps(scene)),
        Scene(packing=scene.packing),
        Scene(loads=[]).updated({"packing": scene.packing}),
    ):
        assert other.packing == scene.packing
        assert other.packing.build().n == 1
    with pytest.raises(SceneError, match="no such file"):
        Scene.from_text(scene.to_yaml()).packing.build()
