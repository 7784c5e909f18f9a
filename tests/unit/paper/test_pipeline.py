"""The pipelines of the collections: what their stages read is what they name, and what runs is what they record."""

import os
import re
import shutil
import signal
import subprocess
import sys
from functools import cache, partial
from pathlib import Path

import grimp
import pytest
import yaml
from commands import PAPER as COMMAND
from commands import python
from places import ROOT
from refusals import refuses

from granular_response.scene import SceneError
from granular_response.store import files as store
from granular_response_paper import checkout
from granular_response_paper.claims import preparations
from granular_response_paper.claims.claim import ClaimsError
from granular_response_paper.pipeline import drawing, dvc, reproduce, simulation
from granular_response_paper.registry import PAPER, Collection, GroupError, collection_of, collections

LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # in C, where PyYAML has it: every process reads these files
COLLECTIONS = collections()
STAGES = {"simulate": "pipeline.simulation", "draw": "pipeline.drawing"}
IDS = {"ids": lambda one: one.name}


@cache
def imports():
    packages = ("granular_response", "granular_response_paper", "granular_response_extensions")
    return grimp.build_graph(*packages, exclude_type_checking_imports=True, cache_dir=None)


def imported(*modules: str) -> set[Path]:
    """The files of modules, of all that they import in the end, and of the packages on the way."""
    graph, todo, seen = imports(), list(modules), set()
    while todo:
        module = todo.pop()
        if module not in seen and module in graph.modules:
            seen.add(module)
            todo += [*graph.find_modules_directly_imported_by(module), module.rpartition(".")[0]]
            todo += graph.find_descendants(module) if module in modules else ()
    found = {}
    for module in seen:
        base = Path(sys.modules["granular_response"].__file__).parents[1] / module.replace(".", "/")
        if module.startswith("granular_response_extensions"):
            base = ROOT / "extensions" / "src" / module.replace(".", "/")
        found[module] = next(path for path in (base / "__init__.py", base.with_suffix(".py")) if path.exists())
    return {path for path in found.values() if path.stat().st_size}  # an empty package is none to depend on


@cache
def pipeline(folder: Path) -> dict[str, dict]:
    """Each stage as DVC resolves it: its dependencies as paths."""
    from dvc.repo import Repo

    with Repo(str(folder)) as repo:
        own = [stage for stage in repo.index.stages if Path(stage.path) == folder / "dvc.yaml"]
        return {stage.addressing.rpartition(":")[2]: [Path(dep.fs_path) for dep in stage.deps] for stage in own}


@pytest.mark.parametrize("collection", COLLECTIONS, **IDS)
def test_each_stage_depends_on_what_it_imports_and_every_group_has_both(collection):
    stages, checked = pipeline((ROOT / collection.folder).resolve()), 0
    groups = {f"{kind}@{group}" for kind in ("simulate", "draw") for group in collection.groups}
    assert groups == {name for name in stages if "@" in name}
    for name in sorted(stages):
        kind, _, group = name.partition("@")
        module = STAGES.get(kind, kind)
        starts = [f"granular_response_paper.{module}"]
        if group:
            starts += [f"{collection.package}.{group}.{part}" for part in ("parameters", kind)]
        if kind in ("claims", "report"):
            part = {"claims": "claims", "report": "tables"}[kind]
            starts += [f"{collection.package}.{one}.{part}" for one in collection.groups]
        named = {path.resolve() for path in stages[name]}
        missing = [path for path in imported(*starts) if not {path, *path.parents} & named]
        assert not missing, f"{name} does not depend on {missing[0].relative_to(ROOT)}, which it imports"
        assert all(path.exists() or path.suffix == ".nc" or path.name == "data" for path in named)
        checked += 1
    assert checked == len(reproduce.stage_names(collection, ROOT))


@pytest.mark.parametrize("collection", COLLECTIONS, **IDS)
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
    assert "Friction " in Path("figures/example/captions.json").read_text("utf-8")  # what the data show, above the text
    response = store.read("data/example.nc")["response"]["floor_response"].values
    assert response.shape == (2, 13) and abs(response.sum(axis=1) - 1.0).max() < 0.2


