"""The command line. It knows arguments and messages; what is heavy is imported inside the commands."""

from __future__ import annotations

import errno
import gc
import io
import os
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import __version__
from ..errors import GranularError
from ..machine import floating_point, without_dask

# Before anything loads numpy: the stages of the pipeline give the same digits on every x86 machine.
floating_point.pin()

if TYPE_CHECKING:
    from ..solve import Solution

PAPER = (
    "C. Goldenberg and I. Goldhirsch, Effects of Friction and Disorder on the Quasi-Static Response of "
    "Granular Solids to a Localized Force, arXiv:0711.4243"
)
PACKAGE = (
    "granular-response: quasi-static response of two-dimensional granular solids to a localized force, "
    f"version {__version__}"
)
BIBTEX = f"""\
@misc{{goldenberg-goldhirsch,
  author = {{Goldenberg, C. and Goldhirsch, I.}},
  title  = {{Effects of Friction and Disorder on the Quasi-Static Response of Granular Solids
            to a Localized Force}},
  year   = {{2007}},
  month  = nov,
  eprint = {{0711.4243}},
  archiveprefix = {{arXiv}},
  url    = {{https://arxiv.org/abs/0711.4243}}
}}

@software{{granular-response,
  author  = {{{{The granular-response authors}}}},
  title   = {{granular-response: quasi-static response of two-dimensional granular solids
             to a localized force}},
  version = {{{__version__}}}
}}"""

