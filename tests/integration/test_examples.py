"""Every scene of ``examples/`` is solved, and the tables there are what their scripts make."""

import ast
import runpy
from pathlib import Path

import pytest
from places import ROOT

from granular_response.scene import Scene
from granular_response.solvers.solution import solve_scene
from granular_response.store.result import to_dataset

EXAMPLES = ROOT / "examples"
#: The slabs of the examples are cut to this size here.
SMALL = {"layers": 5, "disks_per_row": 15}


def small(path: Path) -> Scene:
    scene = Scene.from_yaml(path)
    match scene.packing.kind:
        case "slab":
            return scene.updated({f"packing.{key}": value for key, value in SMALL.items()})
        case "pile":
            return scene.updated({"packing.layers": 5})
    return scene


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_an_example_comes_to_a_certified_equilibrium(path):
    scene = Scene.from_yaml(path)
    assert Scene.from_text(scene.to_yaml(), folder=scene.folder) == scene and scene.packing.build().n > 1
    result = to_dataset(solve_scene(small(path)))
    assert result.attrs["stable"] == "yes"
    assert result.attrs["settled"] == "yes"
    assert float(result["certificate_force_residual"].max()) < 1e-8
    assert float(result["certificate_torque_residual"].max()) < 1e-8
    assert float(result["certificate_coulomb_excess"].max()) < 1e-8
    # the floor bears the weight, and what the loads push down; only frictionless side walls bear nothing of it
    friction = Scene.from_text(result.attrs["scene"], folder=EXAMPLES).wall.friction
    if friction == 0.0:
        assert float(result["floor_force_rest"].sum()) == pytest.approx(float(result["mass"].sum()), abs=1e-8)
        if result.sizes["state"] > 1:
            down = -float(result["applied_load"].sel(component="force_z").sum())
            added = float((result["floor_response"].sum("floor_disk") * result["total_force"]).isel(load=0))
            assert added == pytest.approx(down, abs=1e-8)


def internal(script: Path) -> list[str]:
    """Modules of the package that a script imports beside the package itself."""
    nodes = list(ast.walk(ast.parse(script.read_text(encoding="utf-8"))))
    names = [alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)]
    return [name for name in names if name.startswith("granular_response") and name != "granular_response"]


@pytest.mark.parametrize("script", sorted(EXAMPLES.rglob("*.py")), ids=lambda path: path.stem)
def test_an_example_uses_public_names_only(script):
    assert internal(script) == []


def test_the_starts_of_a_disordered_slab_differ_as_the_notes_say():
    example = runpy.run_path(str(EXAMPLES / "two_starts.py"))
    table = example["compare"](example["scene"](0.01, layers=8, disks_per_row=21), 3, workers=1)
    literal, touching = (table[start] for start in example["STARTS"])
    horizontal, oblique = (f"{kind} contacts over those of the lattice" for kind in ("horizontal", "oblique"))
    assert touching[horizontal][0] < 0.6 * literal[horizontal][0]
    assert touching[oblique][0] > literal[oblique][0]
    assert touching["coordination number"][0] < literal["coordination number"][0]
    assert all(row["response"][0].shape == example["X"].shape for row in table.values())