def in_pipeline(folder: Path, stages: str) -> dict[str, str]:
    """A folder with a pipeline; the environment that DVC needs there."""
    (folder / "dvc.yaml").write_text(stages)
    environment = os.environ | {"GIT_CEILING_DIRECTORIES": str(folder.parent)}
    subprocess.run([sys.executable, "-m", "dvc", "init", "--no-scm", "-q"], cwd=folder, env=environment, check=True)
    return environment


EMPTY = Collection("empty", "granular_response_paper.pipeline", ".", "nothing")


def test_a_stage_that_fails_is_shown_and_ends_the_run(tmp_path):
    """A pipeline of two stages, run by the command that `make reproduce` runs."""
    in_pipeline(tmp_path, "stages: {claims: {cmd: 'true'}, report: {cmd: 'echo the reason && false'}}\n")
    said = []
    assert reproduce.reproduce(EMPTY, tmp_path, say=said.append) != 0
    assert said[0].split()[:4] == ["1", "of", "2", "claims"] and "the reason" in said[-1]


def test_the_first_picture_waits_for_no_simulation(tmp_path, monkeypatch):
    """A stage that DVC would run before it, in the order of their names, runs after it."""
    assert reproduce._FIRST in reproduce.stage_names(PAPER, ROOT)
    in_pipeline(tmp_path, "stages: {a_simulation: {cmd: 'true'}, picture: {cmd: 'true'}}\n")
    monkeypatch.setattr(reproduce, "_FIRST", "picture")
    said = []
    assert reproduce.reproduce(EMPTY, tmp_path, say=said.append) == 0
    assert [line.split()[3] for line in said[:2]] == ["picture", "a_simulation"]


@pytest.mark.parametrize(
    ("number", "deaf"),
    [
        (signal.SIGTERM, ""),
        (signal.SIGKILL, ""),
        (signal.SIGINT, ""),
        (signal.SIGINT, "trap : INT; "),
        (signal.SIGINT, "sleep 1000 & "),
    ],
    ids=["SIGTERM", "SIGKILL", "SIGINT", "SIGINT, missed", "SIGINT, missed by what outlives DVC"],
)
def test_a_run_that_is_killed_ends_its_children_and_keeps_its_lock(tmp_path, number, deaf):
    """Its stage holds a pipe as long as it runs, so that this test sees it begin and end."""
    os.mkfifo(tmp_path / "alive")
    # a shell that is told while it starts a command misses an interruption
    stage = f"exec 3> alive; {deaf}echo begun >&3; while :; do sleep 1000; done"
    stages = f"stages: {{first: {{cmd: 'true'}}, second: {{cmd: '{stage}'}}}}\n"
    environment = in_pipeline(tmp_path, stages)
    script = (
        "from pathlib import Path; from granular_response_paper.pipeline import reproduce;"
        "from granular_response_paper.registry import Collection;"
        f"reproduce.dvc.PATIENCE = {0.1 if 'trap' in deaf else 10.0};"
        "reproduce.reproduce(Collection('empty', 'granular_response_paper.pipeline', '.', 'nothing'), Path())"
    )
    run = subprocess.Popen(
        [sys.executable, "-c", script], cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # jobs in the background ignore it
    )  # fmt: skip
    with open(tmp_path / "alive") as alive:
        assert alive.readline() == "begun\n"
        run.send_signal(number)
        assert alive.read() == ""  # once everything that the stage has started is gone
    assert run.wait() != 0
    assert list(yaml.load((tmp_path / "dvc.lock").read_text(), LOADER)["stages"]) == ["first"]


@pytest.mark.parametrize("collection", COLLECTIONS, **IDS)
def test_a_lock_is_whole_at_any_moment_and_as_dvc_writes_it(tmp_path, collection, monkeypatch):
    """It is replaced in one step."""
    lock, text, seen = tmp_path / "dvc.lock", (ROOT / collection.folder / "dvc.lock").read_text(), []
    lock.write_text(text)
    write = dvc.atomic.write_bytes
    monkeypatch.setattr(dvc.atomic, "write_bytes", lambda *given: (seen.append(lock.read_text()), write(*given)))
    with dvc.modified(lock) as content:
        content["stages"]["new"] = {"cmd": "true"}
    assert seen == [text] and lock.read_text() == text + "  new:\n    cmd: 'true'\n"


