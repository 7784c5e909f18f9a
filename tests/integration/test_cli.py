"""The command line as a user has it: a process of its own, its output, its exit code.

How a process begins is tried by new ones (``process``), what commands say and do by forked ones (``call``).
"""

import json
import os
import pty
import re
import resource
import select
import shlex
import shutil
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from claims_data import PILE, pile_dip, preparation
from commands import LIBRARY, LONGEST, PAPER, SCENE, call, process, python, refused, succeeded
from places import DATA, ROOT

from granular_response import __version__
from granular_response.machine import floating_point
from granular_response.store import files as store

PROGRAMS = {LIBRARY: "granular-response", PAPER: "granular-response-paper"}


@pytest.fixture
def folder(tmp_path):
    """A folder with a scene, ``scene.yaml``."""
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path


@pytest.fixture
def solved(folder):
    """The same with its result, ``result.nc``."""
    succeeded("run", "scene.yaml", "-o", "result.nc", folder=folder)
    return folder


@pytest.mark.parametrize("package", [LIBRARY, PAPER])
def test_help_answers_within_half_a_second(package):
    def processor_time():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    durations = []  # of the processor, so that other work on the machine does not count
    for _ in range(3):
        before = processor_time()
        assert process("--help", package=package).returncode == 0
        durations.append(processor_time() - before)
    assert min(durations) < 0.5


def test_version():
    assert process("version").stdout == f"granular-response {__version__}\n"
    for package, program in PROGRAMS.items():
        assert call("--version", package=package).stdout == f"{program} {__version__}\n"


def test_run_and_show(folder):
    finished = process("run", "scene.yaml", "-o", "out/result.nc", folder=folder)
    assert finished.returncode == 0, finished.stderr
    assert finished.stderr == ""  # no bar where nobody looks
    assert "out/result.nc: 14 disks" in finished.stdout and "replaces" not in finished.stdout
    attributes = store.read_attributes(folder / "out" / "result.nc")
    assert 0 < attributes["wall_clock_seconds"] < 600
    assert attributes["package_version"] == __version__
    result = store.read(folder / "out" / "result.nc")[""]
    assert float(result["floor_response"].sum()) == pytest.approx(1.0, abs=1e-8)

    again = succeeded("run", "scene.yaml", "-o", "out/result.nc", folder=folder)
    assert again.endswith("s (replaces an earlier result.nc)\n")
    shown = succeeded("show", "out/result.nc", folder=folder)
    assert re.search(r"1\.0000000\d\d|0\.999999999", shown)
    for part in ("certificate", "max. unbalanced force", "layers: 3", "minimise"):
        assert part in shown


def test_stored_claims_are_listed_and_not_judged_anew(tmp_path):
    store.write(tmp_path / "data" / "pile_dip.nc", pile_dip(), PILE)
    table = tmp_path / "figures" / "claims.json"
    assert succeeded("claims", folder=tmp_path).startswith("figures/claims.json: ")
    before = table.read_bytes()
    lines = succeeded("claims", "--list", folder=tmp_path).splitlines()
    assert table.read_bytes() == before
    rows = json.loads(before)["table"]
    assert re.match(r"A1   [a-z ]+ +\S", lines[0])
    said = [text for row in rows for text in (row["here"], row["paper"], row["cases"]) if text]
    assert len(lines) == len(said) + 3 and all(text in line for text, line in zip(said, lines, strict=False))
    assert re.search(r"3 of \d+ statements on ordered slabs", lines[-3]) and "halved or doubled" in lines[-1]
    drawn = succeeded("claims", "--figure", 7, folder=tmp_path).splitlines()
    listed = [row["id"] for row in rows if 7 in row["figures"]]
    assert [line.split()[0] for line in drawn[:-3] if line[0] != " "] == listed != []


def test_the_claims_of_the_extensions_come_with_the_summary_that_the_paper_reads(tmp_path):
    store.write(tmp_path / "data" / "preparation.nc", preparation(), {"group": "preparation"})
    said = succeeded("claims", "--collection", "extensions", folder=tmp_path)
    assert said.startswith("summary.nc\nfigures/claims.json: ")
    assert store.read_attributes(tmp_path / "summary.nc")["group"] == "preparation"
    (tmp_path / "summary.nc").unlink()
    succeeded("claims", "--collection", "extensions", "--data", "data", folder=tmp_path)
    assert not (tmp_path / "summary.nc").exists()  # it belongs to the stored table alone


@pytest.mark.parametrize(
    ("group", "figure", "said"),
    [
        ("pile_dip", "", "pile_dip\n"),
        ("", "7", "friction_linear_range\n"),
        ("hysteresis", "", "hysteresis is a group of the extensions: "),
        ("pile", "", "GROUP=pile: no such figure group, must be one of:\n  friction_fields\n"),
        ("", "25", "FIGURE=25: must be a figure of the paper, 1 to 24\n"),
        ("", "", "make figure FIGURE=number or GROUP=name, one of:\n"),
    ],
)
def test_a_figure_is_asked_for_by_group_or_number(group, figure, said):
    """`make figure`, before anything is installed."""
    done = subprocess.run([ROOT / ".ci" / "figure", group, figure], capture_output=True, text=True)
    assert (done.stdout + done.stderr).startswith(said) and done.returncode == (not done.stdout)


