"""The pipelines of the collections: made from folders and imports, and what their stages read is what they name."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from places import ROOT
from refusals import refuses

from granular_response.scene import SceneError
from granular_response.store import files as store
from granular_response_paper.pipeline import drawing, imports, reproduce, simulation, stages
from granular_response_paper.registry import PAPER, Collection, GroupError, collection_of, collections

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # in C, where PyYAML has it: every process reads these files
COLLECTIONS = collections()
KINDS = ("simulate", "draw")


def test_the_walk_finds_imports_through_packages():
    modules = imports.closure(["granular_response.cli.main"])
    assert {"granular_response", "granular_response.store.files", "granular_response.store.atomic"} <= modules
    assert "granular_response.scene.errors" in modules  # imported by its package, inside a command
    assert "granular_response.plot.style" not in imports.closure(["granular_response.kernels"])


def test_the_paper_imports_nothing_of_the_extensions():
    modules = [one for group in PAPER.groups for kind in KINDS for one in stages.starts(PAPER, kind, group)]
    found = imports.closure([*modules, *stages.judging(PAPER), "granular_response_paper.cli"])
    assert {name.partition(".")[0] for name in found} == {"granular_response", "granular_response_paper"}


@pytest.mark.parametrize("collection", COLLECTIONS, ids=lambda one: one.name)
def test_the_pipeline_in_git_is_the_one_that_is_made(collection):
    path = ROOT / collection.folder / stages.FILE
    assert path.read_text() == stages.document(collection, ROOT), "granular-response-paper stages"


@pytest.mark.parametrize("collection", COLLECTIONS, ids=lambda one: one.name)
def test_folders_parameters_and_lock_have_the_same_groups(collection):
    base = ROOT / collection.folder
    given = yaml.load((base / "params.yaml").read_text(), LOADER)
    assert set(given) == {"common", *collection.groups}
    for group in collection.groups:
        found, described = simulation.parameters(group, base / "params.yaml")
        assert set(given[group]) <= set(found) <= set(type(described).model_fields)
    # DVC keeps what it once wrote of a stage that is gone, and reads it around every other stage.
    locked = set(re.findall(r"^  ([\w@]+):$", (base / "dvc.lock").read_text(), re.M))
    assert locked == set(reproduce.stage_names(collection, ROOT))
    # no stage depends on the package of a group, which DVC would say of each empty one
    assert not [group for group in collection.groups if (collection.path / group / "__init__.py").read_text()]


def test_a_lock_is_empty_while_every_stage_runs(tmp_path):
    """At the end it has the stages of the pipeline in its order: also those that did not run, and none that is gone."""
    lock, names = tmp_path / "dvc.lock", ["simulate@a", "simulate@b", "draw@a", "draw@b"]
    one = "  {}:\n    cmd: {}\n    outs:\n    - path: {}\n".format
    head = "schema: '2.0'\nstages:\n"
    before = head + one("draw@b", "old", "d") + one("gone", "old", "g") + one("simulate@a", "old", "a")
    lock.write_text(before)
    with reproduce.emptied(lock, ()):
        assert lock.read_text() == before
    with reproduce.emptied(lock, names):
        assert not lock.exists()
    assert lock.read_text() == head + one("simulate@a", "old", "a") + one("draw@b", "old", "d")
    with pytest.raises(KeyboardInterrupt), reproduce.emptied(lock, names):
        lock.write_text(head + one("draw@a", "new", "x") + one("simulate@a", "new", "y"))
        raise KeyboardInterrupt
    assert lock.read_text() == head + one("simulate@a", "new", "y") + one("draw@a", "new", "x") + one(
        "draw@b", "old", "d"
    )


def test_a_misspelt_group_names_the_right_one_and_where_it_lives(tmp_path):
    with pytest.raises(GroupError, match=r"^hystresis: no such figure group, did you mean hysteresis \(the ext"):
        collection_of("hystresis")
    (tmp_path / "params.yaml").write_text("common: {method: auto}\n")
    with pytest.raises(GroupError, match=r"is a figure group of the extensions, run it in the folder extensions"):
        simulation.parameters("hysteresis", tmp_path / "params.yaml")


def test_an_experiment_changes_exactly_the_value_that_it_names(tmp_path):
    """What ``dvc exp run -S`` does to the file, and what the group makes of it."""
    hydra = pytest.importorskip("dvc.utils.hydra")
    path = tmp_path / "params.yaml"
    path.write_text((ROOT / "params.yaml").read_text())
    _, before = simulation.parameters("pile_dip", path)
    hydra.apply_overrides(path, ["pile_dip.scene.contact.friction=0.5"])
    _, after = simulation.parameters("pile_dip", path)
    assert after == before.model_copy(update={"scene": before.scene.updated({"contact.friction": 0.5})}) != before
    hydra.apply_overrides(path, ["+pile_dip.scene.contact.normal_stiffness=1e4", "common.method=dynamics"])
    _, last = simulation.parameters("pile_dip", path)
    assert last.base == after.scene.updated({"contact.normal_stiffness": 1e4, "protocol.method": "dynamics"})
    hydra.apply_overrides(path, ["+pile_dip.scene.contact.fricton=0.5"])
    with pytest.raises(
        SceneError, match=r"pile_dip\.scene\.contact\.fricton = 0\.5: unknown key, did you mean friction"
    ):
        simulation.parameters("pile_dip", path)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("method: auto", "method: quick"), "common.method = 'quick': must be auto"),
        (("method: auto", "metod: auto"), "common.metod = 'auto': unknown key"),
        (("force: 15.0", "force: true"), "sensitivity.force = true: must be a number greater than 0"),
        (("packing: {layers: 15", "packing: {kind: pile, layers: 15"), "sensitivity.scene.packing.kind = 'pile': must"),
        (("friction: [0.2, 1.0]", "friction: 0.2"), "sensitivity.friction = 0.2: must be a list"),
        (("literal_steps: 200000 ", "5: 3 "), "sensitivity.5 = 3: unknown key"),
    ],
)
def test_a_mistake_is_one_line_with_its_key(tmp_path, change, said):
    text = (ROOT / "params.yaml").read_text()
    common, section = (text[text.index(f"{name}:\n") :].split("\n\n")[0] for name in ("common", "sensitivity"))
    assert change[0] in common + section
    path = tmp_path / "params.yaml"
    path.write_text(f"{common}\n\n{section}\n".replace(*change))
    assert refuses(SceneError, None, simulation.parameters, "sensitivity", path).startswith(f"{path}: {said}")


class Clock:
    """Seconds that a test sets."""

    now = 0.0

    def __call__(self):
        return self.now


def test_progress_says_what_is_done_and_scales_the_rest_by_this_machine():
    clock = Clock()
    names = ["simulate@a", "simulate@b", "draw@a", "draw@b"]
    watch = reproduce.Watch(names, {"simulate@a": 10.0, "simulate@b": 30.0, "draw@a": 2.0, "draw@b": 4.0}, clock)
    assert watch.read("Running stage 'simulate@a':\n") == ""
    clock.now = 20.0  # twice as slow as stored
    said = watch.read("Running stage 'simulate@b':\n")
    assert " ".join(said.split()) == "1 of 4 simulate@a 20.0 s 0:20 gone, at most 1:12 to come"
    assert watch.read("> granular-response-paper simulate b\n") == ""
    clock.now = 80.0
    assert "2 of 4  simulate@b" in watch.read("Stage 'draw@a' didn't change, skipping\n")
    assert watch.taken == {"simulate@a": 20.0, "simulate@b": 60.0, "draw@a": 0.0}
    assert watch.rest() == "1:20 gone, at most 0:08 to come"


def small_collection(folder: Path, monkeypatch) -> Collection:
    """A package with one figure group, installed from ``folder``."""
    package = folder / "src" / "small_collection"
    for file, content in recipe().items():
        (package / "example" / file).parent.mkdir(parents=True, exist_ok=True)
        (package / "example" / file).write_text(content)
    (package / "__init__.py").touch()
    monkeypatch.syspath_prepend(folder / "src")
    return Collection("small", "small_collection", ".", "a small collection")


def recipe() -> dict[str, str]:
    """The files of a figure group as docs/extending.md writes them."""
    page = (ROOT / "docs" / "extending.md").read_text()
    section = page.split("## A figure group")[1].split("\n## ")[0]
    file = r"^`([\w/]+\.(?:py|yaml))`(?:(?!```).)*?```(?:python|yaml)\n(.*?)```"
    found = dict(re.findall(file, section, re.S | re.M))
    own = ("granular_response_paper.groups.example", "small_collection.example")
    return {name: block.replace(*own) for name, block in found.items()}


def test_a_group_made_by_the_recipe_runs(tmp_path, monkeypatch):
    """docs/extending.md, file by file: one folder and one section of params.yaml."""
    small = small_collection(tmp_path, monkeypatch)
    registry = sys.modules["granular_response_paper.registry"]
    monkeypatch.setattr(registry, "collections", lambda: (*COLLECTIONS, small))
    (tmp_path / "params.yaml").write_text(recipe()["reduced.yaml"])
    monkeypatch.chdir(tmp_path)
    assert small.groups == ("example",)
    assert simulation.simulate("example", workers=1) == Path("data/example.nc")
    assert Path("figures/example/example.png") in drawing.draw("example")
    response = store.read("data/example.nc")["response"]["floor_response"].values
    assert response.shape == (2, 13) and abs(response.sum(axis=1) - 1.0).max() < 0.2


def test_a_stage_that_fails_is_shown_and_ends_the_run(tmp_path):
    """A pipeline of two stages, run by the command that `make reproduce` runs."""
    (tmp_path / "dvc.yaml").write_text("stages: {claims: {cmd: 'true'}, report: {cmd: 'echo the reason && false'}}\n")
    environment = os.environ | {"GIT_CEILING_DIRECTORIES": str(tmp_path.parent)}
    subprocess.run([sys.executable, "-m", "dvc", "init", "--no-scm", "-q"], cwd=tmp_path, env=environment, check=True)
    said = []
    empty = Collection("empty", "granular_response_paper.pipeline", ".", "nothing")
    assert reproduce.reproduce(empty, tmp_path, say=said.append) != 0
    assert any("claims" in line for line in said) and "the reason" in said[-1]