def test_dvc_calls_it(tmp_path):
    environment = in_pipeline(tmp_path, "stages: {one: {cmd: 'true'}}\n")
    script = "import sys, runpy, granular_response.store.atomic as one; one.write_bytes = lambda path, _: print(path);"
    script += f"sys.argv = ['dvc', 'repro']; runpy.run_module('{dvc.__name__}', run_name='__main__')"
    run = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0 and "dvc.lock\n" in run.stdout and not (tmp_path / "dvc.lock").exists(), run.stderr


@pytest.mark.parametrize("where", [".dvc/tmp/rwlock", ".dvc/cache/files", "site"])
def test_what_dvc_keeps_decides_nothing_where_it_is_damaged(tmp_path, where):
    """Its note of files in use, its copy of a result, and its database of digests."""
    environment = in_pipeline(tmp_path, "stages: {one: {cmd: 'echo made > out', outs: [out]}}\n")
    environment["DVC_SITE_CACHE_DIR"] = str(tmp_path / "site")
    command = [sys.executable, "-m", dvc.__name__, "repro"]

    def run():
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert (tmp_path / "out").read_text() == "made\n"

    run()
    found = [path for path in (tmp_path, *(tmp_path / where).rglob("*")) if path.is_file()]
    for file in found or [tmp_path / where]:
        file.chmod(0o644)
        file.write_bytes(b"junk")
        if where == ".dvc/cache/files":
            file.chmod(0o444)  # as DVC keeps it
    (tmp_path / "out").unlink()
    run()