def test_claims_without_datasets_leave_the_table_alone(tmp_path):
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "claims.json").write_text("as it was")
    assert "holds none of the datasets" in refused("claims", folder=tmp_path)
    assert (tmp_path / "figures" / "claims.json").read_text() == "as it was"
    said = refused("claims", "--list", "-o", "none.json", folder=tmp_path)
    assert "none.json: No such file or directory" in said


def test_claims_without_some_datasets_keep_the_verdicts_on_them(tmp_path):
    """A clone has the whole table, and the datasets alone that somebody has made."""
    store.write(tmp_path / "data" / "pile_dip.nc", pile_dip(), PILE)
    succeeded("claims", folder=tmp_path)
    table = tmp_path / "figures" / "claims.json"
    before = table.read_bytes()
    succeeded("claims", folder=tmp_path)  # verdicts on nothing else are lost
    assert table.read_bytes() == before
    shutil.copytree(tmp_path / "data", tmp_path / "elsewhere")
    (tmp_path / "elsewhere" / "pile_dip.nc").rename(tmp_path / "elsewhere" / "torque.nc")
    said = refused("claims", "--data", "elsewhere", folder=tmp_path)
    assert "figures/claims.json: has verdicts on groups without datasets here (pile_dip)" in said
    assert table.read_bytes() == before
    succeeded("claims", "--data", "elsewhere", "-o", "other.json", folder=tmp_path)
    assert all(row["verdict"] == "not measured" for row in json.loads((tmp_path / "other.json").read_text())["table"])


def test_datasets_of_another_group_are_not_drawn(solved):
    assert "must be those of pile_dip" in refused("draw", "pile_dip", "--data", "result.nc", folder=solved)


def test_a_result_is_continued_and_nothing_else(solved):
    to = ["continue", "result.nc", "--to"]
    assert "load factors 1, 1.5, 3" in succeeded(*to, "1.5", "--to", 3, "-o", "more.nc", folder=solved)
    with xr.open_dataset(solved / "result.nc") as one, xr.open_dataset(solved / "more.nc") as more:
        assert more["state_load_factor"].values.tolist() == [0.0, 1.0, 1.5, 3.0]
        assert more["load_factor"].values.tolist() == [1.0, 1.5, 3.0]
        np.testing.assert_array_equal(more["position"][:2], one["position"])
        np.testing.assert_array_equal(more["floor_response"][0], one["floor_response"][0])
    assert "load factors 1, 0.5, 0" in succeeded(*to, "0.5", "--to", "0", "-o", "less.nc", folder=solved)
    said = refused(*to, "nan", "-o", "nan.nc", folder=solved)
    assert "result.nc: load factors [nan]: must be a list of one or more finite numbers" in said
    store.write(solved / "study.nc", {"other": xr.Dataset()})
    said = refused("continue", "study.nc", "--to", "2", "-o", "nan.nc", folder=solved)
    assert "study.nc: holds no states, must be a result of granular-response run" in said
    assert not (solved / "nan.nc").exists()


def test_run_by_another_method(folder):
    run = ["run", "scene.yaml", "-o", "result.nc", "--method"]
    said = refused(*run, "magic", folder=folder)
    assert all(part in said for part in ("protocol.method", "magic", "minimise"))
    assert not (folder / "result.nc").exists()
    succeeded(*run, "minimise", folder=folder)
    assert "method: minimise" in store.read_attributes(folder / "result.nc")["scene"]


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (["run", "absent.yaml", "-o", "result.nc"], ["absent.yaml: no such file"]),
        (["run", "wrong.yaml", "-o", "result.nc"], ["wrong.yaml", "layers", "-3"]),
        (["run", "scene.yaml", "-o", "scene.yaml/result.nc"], ["cannot be written"]),
        (["show", "absent.nc"], ["absent.nc: no such file"]),
        (["simulate", "nonsense"], ["nonsense: no such figure group, groups of the paper: ", "the extensions: "]),
        (["simulate", "theory"], ["params.yaml: cannot be read"]),
        (["draw", "theory"], ["data/theory.nc: no such file"]),
        (["claims", "--collection", "extras"], ["extras: no such collection, must be one of paper, extensions"]),
        (["keys", "magic"], ["no key of a scene begins with magic", "protocol"]),
    ],
)
def test_expected_errors_are_one_line_and_code_2(folder, arguments, parts):
    (folder / "wrong.yaml").write_text("packing: {kind: slab, layers: -3}\n")
    said = refused(*arguments, folder=folder)
    assert all(part in said for part in parts)
    assert (folder / "scene.yaml").read_text() == SCENE


