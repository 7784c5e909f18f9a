"""The command line. It knows arguments and messages; what is heavy is imported inside the commands."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import __version__
from ..errors import GranularError, SolveError
from .command_line import CommandLine, loaded, output_option

if TYPE_CHECKING:
    from ..api.terminal import TerminalProgress
    from ..solvers.solution import Solution

PAPER = (
    "C. Goldenberg and I. Goldhirsch, Effects of Friction and Disorder on the Quasi-Static Response of "
    "Granular Solids to a Localized Force, Phys. Rev. E 77, 041303 (2008), arXiv:0711.4243"
)
PACKAGE = (
    "granular-response: quasi-static response of two-dimensional granular solids to a localized force, "
    f"version {__version__}"
)

commands = CommandLine(
    "granular-response",
    "Quasi-static response of two-dimensional granular solids to a localized force.",
    "run examples/slab.yaml -o slab.nc",
    "show slab.nc",
)

#: Files and settings that several commands take.
StoredResult = Annotated[Path, typer.Argument(help="A stored result (netCDF).")]
ResultFile = Annotated[Path, output_option(help="Result (netCDF).")]
AllowUnsettled = Annotated[
    bool, typer.Option("--allow-unsettled", help="Exit with 0 even if a stored state has not settled.")
]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads for large packings, all cores if not given; results are bitwise the same."),
]


def _import(names: list[str] | None) -> None:
    """Import modules that register contact laws, of the current folder too, as ``python -m`` would."""
    sys.path.insert(0, "")
    for name in names or ():
        try:
            import_module(name)
        except GranularError as error:
            raise GranularError(f"--import {name}: {error}") from error
        except Exception as error:
            raise GranularError(f"--import {name}: {type(error).__name__}: {' '.join(str(error).split())}") from error
    sys.path.remove("")


Import = Annotated[
    list[str] | None,
    typer.Option("--import", help="Module that registers a contact law of the scene; repeated.", callback=_import),
]


def _example_names() -> list[str]:
    """Examples by name, for completion in a shell too."""
    return sorted(path.stem for path in _examples_folder().glob("*.yaml"))


def _examples_folder() -> Path:
    """In the package when it is installed, else beside the sources."""
    inside = Path(__file__).parents[1] / "examples"
    return inside if inside.exists() else Path(__file__).parents[3] / "examples"


@commands.command("example slab > slab.yaml", "example")
def example(
    name: Annotated[
        str | None, typer.Argument(help="Name of the scene; all names if left out.", autocompletion=_example_names)
    ] = None,
) -> None:
    """Print a scene to start from."""
    names = _example_names()
    if name is None:
        typer.echo("\n".join(names))
    elif name in names:
        typer.echo((_examples_folder() / f"{name}.yaml").read_text(encoding="utf-8"), nl=False)
    else:
        from ..scene import SceneError

        raise SceneError(f"{name}: no such example, must be {' or '.join(names)}")


def _keep(output: Path, solution: Solution, started: float, allow_unsettled: bool, said: str) -> None:
    """Store a solution. States that are still moving are kept too, but no success unless they were asked for."""
    from ..store import files as store
    from ..store.result import to_dataset

    replaced = f" (replaces an earlier {output.name})" if output.exists() else ""
    store.write(output, to_dataset(solution), {"wall_clock_seconds": time.perf_counter() - started}, keep=True)
    typer.echo(f"{output}: {said}, {time.perf_counter() - started:.1f} s{replaced}")
    for remark in solution.remarks:
        commands.say(f"{output}: {remark}")
    if solution.unsettled and not allow_unsettled:
        raise typer.Exit(1)


@contextmanager
def _computing(threads: int | None) -> Iterator[TerminalProgress]:
    """On so many threads, with a line of progress; on a terminal it is said where kernels are compiled."""
    from ..api.terminal import TerminalProgress, logged
    from ..machine.threads import cores, using

    loaded()
    say = commands.say if sys.stderr is not None and sys.stderr.isatty() else None
    with TerminalProgress() as progress, logged(progress, say), using(threads or cores()):
        yield progress


@commands.command(
    "run examples/slab.yaml -o slab.nc",
    "run scene.yaml -o scene-by-dynamics.nc --method dynamics",
    "run own-law.yaml -o own-law.nc --import my_laws",
)
def run(
    scene: Annotated[Path, typer.Argument(help="Scene file (YAML).")],
    output: ResultFile,
    method: Annotated[
        str | None, typer.Option(help="Solve by this method in place of the scene's: auto, dynamics, path or minimise.")
    ] = None,
    threads: Threads = None,
    allow_unsettled: AllowUnsettled = False,
    imported: Import = None,
) -> None:
    """Solve a scene and store the result.

    It settles under gravity and is then loaded; both states are stored with their certificate.
    """
    from ..scene import Scene, SceneError
    from ..store import files as store

    started = time.perf_counter()
    described = Scene.from_yaml(scene)
    if method is not None:
        described = described.updated({"protocol.method": method})
    store.check_writable(output, [scene, *described.files])

    from ..solvers.solution import solve_scene

    try:
        with _computing(threads) as progress:
            solution = solve_scene(described, progress=progress)
    except (SceneError, SolveError) as error:
        if not str(error).startswith(str(scene)):
            error.args = (f"{scene}: {error}", *error.args[1:])
        raise
    _keep(output, solution, started, allow_unsettled, f"{solution.problem.n} disks")


@commands.command(
    "continue slab.nc --to 2 -o slab-to-twice-the-load.nc",
    "continue slab.nc --to 0.5 --to 0 -o slab-unloaded.nc",
    name="continue",
)
def continue_(
    result: StoredResult,
    to: Annotated[list[float], typer.Option(help="Next load factor, larger or smaller than the last; repeated.")],
    output: ResultFile,
    folder: Annotated[Path, typer.Option(help="Folder of the scene file, for a packing from a table.")] = Path("."),
    threads: Threads = None,
    allow_unsettled: AllowUnsettled = False,
    imported: Import = None,
) -> None:
    """Continue a result to further loads.

    Stored states are kept. New ones are bitwise those of an uninterrupted run.
    """
    from ..store import files as store

    started = time.perf_counter()
    store.check_writable(output, [result])

    from ..scene import SceneError
    from ..solvers.solution import continue_solution
    from ..store.checked import read_result
    from ..store.result import ResultError, solution_from

    stored = read_result(result)
    try:
        solution = solution_from(stored, folder=folder)
        store.check_writable(output, solution.scene.files)
        with _computing(threads) as progress:
            solution = continue_solution(solution, to, progress=progress)
    except (ResultError, SceneError) as error:
        raise ResultError(f"{result}: {error}") from error
    factors = ", ".join(f"{factor:g}" for factor in solution.load_factors)
    _keep(output, solution, started, allow_unsettled, f"load factors {factors}")


@commands.command("show slab.nc", "show data/pile_dip.nc")
def show(file: Annotated[Path, typer.Argument(help="A stored result or study (netCDF).")]) -> None:
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


@commands.command(
    "plot slab.nc -o slab.pdf",
    "plot slab.nc -o chains.png --what forces --scale percentile",
    "plot slab.nc -o rest.png --what packing,forces --state 0",
    "plot growing.nc --animate growing.gif",
)
def plot(
    result: StoredResult,
    output: Annotated[Path | None, output_option(help="Picture to make: .pdf, .png or .svg.")] = None,
    what: Annotated[
        str | None,
        typer.Option(
            help="Pictures on the page, among response, floor, forces, contacts, stress, packing, photoelastic; if not "
            "given response,forces,contacts,stress, with floor for response where no force is applied."
        ),
    ] = None,
    state: Annotated[
        int, typer.Option(help="State: 0 for the initial equilibrium, then one for each load factor, -1 the last.")
    ] = -1,
    scale: Annotated[str, typer.Option(help="Scale of the forces: linear, sqrt or percentile.")] = "sqrt",
    animate: Annotated[
        Path | None,
        typer.Option(help="Animation to make: .gif, .webp, .html, or .mp4 with ffmpeg, a frame for each load."),
    ] = None,
) -> None:
    """Draw a result: response, force chains, contacts and stress on one page, or an animation of its loads."""
    from matplotlib.figure import Figure

    from ..plot import animation, pictures
    from ..store import atomic
    from ..store.checked import read_result

    loaded()
    if output is None and animate is None:
        raise pictures.PictureError("nothing to draw: --output or --animate must be given")
    stored = read_result(result)
    if output is not None:
        typer.echo(str(pictures.save(stored, output, what, state=state, scale=scale, inputs=[result])))
    if animate is not None:
        atomic.check_output(animate, [result])
        animation.animate(stored, output=animate, figure=Figure())
        typer.echo(str(animate))


@commands.command("keys", "keys protocol")
def keys(
    part: Annotated[str, typer.Argument(help="Beginning of the keys, such as contact.")] = "", imported: Import = None
) -> None:
    """Print the keys of a scene file: default, what is allowed, unit and meaning."""
    from . import scene_reference

    typer.echo(scene_reference.plain(part))


@commands.command(
    "export slab.nc -o slab.gsd", "export slab.nc -o rest.vtu --state 0", "export slab.nc -o slab.events.csv"
)
def export(
    result: StoredResult,
    output: Annotated[Path, output_option(help="File to make; its extension is the format.")],
    state: Annotated[
        int | None,
        typer.Option(
            help="Write this state alone: 0 for the initial equilibrium, -1 the last one. If not given, all states, or "
            "the last one in formats of one state."
        ),
    ] = None,
) -> None:
    """Write a result for OVITO, ParaView or LAMMPS, or as a table.

    OVITO: .gsd, .xyz; ParaView: .pvd, .vtu; LAMMPS: .lammps (input script), .data, .dump. Tables: .csv
    (disks), .contacts.csv, .events.csv.
    """
    from ..store import export as exporting

    typer.echo(str(exporting.export(result, output, state=state)))


@commands.command("cite", "cite --bibtex >> references.bib")
def cite(bibtex: Annotated[bool, typer.Option("--bibtex", help="As BibTeX entries.")] = False) -> None:
    """Print how to cite the paper and this package."""
    if bibtex:
        typer.echo(Path(__file__).with_name("cite.bib").read_text("utf-8").replace("$version", __version__), nl=False)
    else:
        typer.echo(f"The paper:\n  {PAPER}\n\nThis package:\n  {PACKAGE}")


@commands.command("version", name="version")
def print_version() -> None:
    """Print the version."""
    commands.print_version()


#: Entry point.
main = commands.run
