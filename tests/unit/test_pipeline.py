"""The declared dependencies of every stage against what its modules really import."""

import functools
import json
import re
import sys
from pathlib import Path

import pytest
import yaml
from imported import imported
from places import ROOT, SOURCE

from granular_response.scene import SceneError
from granular_response.store import files as store
from granular_response_paper import groups, pipeline
from granular_response_paper.groups import NAMES
from granular_response_paper.pipeline import drawing, simulation

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # in C, where PyYAML has it: every process reads these files

PIPELINE = yaml.load((ROOT / "dvc.yaml").read_text(), LOADER)["stages"]
GROUPS = json.loads((SOURCE / "granular_response_paper/groups/groups.json").read_text())["groups"]
PARAMETERS = yaml.load((ROOT / "params.yaml").read_text(), LOADER)

SIMULATION = [
    "granular_response_paper.pipeline.simulation",
    *(f"granular_response_paper.groups.{{}}.{module}" for module in ("parameters", "simulate")),
]

#: Modules at which a stage starts; {} is its figure group.
STARTS = {
    "simulate": SIMULATION,
    "draw": [
        "granular_response_paper.pipeline.drawing",
        *(f"granular_response_paper.groups.{{}}.{module}" for module in ("parameters", "draw")),
    ],
    "claims": [
        "granular_response_paper.claims.table",
        *(f"granular_response_paper.groups.{name}.claims" for name in GROUPS),
    ],
    "report": ["granular_response_paper.report"],
}


def starts(kind, group):
    """Modules at which a single stage starts; not every group has claims of a function."""
    modules = [start.format(group) for start in STARTS[kind]]
    return [name for name in modules if file_of(name) or not name.endswith(".claims")]


def groups_of(kind):
    """The groups that have a stage of this kind; None for a stage of all of them."""
    assert PIPELINE[kind].get("foreach", "${groups}") == "${groups}"
    return GROUPS if "foreach" in PIPELINE[kind] else [None]


def stages():
    """Every single stage: its name as DVC has it, its kind, its group and its definition."""
    for kind, definition in PIPELINE.items():
        for group in groups_of(kind):
            template = definition["do"] if group else definition
            yield pytest.param(kind, group, fill(template, group), id=f"{kind}@{group}" if group else kind)


def fill(value, group):
    if isinstance(value, dict):
        return {fill(key, group): fill(entry, group) for key, entry in value.items()}
    if isinstance(value, list):
        return [fill(entry, group) for entry in value]
    if group is None or not isinstance(value, str):
        return value
    return value.replace("${item}", group)


STAGES = list(stages())


def file_of(module: str) -> Path | None:
    base = SOURCE.joinpath(*module.split("."))
    for path in (base / "__init__.py", base.with_suffix(".py")):
        if path.is_file():
            return path
    return None


@functools.cache
def imports(module: str) -> frozenset[str]:
    """Modules of ours that running ``module`` may import."""
    found = imported(file_of(module), for_types=False)
    return frozenset(name for name in found if name.startswith("granular_response") and file_of(name))


def closure(starts: list[str]) -> set[str]:
    """Everything that is imported in the end, with the packages on the way."""
    todo, seen = list(starts), set()
    while todo:
        module = todo.pop()
        if module not in seen:
            seen.add(module)
            todo += imports(module)
            if "." in module:
                todo.append(module.rpartition(".")[0])
    return seen


def imported_files(kind: str, group: str | None) -> set[str]:
    modules = closure(starts(kind, group))
    return {str(file_of(module).relative_to(ROOT)) for module in modules}


def covers(dependency: str, file: str) -> bool:
    return file == dependency or file.startswith(dependency + "/")


def declared_code(definition) -> list[str]:
    return [dependency for dependency in definition["deps"] if dependency.startswith("src/")]


def test_the_walk_finds_imports_through_packages():
    modules = closure(["granular_response.cli.main"])
    assert {"granular_response", "granular_response.store.files", "granular_response.store.atomic"} <= modules
    assert "granular_response.scene.errors" in modules  # imported by its package, inside a command
    assert "granular_response.plot.style" not in closure(["granular_response.kernels"])


@pytest.mark.parametrize(("kind", "group", "definition"), STAGES)
def test_every_imported_module_is_a_dependency(kind, group, definition):
    for start in starts(kind, group):
        assert file_of(start), f"{start} does not exist"
    missing = {
        file
        for file in imported_files(kind, group)
        if not any(covers(dependency, file) for dependency in declared_code(definition))
    }
    assert not missing


@pytest.mark.parametrize("kind", PIPELINE)
def test_every_dependency_is_imported_by_some_group(kind):
    """One list serves all groups of a kind, so a module may be needed by one of them only."""
    groups = groups_of(kind)
    files = set().union(*(imported_files(kind, group) for group in groups if group_exists(kind, group)))
    template = PIPELINE[kind].get("do", PIPELINE[kind])
    needless = [
        dependency
        for group in groups
        if group_exists(kind, group)
        for dependency in declared_code(fill(template, group))
        if not any(covers(dependency, file) for file in files)
    ]
    assert not needless


def group_exists(kind: str, group: str | None) -> bool:
    return all(file_of(start) for start in starts(kind, group))


