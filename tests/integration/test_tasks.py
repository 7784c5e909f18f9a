"""One map: same results wherever it runs, nothing finished is lost, every failure names its task."""

import concurrent.futures
import contextlib
import functools
import importlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
import warnings
from operator import call
from pathlib import Path

import numpy as np
import pytest
from commands import LONGEST, python
from refusals import refuses

from granular_response.scene import Contact, Scene, Wall
from granular_response.sweeps import keys
from granular_response.sweeps.errors import SweepError
from granular_response.sweeps.memory import MemoryWarning
from granular_response.sweeps.resources import using
from granular_response.sweeps.tasks import map_tasks


def response(item):
    seed, size = item
    return np.random.default_rng(seed).normal(size=size).cumsum()


def slow_first(item):
    time.sleep(0.2 if item == 0 else 0.0)
    return item


def wait(seconds):
    time.sleep(seconds)


def note(item, folder, die_at=None, always=False, gate=None):
    """Leave a mark for each start; kill this process at one item, the first time or always.

    From the item ``gate`` on it waits for a file of that name.
    """
    with open(Path(folder) / str(item), "a") as file:
        file.write(f"{os.getpid()}\n")
    while gate is not None and item >= gate and not (Path(folder) / "gate").exists():
        time.sleep(0.02)
    if item == die_at and (always or len(starts(folder, item)) == 1):
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(0.05)
    return item * item


def starts(folder, item):
    mark = Path(folder) / str(item)
    return mark.read_text().split() if mark.exists() else []


ITEMS = [(seed, 50 + seed) for seed in range(7)]


class Refusing(concurrent.futures.Executor):
    """Takes a few tasks, in threads of this process, and then no more."""

    def __init__(self, most):
        self.most, self.pool = most, concurrent.futures.ThreadPoolExecutor(1)

    def submit(self, *task, **more):
        if not self.most:
            raise RuntimeError("cannot schedule new futures after shutdown")
        self.most -= 1
        return self.pool.submit(*task, **more)


@contextlib.contextmanager
def resources(place, request):
    """Where tasks run, as keyword arguments of ``map_tasks``."""
    if place == "cluster":
        with request.getfixturevalue("cluster").get_client() as client:
            yield {"executor": client.get_executor()}
    elif place == "threads":
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            yield {"executor": pool}
    else:
        yield {"here": {"workers": 1}, "processes": {"workers": 2}, "anywhere": {}}[place]


@pytest.fixture(params=["here", "processes", "anywhere", "threads", "cluster"])
def everywhere(request):
    with resources(request.param, request) as given:
        yield given


@pytest.fixture(params=["processes", "cluster"])
def elsewhere(request):
    with resources(request.param, request) as given:
        yield given


def test_results_are_the_same_everywhere(everywhere):
    found = map_tasks(response, iter(ITEMS), **everywhere)
    assert [one.tobytes() for one in found] == [response(item).tobytes() for item in ITEMS]


@pytest.mark.parametrize("workers", [1, 2])
def test_progress_counts_to_the_end(workers):
    calls = []
    map_tasks(slow_first, range(4), workers=workers, progress=lambda *call: calls.append(call), what="scenes")
    assert calls == [(done, 4, "scenes") for done in range(5)]


def fail_by_name(scene, width, kind="slab"):
    raise ValueError(f"no equilibrium of {scene.contact.friction:g}")


def test_a_failing_task_is_named_by_the_keys_and_values_that_tell_it_from_others(everywhere):
    scenes = [Scene(contact=Contact(friction=mu), wall=Wall(friction=0.1)) for mu in (0.5, 0.7)]
    calls = [functools.partial(fail_by_name, one, np.zeros(3), kind="pile") for one in scenes]
    one = r"task (1|2) of 2 \(contact.friction = 0.[57]\) failed: ValueError: no equilibrium of 0.[57]"
    with pytest.raises(SweepError, match=one) as caught:
        map_tasks(call, calls, **everywhere)
    assert isinstance(caught.value.__cause__, ValueError)
    alone = r"task 1 of 1 \(contact.friction = 0.5, wall.friction = 0.1, kind = 'pile'\) failed"
    refuses(SweepError, alone, map_tasks, call, calls[:1], **everywhere)