def test_one_group_is_run_alone_and_nothing_of_its_folder_is_imported(tmp_path):
    stages = "stages: {draw: {foreach: [one, other], do: {cmd: 'test ${item} = one'}}}\n"
    in_pipeline(tmp_path, stages)
    pair = Collection("pair", EMPTY.package, ".", "two groups")
    pair.__dict__["groups"] = ("one", "other")
    for name in ("numpy", "dvc", "typing"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError")
    said = []
    assert reproduce.reproduce(pair, tmp_path, group="one", say=said.append) == 0
    assert said[0].split()[:4] == ["1", "of", "1", "draw@one"] and said[1].startswith("one: 1 stages run, 0 were")


PACKAGES = ("granular_response", "granular_response_paper")


@pytest.fixture(scope="module")
def copied(tmp_path_factory) -> Path:
    """A copy of this checkout: a second clone, a worktree or a copy, but for the environment."""
    folder = tmp_path_factory.mktemp("copied")
    for package in PACKAGES:
        shutil.copytree(ROOT / "src" / package, folder / "src" / package, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("dvc.yaml", "params.yaml"):
        shutil.copy(ROOT / name, folder)
    return folder


def test_a_copy_runs_until_its_sources_differ(copied, tmp_path):
    """Run from here: the sources of this checkout are imported, whatever the folder; then from the copy itself."""
    model = copied / "src" / "granular_response" / "kernels" / "model.py"
    below, link = copied / "data" / "below", tmp_path / "link"
    below.mkdir(parents=True)
    link.symlink_to(copied)
    for folder in (copied, below, link):
        checkout.check(start=folder)
    checkout.check(start=ROOT)
    content = model.read_bytes()
    for change in (lambda: model.write_bytes(content + b"#"), model.unlink, model.with_name("new.py").touch):
        change()
        for folder in (copied, below, link):
            said = refuses(checkout.CheckoutError, None, checkout.check, PAPER, folder)
            assert said.startswith(f"granular_response runs from {ROOT / 'src' / 'granular_response'}, whose kernels/")
        model.write_bytes(content)
    run = ["simulate", "theory", "--workers", "1", "-o", "theory.nc"]
    done = subprocess.run([sys.executable, "-m", COMMAND, *run], cwd=copied, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "whose kernels/new.py" in done.stderr
    own = {"PYTHONPATH": str(copied / "src")}
    assert "theory.nc" in python("-m", COMMAND, *run, folder=copied, **own)
    # an installed package, or another checkout, where this one's pipeline runs
    script = "from granular_response_paper import checkout; checkout.check()"
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | own, capture_output=True, text=True)
    assert "CheckoutError: granular_response runs from " + str(copied) in done.stderr
    model.with_name("new.py").unlink()


def test_what_is_edited_while_a_stage_runs_is_not_recorded(copied, tmp_path, monkeypatch):
    """DVC records sources and parameters as they are when a stage has ended."""
    source, file = copied / "src" / "granular_response" / "kernels" / "model.py", tmp_path / "params.yaml"
    content, parameters = source.read_bytes(), (ROOT / "params.yaml").read_text()
    script = f"from granular_response_paper import checkout\nwith checkout.unchanged():\n{' ' * 4}"
    for edited, status in (source.with_name("forces.py"), 0), (source, 1):
        command = f"{script}from granular_response.kernels import model; open({str(edited)!r}, 'ab').write(b'#')"
        environment = os.environ | {"PYTHONPATH": str(copied / "src")}
        run = subprocess.run(
            [sys.executable, "-c", command], cwd=copied, env=environment, capture_output=True, text=True
        )
        assert run.returncode == status, run.stderr
    assert run.stderr.endswith(f"CheckoutError: {source} changed while it ran; run the stage again\n")
    source.write_bytes(content)
    file.write_text(parameters)
    edit = {"simulate": lambda _: file.write_text(parameters.replace("stiffness_ratio: 0.8", "stiffness_ratio: 0.5"))}
    member = simulation.group_member
    monkeypatch.setattr(simulation, "group_member", lambda group, of, name: edit.get(of) or member(group, of, name))
    run = partial(simulation.simulate, "friction_linear_range", tmp_path / "one.nc", parameter_file=file)
    refuses(GroupError, "section friction_linear_range changed while it ran; run the stage again$", run)


def test_what_is_edited_while_a_figure_is_drawn_is_not_recorded(copied):
    """The module edits itself as it is imported."""
    source = copied / "src" / "granular_response_paper" / "groups" / "theory" / "draw.py"
    content, environment = source.read_bytes(), {"PYTHONPATH": str(copied / "src")}
    python("-m", COMMAND, "simulate", "theory", "--workers", "1", folder=copied, **environment)
    source.write_bytes(content + b"\nwith open(__file__, 'ab') as _file:\n    _file.write(b'#')\n")
    command = [sys.executable, "-m", COMMAND, "draw", "theory"]
    run = subprocess.run(command, cwd=copied, env=os.environ | environment, capture_output=True, text=True)
    source.write_bytes(content)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == f"granular-response-paper: {source} changed while it ran; run the stage again\n"


def test_outside_a_checkout_nothing_is_refused(tmp_path):
    checkout.check(start=tmp_path)
    (tmp_path / "dvc.yaml").touch()
    checkout.check(start=tmp_path)


@pytest.mark.parametrize("collection", COLLECTIONS[1:], **IDS)
def test_an_extension_is_compared_with_its_own_folder(collection, tmp_path):
    package = tmp_path / collection.folder / "src" / collection.package
    package.mkdir(parents=True)
    (tmp_path / collection.folder / "dvc.yaml").touch()
    for folder in (tmp_path, tmp_path / collection.folder):
        said = refuses(checkout.CheckoutError, None, checkout.check, collection, folder)
        assert said.startswith(f"{collection.package} runs from")
    checkout.check(PAPER, tmp_path / collection.folder)


def test_the_stored_summary_of_preparations_is_the_one_of_the_lock(tmp_path):
    preparations.check(ROOT / preparations.OUTPUT)
    for name in ("summary.nc", "dvc.lock"):
        shutil.copy(ROOT / "extensions" / name, tmp_path)
    digest = store.read_attributes(tmp_path / "summary.nc")["source_md5"]
    lock = (tmp_path / "dvc.lock").read_text()
    (tmp_path / "dvc.lock").write_text(lock.replace(digest, "0" * 32))
    said = refuses(ClaimsError, None, preparations.check, tmp_path / "summary.nc")
    assert said.startswith(f"{tmp_path / 'summary.nc'}: is older than preparation.nc of")
    (tmp_path / "dvc.lock").unlink()
    preparations.check(tmp_path / "summary.nc")