@pytest.mark.parametrize(("kind", "group", "definition"), STAGES)
def test_dependencies_and_parameters_exist(kind, group, definition):
    for dependency in declared_code(definition):
        assert (ROOT / dependency).exists(), dependency
    for key in definition.get("params", []):
        assert isinstance(PARAMETERS.get(key), dict), f"params.yaml has no section {key}"


@pytest.mark.parametrize(("kind", "group", "definition"), STAGES)
def test_stages_have_the_agreed_form(kind, group, definition):
    if kind == "simulate":
        assert definition["cmd"] == f"granular-response-paper simulate {group}"
        assert definition["outs"] == [f"data/{group}.nc"]
        assert definition["params"] == ["common", group]
    elif kind == "draw":
        assert definition["cmd"] == f"granular-response-paper draw {group}"
        assert definition["outs"] == [{f"figures/{group}": {"cache": False}}]
        assert "params" not in definition
        assert f"data/{group}.nc" in definition["deps"]
    else:  # nothing is written that is not declared: no file named beside the outputs
        assert definition["cmd"] == f"granular-response-paper {kind}"


def test_plots_are_the_pictures_of_all_groups():
    """Each declared file is stored, each stored picture declared: ``dvc plots diff`` shows every group."""
    pictures = [path.relative_to(ROOT).as_posix() for path in sorted(ROOT.glob("figures/*/*.png"))]
    declared = yaml.load((ROOT / "dvc.yaml").read_text(), LOADER)["plots"]
    assert declared == pictures
    assert {path.split("/")[1] for path in declared} == set(NAMES)


def test_what_is_derived_comes_after_the_data_that_it_reads():
    for section in PARAMETERS.values():
        for key in {"survey", "survey_file"} & set(section):
            assert any(covers(dependency, section[key]) for dependency in PIPELINE["simulate"]["do"]["deps"])


def test_the_list_of_groups_is_that_of_the_folders_and_of_the_stages():
    folders = {path.parent.name for path in SOURCE.glob("granular_response_paper/groups/*/__init__.py")}
    assert len(NAMES) == len(set(NAMES)) and set(NAMES) == folders == set(PARAMETERS) - {"common"}
    assert list(NAMES) == GROUPS
    assert all(groups_of(kind) == list(NAMES) for kind in ("simulate", "draw"))
    assert [f"figures/{group}" for group in sorted(NAMES)] == [
        dependency for dependency in PIPELINE["report"]["deps"] if re.fullmatch(r"figures/\w+", dependency)
    ]


@pytest.mark.parametrize("group", NAMES)
def test_every_group_describes_its_section(group):
    given, described = simulation.parameters(group, ROOT / "params.yaml")
    assert set(PARAMETERS[group]) <= set(given) <= set(type(described).model_fields)


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
    with pytest.raises(SceneError) as caught:
        simulation.parameters("sensitivity", path)
    assert str(caught.value).startswith(f"{path}: {said}") and "\n" not in str(caught.value)


def test_the_lock_file_knows_the_stages_and_no_others():
    # DVC keeps what it once wrote of a stage that is gone, and reads it around every other stage.
    locked = set(re.findall(r"^  ([\w@]+):$", (ROOT / "dvc.lock").read_text(), re.M))
    assert locked == {stage.id for stage in STAGES}


def test_dvc_reads_the_pipeline():
    repo = pytest.importorskip("dvc.repo")
    names = {stage.addressing for stage in repo.Repo(ROOT).index.stages}
    assert {f"{kind}@{group}" for kind in ("simulate", "draw") for group in NAMES} <= names


def test_a_group_made_by_the_recipe_runs(tmp_path, monkeypatch):
    """docs/extending.md, file by file."""
    page = (ROOT / "docs" / "extending.md").read_text()
    section = page.split("## A figure group")[1].split("\n## ")[0]
    (yaml_block,) = re.findall(r"```yaml\n(.*?)```", section, re.S)
    folder = tmp_path / "groups" / "example"
    folder.mkdir(parents=True)
    (folder / "simulate").mkdir()
    for file, block in re.findall(r"`(\w+\.py)`(?:(?!```).)*?```python\n(.*?)```", section, re.S):
        (folder / file.replace("__init__", "simulate/__init__")).write_text(block)
    (folder / "__init__.py").touch()
    assert {path.name for path in folder.iterdir()} >= {"parameters.py", "simulate", "draw.py"}
    (tmp_path / "params.yaml").write_text("common: {method: auto}\n" + yaml_block)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(groups, "__path__", [*groups.__path__, str(tmp_path / "groups")])
    monkeypatch.setattr(pipeline, "NAMES", (*NAMES, "example"))
    try:
        assert simulation.simulate("example", workers=1) == Path("data/example.nc")
        assert Path("figures/example/example.png") in drawing.draw("example")
        said = json.loads(Path("figures/example/captions.json").read_text())["example"]
        assert said["caption"].startswith("Floor response per applied force") and "k_T/k_N = 0.8" in said["caption"]
        assert (said["figure"], said["panels"], said["parameters"]["friction"]) == (None, [], [0.0, 0.5])
    finally:
        for name in [name for name in sys.modules if name.startswith("granular_response_paper.groups.example")]:
            del sys.modules[name]
    response = store.read("data/example.nc")["response"]["floor_response"].values
    assert response.shape == (2, 13) and abs(response.sum(axis=1) - 1.0).max() < 0.2