app = typer.Typer(
    name="granular-response",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # plain help answers twice as fast
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _loaded() -> None:
    """A command has what it needs: start collecting garbage, but not among what the imports have made."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def _examples(*lines: str) -> str:
    return "\b\nExamples:\n" + "\n".join(f"  granular-response {line}" for line in lines)


def _command(*examples: str, name: str | None = None) -> Callable[[Callable], Callable]:
    """A command with examples of its arguments, as they follow the name of the program."""
    return app.command(name, epilog=_examples(*examples))


Group = Annotated[str, typer.Argument(help="Figure group.", show_default=False)]
#: Folders and files that several commands take.
StoredResult = Annotated[Path, typer.Argument(help="A stored result (netCDF).", show_default=False)]
ResultFile = Annotated[Path, typer.Option("--output", "-o", help="Result (netCDF).", show_default=False)]
LockFolder = Annotated[Path, typer.Option(help="Folder with dvc.lock.")]
GroupData = Annotated[Path | None, typer.Option(help="Datasets of the group; data/GROUP.nc if not given.")]
AllowUnsettled = Annotated[
    bool, typer.Option("--allow-unsettled", help="Do not fail where states are stored that are not at rest.")
]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads for large packings, all cores if not given; results have the same bits."),
]


def _keep(output: Path, solution: Solution, started: float, allow_unsettled: bool, said: str) -> None:
    """Store a solution. States that are still moving are kept too, but no success unless they were asked for."""
    import time

    from ..store import files as store
    from ..store.result import to_labelled

    store.write(output, to_labelled(solution), {"wall_clock_seconds": time.perf_counter() - started}, keep=True)
    typer.echo(f"{output}: {said}, {time.perf_counter() - started:.1f} s")
    for remark in solution.remarks:
        typer.echo(f"granular-response: {output}: {remark}", err=True)
    if solution.unsettled and not allow_unsettled:
        raise typer.Exit(1)


def _print_version(asked: bool) -> None:
    if asked:
        print_version()
        raise typer.Exit


@app.callback(
    epilog=_examples(
        "run examples/slab.yaml -o slab.nc",
        "show slab.nc",
        "simulate pile_dip && granular-response draw pile_dip",
    )
)
def start(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version and stop.", callback=_print_version, is_eager=True),
    ] = False,
) -> None:
    """Quasi-static response of two-dimensional granular solids to a localized force."""


@_command("run examples/slab.yaml -o slab.nc", "run scene.yaml -o scene-by-dynamics.nc --method dynamics")
def run(
    scene: Annotated[Path, typer.Argument(help="Scene file (YAML).", show_default=False)],
    output: ResultFile,
    method: Annotated[
        str | None,
        typer.Option(help="Solve by this method in place of the scene's: auto, dynamics, path or minimise."),
    ] = None,
    threads: Threads = None,
    allow_unsettled: AllowUnsettled = False,
) -> None:
    """Solve a scene and store the result.

    It settles under gravity and is then loaded; both states are stored with their certificate.
    """
    import time

    from ..api.terminal import TerminalProgress
    from ..scene import Scene, SceneError
    from ..store import files as store

    started = time.perf_counter()
    described = Scene.from_yaml(scene)
    if method is not None:
        described = described.updated({"protocol.method": method})
    store.check_writable(output, [scene, *described.files])

    from ..machine.threads import cores, using
    from ..solve import SOLVE_ERRORS, solve_scene

    _loaded()

    try:
        with using(threads or cores()), TerminalProgress() as progress:
            solution = solve_scene(described, progress=progress)
    except (SceneError, *SOLVE_ERRORS) as error:
        if not str(error).startswith(str(scene)):
            error.args = (f"{scene}: {error}", *error.args[1:])
        raise
    _keep(output, solution, started, allow_unsettled, f"{solution.problem.n} disks")


@_command(
    "continue slab.nc --to 2 -o slab-to-twice-the-load.nc",
    "continue slab.nc --to 0.5 --to 0 -o slab-unloaded.nc",
    name="continue",
)
def continue_(
    result: StoredResult,
    to: Annotated[
        list[float],
        typer.Option(help="Multiple of the scene's loads to go to; repeated, up or down.", show_default=False),
    ],
    output: ResultFile,
    folder: Annotated[Path, typer.Option(help="Folder of the scene file, for a packing from a table.")] = Path("."),
    threads: Threads = None,
    allow_unsettled: AllowUnsettled = False,
) -> None:
    """Take a result through further loads, up or down.

    The states so far are kept. The new ones are, to the last bit, those of a run that was never interrupted.
    """
    import time

    from ..api.terminal import TerminalProgress
    from ..store import files as store

    started = time.perf_counter()
    store.check_writable(output, [result])

    from ..machine.threads import cores, using
    from ..scene import SceneError
    from ..solve import continue_solution
    from ..store.checked import read_result
    from ..store.result import ResultError, solution_from

    _loaded()

    stored = read_result(result)
    try:
        solution = solution_from(stored, folder=folder)
        store.check_writable(output, solution.scene.files)
        with using(threads or cores()), TerminalProgress() as progress:
            solution = continue_solution(solution, to, progress=progress)
    except (ResultError, SceneError) as error:
        raise ResultError(f"{result}: {error}") from error
    factors = ", ".join(f"{factor:g}" for factor in solution.load_factors)
    _keep(output, solution, started, allow_unsettled, f"load factors {factors}")


@_command(
    "simulate frictionless_crossover",
    "simulate polydisperse_averages --workers 8",
    "simulate phase_diagram --scheduler tcp://10.0.0.5:8786",
    "simulate pile_dip --params other.yaml -o other.nc",
)
def simulate(
    group: Group,
    workers: Annotated[
        int | None,
        typer.Option(min=1, envvar="GRANULAR_RESPONSE_WORKERS", help="Local processes; all cores if not given."),
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a running Dask scheduler, in place of local processes.")
    ] = None,
    params: Annotated[Path, typer.Option(help="Parameter file with the sections common and GROUP.")] = Path(
        "params.yaml"
    ),
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Datasets (netCDF); data/GROUP.nc if not given.")
    ] = None,
) -> None:
    """Run the simulations of a figure group.

    A run that was interrupted continues where it was.
    """
    from ..api.terminal import TerminalProgress
    from ..paper.pipeline import simulation

    _loaded()

    if before := simulation.finished(group, output):
        typer.echo(f"granular-response: {group} goes on from {before} finished tasks of an earlier run", err=True)
    try:
        with TerminalProgress() as progress:
            path = simulation.simulate(
                group,
                output,
                parameter_file=params,
                workers=workers,
                scheduler=scheduler,
                progress=progress,
            )
    except KeyboardInterrupt:
        if count := simulation.finished(group, output):
            typer.echo(f"granular-response: interrupted; run again, it goes on from {count} finished tasks", err=True)
        raise
    typer.echo(str(path))


@_command("draw pile_dip", "draw pile_dip --measure", "draw pile_dip --data other.nc -o other-figures")
def draw(
    group: Group,
    data: GroupData = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Folder of the figures; figures/GROUP if not given.")
    ] = None,
    measured: Annotated[
        bool, typer.Option("--measure", help="Write its numbers too, to figures/metrics/GROUP.json.")
    ] = False,
) -> None:
    """Draw the figures of a group."""
    from ..paper.pipeline import drawing, measuring

    _loaded()

    numbers = measuring.measure(group, data) if measured else None  # first: they do not wait for pictures
    for path in drawing.draw(group, data, output):
        typer.echo(str(path))
    if numbers is not None:
        typer.echo(str(numbers))


@_command("measure pile_dip", "measure pile_dip --data other.nc -o other.json")
def measure(
    group: Group,
    data: GroupData = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Numbers (JSON); figures/metrics/GROUP.json if not given.")
    ] = None,
) -> None:
    """Write the numbers of a group, as its own datasets have them, for comparing experiments.

    The table of claims (granular-response claims) needs the datasets of all groups.
    """
    from ..paper.pipeline import measuring

    _loaded()

    typer.echo(str(measuring.measure(group, data, output)))


@_command("show slab.nc", "show data/pile_dip.nc")
def show(
    file: Annotated[Path, typer.Argument(help="A stored result or study (netCDF).", show_default=False)],
) -> None:
    """Summarise a stored file.

    Scene, certificate and floor response of a result; groups and dimensions of a study.
    """
    from rich.console import Console
    from rich.text import Text

    from ..api.terminal import columns
    from ..store.summary import summarise

    console = Console(highlight=False, markup=False, emoji=False, width=columns())
    for part in summarise(file):
        console.print(part, soft_wrap=isinstance(part, Text))


@_command(
    "plot slab.nc -o slab.pdf",
    "plot slab.nc -o chains.png --what forces --scale percentile",
    "plot slab.nc -o rest.png --what packing,forces --state 0",
)
def plot(
    result: StoredResult,
    output: Annotated[Path, typer.Option("--output", "-o", help="Picture to make: .pdf, .png or .svg.")],
    what: Annotated[
        str | None,
        typer.Option(
            help="Pictures on the page, among response, floor, forces, contacts, stress, packing; if not given "
            "response,forces,contacts,stress, with floor for response where no force is applied.",
            show_default=False,
        ),
    ] = None,
    state: Annotated[int, typer.Option(help="State: 0 at rest, then one for each load factor, -1 the last.")] = -1,
    scale: Annotated[str, typer.Option(help="Scale of the forces: linear, sqrt or percentile.")] = "sqrt",
) -> None:
    """Draw a result: response, force chains, contacts and stress on one page."""
    from ..plot import pictures
    from ..store.checked import read_result

    _loaded()

    stored = read_result(result)
    names = None if what is None else what.split(",")
    typer.echo(str(pictures.save(stored, output, names, state=state, scale=scale, inputs=[result])))


@_command("keys", "keys protocol", "keys --page docs/scene-reference.md")
def keys(
    part: Annotated[str, typer.Argument(help="Beginning of the keys, such as contact.", show_default=False)] = "",
    page: Annotated[
        Path | None, typer.Option(help="Renew the tables in this file in place of printing.", show_default=False)
    ] = None,
) -> None:
    """Print the keys of a scene file: default, what is allowed, unit and meaning."""
    from . import scene_reference

    if page is None:
        typer.echo(scene_reference.plain(part))
    else:
        scene_reference.renew(page)


@_command("export slab.nc -o slab.gsd", "export slab.nc -o rest.vtu --state 0", "export slab.nc -o slab.events.csv")
def export(
    result: StoredResult,
    output: Annotated[Path, typer.Option("--output", "-o", help="File to make; its ending is the format.")],
    state: Annotated[
        int | None,
        typer.Option(
            help="Write this state alone: 0 at rest, -1 the last one. If not given all, or the last in a file of one.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Write a result for OVITO (.gsd, .xyz), ParaView (.pvd, .vtu), LAMMPS (.data, .dump), YADE (.txt) or as .csv.

    Events of the load path: .events.csv.
    """
    from ..store import export as exporting

    typer.echo(str(exporting.export(result, output, state=state)))


@_command("claims", "claims --list", "claims --readme README.md")
def claims(
    data: Annotated[Path, typer.Option(help="Folder of the datasets.")] = Path("data"),
    output: Annotated[Path, typer.Option("--output", "-o", help="Table of claims (JSON).")] = Path(
        "figures/claims.json"
    ),
    readme: Annotated[
        Path | None, typer.Option(help="Renew the counts that this file quotes.", show_default=False)
    ] = None,
    every: Annotated[bool, typer.Option("--list", help="Print the stored table; judge nothing anew.")] = False,
) -> None:
    """Compare the paper's claims with the stored datasets."""
    from ..paper.claims import table as judging

    _loaded()

    found = judging.read(output) if every else judging.write(output, data, keep=[readme] if readme else [])
    if readme is not None:
        judging.renew(readme, found)
    for row in found["table"] if every else ():
        kind = f" [{row['interval_kind']}]" if row["interval_kind"] else ""
        typer.echo(f"{row['id']:4} {row['verdict']:22} {row['ours'] or '-'}{kind}")
        typer.echo(f"{'':27} {row['reason']}")
        if row["survival"]:
            typer.echo(f"{'':27} Variants ({row['robustness']}): {row['survival']}")
    typer.echo(f"{output}: {judging.sentence(found)}")
    typer.echo(judging.robustness(found))
    typer.echo(judging.firmness(found))


@_command("report", "report -o page.html", "report --notes docs/reproduction-notes.md --figures docs/figures.md")
def report(
    output: Annotated[Path, typer.Option("--output", "-o", help="Page to make (HTML).")] = Path("figures/report.html"),
    root: Annotated[Path, typer.Option(help="Folder with figures/ and data/.")] = Path("."),
    notes: Annotated[
        Path | None, typer.Option(help="Renew the table of readings in this file.", show_default=False)
    ] = None,
    figures: Annotated[
        Path | None,
        typer.Option(help="Renew the table of the captions' parameters in this file.", show_default=False),
    ] = None,
    beyond: Annotated[
        Path | None,
        typer.Option(help="Renew the tables of groups beyond the paper in this file.", show_default=False),
    ] = None,
) -> None:
    """Make the page that shows verdicts, figures and benchmarks. It needs no network."""
    from ..paper import report as reporting

    _loaded()

    typer.echo(str(reporting.write(output, root, keep=[file for file in (notes, figures, beyond) if file])))
    renewed = (notes, reporting.renew_notes), (figures, reporting.renew_figures), (beyond, reporting.renew_beyond)
    for file, renew in renewed:
        if file is not None:
            renew(file, root)


@_command("notebooks", "notebooks pile_dip -o elsewhere")
def notebooks(
    groups: Annotated[list[str] | None, typer.Argument(help="Figure groups; all of them if none is given.")] = None,
    params: Annotated[Path, typer.Option(help="Parameters of the reproduction.")] = Path("params.yaml"),
    reduced: Annotated[Path, typer.Option(help="Parameters that the notebooks begin with.")] = Path(
        "notebooks/reduced.yaml"
    ),
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of the notebooks.")] = Path("notebooks"),
) -> None:
    """Write a notebook for each figure group: its parameters, simulation, figures and captions."""
    from ..paper import notebooks as writing
    from ..paper.groups import NAMES

    _loaded()

    for path in writing.write(output, groups or NAMES, own=params, reduced=reduced):
        typer.echo(str(path))


@_command("archive", "archive -o slabs.zip")
def archive(
    output: Annotated[Path, typer.Option("--output", "-o", help="Archive to make (RO-Crate, zip).")] = Path(
        f"granular-response-{__version__}.zip"
    ),
    root: LockFolder = Path("."),
) -> None:
    """Archive the reproduction: datasets, figures, claims, sources and how each was made.

    Only what is as dvc.lock says goes in, so everything must be up to date.
    """
    from ..paper.archive import crate

    _loaded()

    names = crate.write(output, root)
    typer.echo(f"{output}: {len(names)} files, {output.stat().st_size / 1e6:.1f} MB")


@_command("restore granular-response-0.1.0.zip")
def restore(
    archive: Annotated[Path, typer.Argument(help="An archive of this project.", show_default=False)],
    root: LockFolder = Path("."),
) -> None:
    """Take the datasets out of an archive, in place of computing them.

    They must be those of dvc.lock; one that is there already stays.
    """
    from ..paper.archive import restore as restoring

    _loaded()

    restored = restoring.restore(archive, root)
    for path in restored:
        typer.echo(str(root / path))
    typer.echo(f"{archive}: {len(restored)} datasets restored, those there already are the same")


@_command("cite", "cite --bibtex >> references.bib")
def cite(
    bibtex: Annotated[bool, typer.Option("--bibtex", help="As BibTeX entries.")] = False,
) -> None:
    """Print how to cite the paper and this package."""
    typer.echo(BIBTEX if bibtex else f"The paper:\n  {PAPER}\n\nThis package:\n  {PACKAGE}")


@_command("version", name="version")
def print_version() -> None:
    """Print the version."""
    typer.echo(f"granular-response {__version__}")


#: Errors of a stream, which has no name.
_NOT_WRITTEN = (errno.EIO, errno.ENOSPC, errno.EFBIG, errno.EDQUOT)


def _speak_any_name() -> None:
    """Names of files are printed as they are, also those that the locale or Unicode cannot spell."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            if stream.encoding.lower().replace("-", "") in ("ascii", "ansi_x3.41968", "usascii", "utf8"):
                stream.reconfigure(encoding="utf-8", errors="surrogateescape")
            else:
                stream.reconfigure(errors="backslashreplace")


def _hush() -> None:
    """What standard output still holds goes nowhere, so that the end of the process does not try again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)


