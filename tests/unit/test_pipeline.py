"""The declared dependencies of every stage against what its modules really import."""

import ast
import functools
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src"

PIPELINE = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
PARAMETERS = yaml.safe_load((ROOT / "params.yaml").read_text())

#: Modules at which a stage starts; {} is its figure group.
STARTS = {
    "simulate": ["granular_response.paper.pipeline.simulation", "granular_response.paper.groups.{}.simulate"],
    "derive": ["granular_response.paper.pipeline.simulation", "granular_response.paper.groups.{}.simulate"],
    "stress": ["granular_response.paper.pipeline.simulation", "granular_response.paper.groups.{}.simulate"],
    "draw": ["granular_response.paper.pipeline.drawing", "granular_response.paper.groups.{}.draw"],
    "claims": ["granular_response.paper.claims"],
    "report": ["granular_response.paper.report"],
}


def stages():
    """Every single stage: its name as DVC has it, its kind, its group and its definition."""
    for kind, definition in PIPELINE.items():
        for group in definition.get("foreach", [None]):
            template = definition["do"] if group else definition
            yield pytest.param(kind, group, fill(template, group), id=f"{kind}@{group}" if group else kind)


def fill(value, group):
    if isinstance(value, dict):
        return {fill(key, group): fill(entry, group) for key, entry in value.items()}
    if isinstance(value, list):
        return [fill(entry, group) for entry in value]
    return value.replace("${item}", str(group)) if isinstance(value, str) else value


STAGES = list(stages())
#: Kinds of stages that store the datasets of a group.
SIMULATING = ("simulate", "derive", "stress")


def file_of(module: str) -> Path | None:
    base = SOURCE.joinpath(*module.split("."))
    for path in (base / "__init__.py", base.with_suffix(".py")):
        if path.is_file():
            return path
    return None


@functools.cache
def imports(module: str) -> frozenset[str]:
    """Modules of ours that running ``module`` may import, wherever in the file the import stands."""
    path = file_of(module)
    package = module if path.name == "__init__.py" else module.rpartition(".")[0]
    found = set()
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):  # what stands there for the type checker alone is never run
        if isinstance(node, ast.If) and ast.unparse(node.test) in ("TYPE_CHECKING", "typing.TYPE_CHECKING"):
            node.body = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parents = package.split(".")
                base = ".".join(parents[: len(parents) - node.level + 1] + ([base] if base else []))
            found.add(base)
            found.update(f"{base}.{alias.name}" for alias in node.names)
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
    modules = closure([start.format(group) for start in STARTS[kind]])
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
    for start in STARTS[kind]:
        assert file_of(start.format(group)), f"{start.format(group)} does not exist"
    missing = {
        file
        for file in imported_files(kind, group)
        if not any(covers(dependency, file) for dependency in declared_code(definition))
    }
    assert not missing


@pytest.mark.parametrize("kind", PIPELINE)
def test_every_dependency_is_imported_by_some_group(kind):
    """One list serves all groups of a kind, so a module may be needed by one of them only."""
    groups = PIPELINE[kind].get("foreach", [None])
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
    return all(file_of(start.format(group)) for start in STARTS[kind])


@pytest.mark.parametrize(("kind", "group", "definition"), STAGES)
def test_dependencies_and_parameters_exist(kind, group, definition):
    for dependency in declared_code(definition):
        assert (ROOT / dependency).exists(), dependency
    for key in definition.get("params", []):
        assert isinstance(PARAMETERS.get(key), dict), f"params.yaml has no section {key}"


@pytest.mark.parametrize(("kind", "group", "definition"), STAGES)
def test_stages_have_the_agreed_form(kind, group, definition):
    if kind in SIMULATING:
        assert definition["cmd"] == f"granular-response simulate {group}"
        assert definition["outs"] == [f"data/{group}.nc"]
        assert definition["params"] == ["common", group]
    elif kind == "draw":
        assert definition["cmd"] == f"granular-response draw {group}"
        assert definition["outs"] == [{f"figures/{group}": {"cache": False}}]
        assert f"data/{group}.nc" in definition["deps"]
        assert "params" not in definition


def test_every_group_has_both_stages():
    simulated = [group for kind in SIMULATING for group in PIPELINE[kind]["foreach"]]
    assert sorted(simulated) == sorted(PIPELINE["draw"]["foreach"])


def test_what_is_derived_comes_after_the_data_that_it_reads():
    for group in PIPELINE["derive"]["foreach"]:
        assert PARAMETERS[group]["responses"] in PIPELINE["derive"]["do"]["deps"]


@pytest.mark.parametrize(("package", "kind"), [("studies", "simulate"), ("figures", "draw")])
def test_every_group_module_is_in_the_pipeline(package, kind):
    for path in (SOURCE / "granular_response" / package).glob("*.py"):
        body = ast.parse(path.read_text()).body
        if any(isinstance(node, ast.FunctionDef) and node.name == kind for node in body):
            kinds = SIMULATING if kind == "simulate" else (kind,)
            assert path.stem in [group for kind in kinds for group in PIPELINE[kind]["foreach"]]


def test_dvc_reads_the_pipeline():
    repo = pytest.importorskip("dvc.repo")
    names = {stage.addressing for stage in repo.Repo(ROOT).index.stages}
    assert {f"draw@{group}" for group in PIPELINE["draw"]["foreach"]} <= names