def test_a_failed_run_keeps_the_old_result(tmp_path):
    unstable = SCENE.replace("friction: 0.0", "friction: 0.2") + "protocol: {time_step: 0.5}\n"
    (tmp_path / "scene.yaml").write_text(unstable)
    store.write(tmp_path / "result.nc", xr.Dataset(attrs={"old": 1}))
    before = (tmp_path / "result.nc").read_bytes()
    assert "time_step" in refused("run", "scene.yaml", "-o", "result.nc", folder=tmp_path)
    assert (tmp_path / "result.nc").read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["result.nc", "scene.yaml"]


def test_disks_of_another_program_are_solved_and_handed_back(tmp_path):
    shutil.copy(DATA / "packings" / "shrink_wrapped.dump", tmp_path / "a.dump")
    packing = "{kind: file, path: a.dump, width: 6, origin: [0, 0]}"
    (tmp_path / "scene.yaml").write_text(f"packing: {packing}\ncontact: {{friction: 0.2}}\nloads: []\n")
    succeeded("run", "scene.yaml", "-o", "a.nc", folder=tmp_path)
    command = ["export", "a.nc", "-o"]
    done = call(*command, "sub/b.lmp", folder=tmp_path)
    assert (done.returncode, done.stdout.strip(), done.stderr.count("\n")) == (0, "sub/b.lmp", 1)
    assert "no springs of friction" in done.stderr and "5 atoms" in (tmp_path / "sub" / "b.lmp").read_text()
    succeeded(*command, "rest.xyz", "--state", 0, folder=tmp_path)
    assert (tmp_path / "rest.xyz").read_text().count("load_factor=0.0") == 1
    assert "format '.abc' is unknown" in refused(*command, "result.abc", folder=tmp_path)


def test_a_state_that_moves_is_said_and_fails_unless_allowed(tmp_path):
    moving = SCENE + "protocol: {method: dynamics, static_finish: false, maximum_steps: 1000, time_step: 5.0e-4}\n"
    (tmp_path / "scene.yaml").write_text(moving)
    run = ["run", "scene.yaml", "-o", "result.nc"]
    said = (
        "granular-response: result.nc: not at rest within protocol.maximum_steps = 1000: gravity, load factor 0.025\n"
    )
    for options, code in (([], 1), (["--allow-unsettled"], 0)):
        finished = call(*run, *options, folder=tmp_path)
        assert (finished.returncode, finished.stderr) == (code, said)
        assert store.read_attributes(tmp_path / "result.nc")["settled"] == "no"  # nothing is lost


def test_an_interrupted_command_ends_quietly(tmp_path):
    """A real terminal, a real Ctrl-C."""
    (tmp_path / "scene.yaml").write_text(
        "packing: {kind: slab, layers: 60, disks_per_row: 242}\n"
        "protocol: {method: dynamics, stop_kinetic_energy: 1e-30}\n"
    )
    parent, child = pty.openpty()
    command = [sys.executable, "-m", "granular_response", "run", "scene.yaml", "-o", "result.nc"]
    run = subprocess.Popen(
        command, cwd=tmp_path, stdin=child, stdout=child, stderr=child, start_new_session=True,
        env=os.environ | {"TERM": "xterm"},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # jobs in the background ignore it
    )  # fmt: skip
    os.close(child)
    output = b""
    while b"gravity" not in output:  # it moves: while modules load or kernels compile, libraries may swallow the signal
        assert select.select([parent], [], [], LONGEST)[0], output
        output += os.read(parent, 4096)
    assert run.poll() is None
    run.send_signal(signal.SIGINT)
    run.wait(timeout=LONGEST)
    try:
        while chunk := os.read(parent, 4096):
            output += chunk
    except OSError:  # the other end is closed
        pass
    os.close(parent)
    assert run.returncode == 130
    assert b"Traceback" not in output and b"Aborted" not in output
    said = re.findall(rb"granular-response: (\w+)", output)
    assert [one for one in said if one != b"compiling"] == [b"interrupted"]  # kernels may be compiled or not
    assert not (tmp_path / "result.nc").exists()


def test_a_shell_takes_the_floating_point_choices():
    code = f'eval "$({shlex.quote(sys.executable)} -m granular_response.machine.floating_point)"; env'
    environment = {k: v for k, v in os.environ.items() if k not in floating_point.variables()}
    done = subprocess.run(["sh", "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert {f"{name}={value}" for name, value in floating_point.variables().items()} <= set(done.stdout.splitlines())


def test_floating_point_choices_are_accepted_by_numpy_without_warning():
    script = (
        f"import os; os.environ.update({floating_point.variables()}); import numpy as np;"
        "from numpy._core._multiarray_umath import __cpu_features__ as f;"
        "print(f.get('AVX512_SKX', False) and f.get('X86_V4', False))"
    )
    assert python("-W", "error", "-c", script) == "False\n"


def test_what_the_user_sets_stays(monkeypatch):
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "3")
    floating_point.pin()
    assert os.environ["OPENBLAS_NUM_THREADS"] == "3"