class Unreadable(Exception):
    """Made from two values, kept as one: it cannot be unpickled."""

    def __init__(self, one, other):
        super().__init__(f"{one} and {other}")


def raise_unreadable(item):
    raise Unreadable(item, "more")


def test_an_exception_that_cannot_be_sent_is_told_as_text(elsewhere):
    with pytest.raises(SweepError, match=r"task [12] of 2 \([12]\) failed: Unreadable: [12] and more") as caught:
        map_tasks(raise_unreadable, [1, 2], **elsewhere)
    assert "in raise_unreadable" in str(caught.value.__cause__)


class Ajar:
    """Can be sent, but not read."""

    def __init__(self, item):
        pass

    def __reduce__(self):
        return (int, ("no number",))


def test_what_cannot_be_sent_is_named():
    with pytest.raises(SweepError, match=r"task 2 of 2 \(.*\) cannot be sent to a worker: .*lock"):
        map_tasks(slow_first, [1, threading.Lock()], workers=2)
    with pytest.raises(SweepError, match=r"task [12] of 2 .* failed: TypeError: .*lock"):
        map_tasks(lambda item: threading.Lock(), [1, 2], workers=2)
    with pytest.raises(SweepError, match=r"failed: its result cannot be read: ValueError: invalid literal"):
        map_tasks(Ajar, [1, 2], workers=2)


def test_lambdas_and_functions_of_a_function_run_elsewhere(elsewhere):
    factor = 3

    def scaled(item):
        return factor * item

    assert map_tasks(scaled, range(4), **elsewhere) == [0, 3, 6, 9]
    assert map_tasks(lambda item: item + factor, range(4), **elsewhere) == [3, 4, 5, 6]


NOTEBOOK = """
import dataclasses
from granular_response.sweeps.tasks import map_tasks
@dataclasses.dataclass
class Found:
    value: int
def inner(item):
    return Found(item + 1)
def cell(item):
    return inner(item)
found = map_tasks(cell, range(4), workers=2)
assert all(type(one) is Found for one in found)
print([one.value for one in found])
"""


def test_a_function_of_a_notebook_runs_in_processes():
    """A program that no worker can import, as a cell of a notebook is none."""
    assert python("-c", NOTEBOOK) == "[1, 2, 3, 4]\n"


def test_a_script_without_its_guard_is_told_what_is_missing(tmp_path):
    (tmp_path / "script.py").write_text(NOTEBOOK)
    with pytest.raises(AssertionError, match="SweepError: worker processes end before they begin: a script has its"):
        python(tmp_path / "script.py")


@pytest.mark.parametrize("workers", [0, -1, 1.5, "2"])
def test_the_number_of_workers_is_checked(workers):
    with pytest.raises(SweepError, match=f"workers = {workers!r}: must be a whole number, 1 or more"):
        map_tasks(slow_first, [1], workers=workers)


def test_a_killed_worker_loses_only_what_was_in_flight(tmp_path):
    task = functools.partial(note, folder=tmp_path, die_at=3)
    assert map_tasks(task, range(8), workers=2) == [item * item for item in range(8)]
    again = [item for item in range(8) if len(starts(tmp_path, item)) > 1]
    assert 3 in again
    assert len(again) <= 2


def test_a_task_that_kills_every_worker_is_named(tmp_path):
    task = functools.partial(note, folder=tmp_path, die_at=3, always=True)
    refuses(SweepError, r"task 4 of 6 \(3\) killed its worker process twice", map_tasks, task, range(6), workers=2)
    assert len(starts(tmp_path, 3)) == 2


def test_an_interrupted_sweep_continues(tmp_path):
    marks, kept = tmp_path / "marks", tmp_path / "kept"
    marks.mkdir()
    seen = []

    def interrupt(done, total, what):
        seen.append(done)
        if done == 3:
            raise KeyboardInterrupt

    task = functools.partial(note, folder=marks)
    with pytest.raises(KeyboardInterrupt, match=r"^3 of 8 tasks are kept in "):
        map_tasks(task, range(8), workers=2, checkpoint=kept, progress=interrupt)
    finished = len(list(kept.rglob("*.kept")))
    assert finished == 3
    seen.clear()
    goes_on = {"workers": 2, "checkpoint": kept, "progress": lambda done, total, what: seen.append((done, what))}
    result = map_tasks(task, range(8), **goes_on)
    assert result == [item * item for item in range(8)]
    assert seen == [(3, "kept"), *((done, "tasks") for done in range(3, 9))]
    assert sum(len(starts(marks, item)) for item in range(8)) <= 8 + 2  # again: at most one per worker