def _said(error: Exception) -> str | None:
    """The line for an error that a user can cause; None for a mistake in a program."""
    if isinstance(error, OSError) and error.filename is None and error.errno in _NOT_WRITTEN:
        _hush()
        return f"standard output cannot be written: {error.strerror}"
    if isinstance(error, MemoryError):
        return f"not enough memory: {error or 'the scene is too large'}"
    if isinstance(error, OSError) and error.filename is not None:  # a path that cannot be read or written
        return f"{error.filename}: {error.strerror}"
    cause = error.__cause__
    programming = type(error).__name__ == "SweepError" and cause and not isinstance(cause, GranularError)
    return str(error) if isinstance(error, GranularError) and not programming else None


def main() -> None:
    """Entry point. Expected errors are one line on standard error and exit code 2.

    Importing makes many objects and no garbage, so the collector waits for :func:`_loaded`; and what there is in the
    end goes with the process. Both take a tenth of a second and more off every command.
    """
    gc.disable()
    warnings.formatwarning = lambda message, *_, **__: f"granular-response: {message}\n"
    _speak_any_name()
    without_dask.hide()
    try:
        try:
            app()
        finally:
            if sys.stdout is not None:
                sys.stdout.flush()
    except BrokenPipeError:  # who was listening has gone
        _hush()
        sys.exit(1)
    except Exception as error:
        said = _said(error)
        if said is None:
            raise
        typer.echo(f"granular-response: {said}", err=True)
        sys.exit(2)
    finally:
        gc.freeze()
        gc.enable()