INTERRUPTED = """
import sys
sys.path.insert(0, sys.argv[1])
from test_tasks import map_tasks, wait
if __name__ == "__main__":
    workers, ended = map(int, sys.argv[2:])
    def progress(done, total, what):
        print(done, flush=True)
    map_tasks(wait, [0.0] * ended + [3600.0] * 8, workers=workers, progress=progress)
"""


@pytest.mark.parametrize(("workers", "done"), [(1, 0), (1, 2), (4, 0), (4, 3)])
def test_a_terminal_that_interrupts_has_one_line(tmp_path, workers, done):
    """The signal goes to all processes of the terminal, those that are only just importing too."""
    script = tmp_path / "script.py"
    script.write_text(INTERRUPTED)
    run = subprocess.Popen(
        [sys.executable, script, Path(__file__).parent, str(workers), str(done)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        start_new_session=True, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )  # fmt: skip
    while int(run.stdout.readline()) < done:
        pass
    os.killpg(run.pid, signal.SIGINT)
    assert run.communicate(timeout=LONGEST)[1] == f"interrupted; {done} of {done + 8} tasks are done\n"
    assert run.returncode == -signal.SIGINT


def test_an_error_beside_an_interruption_is_shown_as_ever(tmp_path):
    (tmp_path / "script.py").write_text(
        "from granular_response.sweeps.errors import interrupted\n"
        "try:\n    raise interrupted('x')\nexcept KeyboardInterrupt:\n    pass\nraise ValueError('other')\n"
    )
    with pytest.raises(AssertionError, match=r"Traceback .*\n.*\n.*\nValueError: other"):
        python(tmp_path / "script.py")


@pytest.mark.parametrize("times", [1, 2])
def test_the_process_that_forks_workers_may_be_killed_as_it_begins(monkeypatch, times):
    """The first time another one takes its place; then it is one line."""
    killed = []
    submit = concurrent.futures.ProcessPoolExecutor.submit

    def cut(pool, *task):
        if len(killed) < times:
            killed.append(task)
            raise EOFError("unexpected EOF")  # what multiprocessing says of it
        return submit(pool, *task)

    monkeypatch.setattr(concurrent.futures.ProcessPoolExecutor, "submit", cut)
    if times == 1:
        assert map_tasks(slow_first, range(3), workers=2) == [0, 1, 2]
    else:
        said = r"worker processes end before they begin \(EOFError: unexpected EOF\): they were killed; or a script has"
        refuses(SweepError, said, map_tasks, slow_first, range(3), workers=2)
    assert len(killed) == times


def test_workers_import_nothing_from_the_folder_in_which_a_program_runs(tmp_path):
    """As the program itself does, whose own folder is another one."""
    folder, program = tmp_path / "data", tmp_path / "bin" / "program.py"
    for one in folder, program.parent:
        one.mkdir()
    for name in ("numpy", "struct", "random", "typing", "socket"):
        (folder / f"{name}.py").write_text("raise RuntimeError('not that of the library')\n")
    program.write_text(
        "import os, granular_response as gr\n"
        "if __name__ == '__main__':\n"
        "    print(gr.map_tasks(abs, [-1, -2], workers=2), os.environ.get('PYTHONSAFEPATH'))\n"
    )
    assert python(program, folder=folder, PYTHONSAFEPATH="") == "[1, 2] \n"


def test_a_folder_for_temporary_files_whose_name_is_too_long_for_a_socket_is_named(tmp_path):
    folder = tmp_path / ("x" * 120)
    folder.mkdir()
    script = "import granular_response as gr; gr.map_tasks(abs, [-1, -2], workers=2)"
    with pytest.raises(AssertionError, match=rf"TMPDIR \({folder}\): AF_UNIX path too long; or workers=1"):
        python("-c", script, TMPDIR=str(folder))


KILLED = """
import functools, sys
sys.path.insert(0, sys.argv[1])
from test_tasks import map_tasks, note
if __name__ == "__main__":
    map_tasks(functools.partial(note, folder=sys.argv[2], gate=20), range(40), workers=2, checkpoint=sys.argv[3])
"""


def test_a_killed_sweep_continues_and_leaves_no_workers(tmp_path):
    marks, kept, script = tmp_path / "marks", tmp_path / "kept", tmp_path / "script.py"
    marks.mkdir()
    script.write_text(KILLED)
    run = subprocess.Popen([sys.executable, script, Path(__file__).parent, marks, kept])
    deadline = time.monotonic() + LONGEST
    workers: set[int] = set()
    while len(list(kept.glob("*/*.kept"))) < 5 or len(workers) < 2:  # one that begins later would leave its mark later
        assert time.monotonic() < deadline
        time.sleep(0.02)
        workers = {int(pid) for item in range(40) for pid in starts(marks, item)}
    run.kill()
    run.wait()
    while any(alive(pid) for pid in workers):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    done = len(list(kept.rglob("*.kept")))
    before = sum(len(starts(marks, item)) for item in range(40))
    assert done <= 20
    (marks / "gate").touch()
    task = functools.partial(note, folder=str(marks), gate=20)  # as the script had it
    assert map_tasks(task, range(40), workers=1, checkpoint=kept) == [item * item for item in range(40)]
    assert sum(len(starts(marks, item)) for item in range(40)) - before == 40 - done


def alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


def test_what_cannot_be_told_apart_is_computed_with_one_warning(tmp_path):
    said = r"kept: function .*<lambda> stands in no module .* results are not kept"
    with pytest.warns(MemoryWarning, match=said) as heard:
        assert map_tasks(lambda x: x + 1, [2], workers=1, checkpoint=tmp_path / "kept") == [3]
    assert len(heard) == 1
    assert not (tmp_path / "kept").exists()


def test_a_named_package_counts_with_all_of_its_modules(tmp_path, monkeypatch):
    """What is kept is of its present code."""
    package = tmp_path / "mine"
    package.mkdir()
    (package / "__init__.py").write_text("RUNS = []\n")
    (package / "width.py").write_text("def width(item):\n    return 2 * item\n")
    dataclass = "from dataclasses import dataclass\n\n\n@dataclass(frozen=True)\n"
    (package / "outcome.py").write_text(f"{dataclass}class Outcome:\n    value: int\n")
    (package / "study.py").write_text(
        "from . import RUNS, outcome, width\n"
        "def study(item):\n    RUNS.append(item)\n    return outcome.Outcome(width.width(item))\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    study = importlib.import_module("mine.study")

    def outcomes():
        keys.sources.cache_clear()  # what another process would find
        with using(checkpoint=tmp_path / "kept", packages=("mine",), workers=1):
            return [found.value for found in map_tasks(study.study, [1, 2])]

    assert outcomes() == outcomes() == [2, 4] and study.RUNS == [1, 2]
    with (package / "width.py").open("a") as file:
        file.write("# another\n")
    assert outcomes() == [2, 4] and study.RUNS == [1, 2, 1, 2]
    with pytest.raises(ModuleNotFoundError, match=r"nowhere/a\.py: no part of this package, and no package nowhere"):
        keys.sources("nowhere/a.py")
    for name in [name for name in sys.modules if name.partition(".")[0] == "mine"]:
        del sys.modules[name]  # not by monkeypatch, which would put it back


def rewritten(path):
    path.write_text(path.read_text() + "x")
    return 1


def test_a_result_whose_file_changed_while_it_was_made_is_not_kept(tmp_path):
    (tmp_path / "a.txt").write_text("1")
    with pytest.warns(MemoryWarning, match="a file that a task reads changed while it ran, so its result is not kept"):
        map_tasks(rewritten, [tmp_path / "a.txt"], workers=1, checkpoint=tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


@pytest.mark.parametrize("part", ["", "shelf", "file"])
def test_what_somebody_else_owns_is_not_read(tmp_path, monkeypatch, part):
    kept, marks = tmp_path / "kept", tmp_path / "marks"
    marks.mkdir()
    task = functools.partial(note, folder=marks)
    map_tasks(task, range(2), workers=1, checkpoint=kept)
    (shelf,) = kept.iterdir()
    theirs = {"": [kept], "shelf": [shelf], "file": list(shelf.iterdir())}[part]
    usual = Path.stat

    def stat(path, **options):
        found = usual(path, **options)
        return os.stat_result((*found[:4], found.st_uid + (path in theirs), *found[5:]))

    monkeypatch.setattr(Path, "stat", stat)
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("default")
        map_tasks(task, range(2), workers=1, checkpoint=kept)
    assert [len(starts(marks, item)) for item in range(2)] == [2, 2]
    (said,) = heard
    assert re.search(r"kept: what another user owns is not read \(user \d+, this is \d+\)$", str(said.message))


class TestExecutors:
    """Where somebody else runs the tasks; a real cluster of Dask among them."""

    def test_a_killed_worker_loses_only_what_was_in_flight(self, cluster, tmp_path):
        marks = tmp_path / "marks"
        marks.mkdir()
        task = functools.partial(note, folder=marks, die_at=12)
        with cluster.get_client() as client:
            options = {"executor": client.get_executor(), "checkpoint": tmp_path / "kept"}
            try:
                result = map_tasks(task, range(16), **options)
            except SweepError as error:  # Dask looks at a task after it has its result: a death in between loses that
                assert " was lost: ValueError: too many values to unpack" in str(error)
                result = map_tasks(task, range(16), **options)
        assert result == [item * item for item in range(16)]
        again = [item for item in range(16) if len(starts(marks, item)) > 1]
        assert 12 in again
        assert len(again) < 16  # what it had not yet handed over goes with it; not all that it ever finished
        assert len(list((tmp_path / "kept").rglob("*.kept"))) == 16

    def test_a_task_that_kills_every_worker_is_named(self, cluster, tmp_path):
        task = functools.partial(note, folder=tmp_path, die_at=3, always=True)
        with cluster.get_client() as client:
            said = r"task [1-6] of 6 \([0-5]\) was lost: KilledWorker: "
            refuses(SweepError, said, map_tasks, task, range(6), executor=client.get_executor())

    def test_workers_that_round_otherwise_are_reported(self, cluster, monkeypatch):
        with cluster.get_client() as client:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                map_tasks(response, ITEMS[:2], executor=client.get_executor())
            monkeypatch.setenv("OMP_NUM_THREADS", "7")
            with pytest.warns(UserWarning, match=r"workers are not set to round as this .* last digits may differ"):
                map_tasks(response, ITEMS[:2], executor=client.get_executor())

    def test_what_is_no_executor_is_one_line(self, cluster):
        said = r"executor = .*: must be a concurrent.futures.Executor"
        refuses(SweepError, said, map_tasks, response, ITEMS, executor="tcp://127.0.0.1:8786")
        with cluster.get_client() as client:
            refuses(SweepError, rf"{said}; of a Dask client it is client.get", map_tasks, response, [], executor=client)
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            said = "workers = 2: must be left out with an executor"
            refuses(SweepError, said, map_tasks, response, ITEMS, executor=pool, workers=2)

    def test_an_executor_that_takes_no_more_ends_the_sweep_in_one_line(self, tmp_path):
        said = r"Refusing takes no tasks: RuntimeError: cannot schedule new futures after shutdown"
        refuses(SweepError, said, map_tasks, slow_first, range(4), executor=Refusing(2))

    def test_calls_of_two_sweeps_differ(self, monkeypatch):
        """Dask takes the same call for the same task: a sweep would lose it when the one before cancels its own."""
        calls = []
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            submit = pool.submit
            monkeypatch.setattr(pool, "submit", lambda *call: calls.append(call) or submit(*call))
            assert map_tasks(slow_first, range(2), executor=pool) == map_tasks(slow_first, range(2), executor=pool)
        assert len(calls) == 4 and not set(calls[:2]) & set(calls[2:])

    def test_the_executor_of_the_resources_is_used_unless_workers_are_named(self):
        with using(executor=Refusing(0)):
            refuses(SweepError, "Refusing takes no tasks", map_tasks, slow_first, range(2))
            assert map_tasks(slow_first, range(2), workers=1) == [0, 1]


def warn(item):
    warnings.warn(str(item), stacklevel=1)


def test_what_tasks_warn_of_is_said(everywhere):
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("default")
        map_tasks(warn, [f"said {everywhere}"] * 3, **everywhere)  # another text in each place
    assert [str(one.message) for one in heard] == [f"said {everywhere}"]
