"""The command line of the reproduction; what is heavy is imported inside the commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from granular_response import __version__
from granular_response.cli.command_line import CommandLine, loaded, output_option

from .groups import NAMES

commands = CommandLine(
    "granular-response-paper",
    "The reproduction of the paper: simulations, figures, claims, the report.",
    "simulate pile_dip && granular-response-paper draw pile_dip",
    "claims --list",
)


Group = Annotated[str, typer.Argument(help="Figure group.", autocompletion=lambda: list(NAMES))]
#: Folders and files that several commands take.
LockFolder = Annotated[Path, typer.Option(help="Folder with dvc.lock.")]
SUMMARY = Path("extensions/summary.nc")
GroupData = Annotated[Path | None, typer.Option(help="Datasets of the group; data/GROUP.nc if not given.")]


@commands.command(
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
    output: Annotated[Path | None, output_option(help="Datasets (netCDF); data/GROUP.nc if not given.")] = None,
) -> None:
    """Run the simulations of a figure group.

    A run that was interrupted continues where it was.
    """
    from granular_response.api.terminal import TerminalProgress

    from .pipeline import simulation

    loaded()
    if before := simulation.finished(group, output):
        commands.say(
            f"{group}: {before} finished tasks are kept; those of this code and these parameters are not run again"
        )
    try:
        with TerminalProgress() as progress:
            path = simulation.simulate(
                group, output, parameter_file=params, workers=workers, scheduler=scheduler, progress=progress
            )
    except KeyboardInterrupt:
        if count := simulation.finished(group, output):
            commands.say(f"interrupted; {count} finished tasks are kept and are not run again")
        raise
    typer.echo(str(path))


@commands.command("draw pile_dip", "draw pile_dip --data other.nc -o other-figures")
def draw(
    group: Group,
    data: GroupData = None,
    output: Annotated[Path | None, output_option(help="Folder of the figures; figures/GROUP if not given.")] = None,
) -> None:
    """Draw the figures of a group."""
    from .pipeline import drawing

    loaded()
    for path in drawing.draw(group, data, output):
        typer.echo(str(path))


@commands.command("claims", "claims --list", "claims --readme README.md")
def claims(
    data: Annotated[Path, typer.Option(help="Folder of the datasets.")] = Path("data"),
    output: Annotated[Path, output_option(help="Table of claims (JSON).")] = Path("figures/claims.json"),
    others: Annotated[Path, typer.Option(help="Summary of other preparations; left out if it is not there.")] = SUMMARY,
    readme: Annotated[Path | None, typer.Option(help="Renew the counts that this file quotes.")] = None,
    every: Annotated[bool, typer.Option("--list", help="Print the stored table; judge nothing anew.")] = False,
) -> None:
    """Compare the paper's claims with the stored datasets."""
    from .claims import stored, table

    loaded()
    keep = [readme] if readme else []
    found = stored.read(output) if every else table.write(output, data, others, keep)
    if readme is not None:
        stored.renew(readme, found)
    for row in found["table"] if every else ():
        star = "*" if row["star"] else ""
        typer.echo(f"{row['id']:4} {row['verdict'] + star:15} {row['here']}")
        typer.echo(f"{'':20} {row['source'].capitalize()}, {row['place']}: {row['paper']}")
        for text in (row["cases"], row["preparations"] and f"Other preparations: {row['preparations']}"):
            if text:
                typer.echo(f"{'':20} {text}")
    typer.echo(f"{output}: {stored.quoted(found)}")


@commands.command("summary", "summary --data elsewhere/preparation.nc")
def summary(
    data: Annotated[Path, typer.Option(help="Datasets of the group preparation.")] = Path("data/preparation.nc"),
    output: Annotated[Path, output_option(help="Summary (netCDF).")] = SUMMARY,
) -> None:
    """Write what the claims read of other preparations of the slab: the forces of its events."""
    from .claims import summary as writing

    loaded()
    typer.echo(str(writing.write(data, output)))


@commands.command("groups")
def groups(root: Annotated[Path, typer.Option(help="Folder with figures/ and benchmarks/.")] = Path(".")) -> None:
    """List the figure groups: figures of the paper, and the seconds that simulation and drawing took on two cores."""
    from granular_response.inputs import read_json

    runs = {run["group"]: run for run in read_json(root / "benchmarks" / "pipeline.json")["runs"]}
    for name in NAMES:
        file = root / "figures" / name / "captions.json"
        captions = read_json(file) if file.exists() else {}  # a new group is not drawn yet
        numbers = sorted({one["figure"] for one in captions.values() if one.get("figure")})
        shown = f"Fig. {', '.join(map(str, numbers))}" if numbers else "beyond the paper"
        seconds = sum(runs[name][f"{part}_seconds"] for part in ("simulate", "draw")) if name in runs else None
        typer.echo(f"{name:28} {shown:26} {'-' if seconds is None else f'{seconds:.0f} s':>6}")


@commands.command(
    "report", "report -o page.html", "report --notes docs/reproduction-notes.md --figures docs/figures.md"
)
def report(
    output: Annotated[Path, output_option(help="Page to make (HTML).")] = Path("figures/report.html"),
    root: Annotated[Path, typer.Option(help="Folder with figures/ and data/.")] = Path("."),
    notes: Annotated[Path | None, typer.Option(help="Renew the table of interpretations in this file.")] = None,
    figures: Annotated[
        Path | None, typer.Option(help="Renew the table of the captions' parameters in this file.")
    ] = None,
    beyond: Annotated[
        Path | None, typer.Option(help="Renew the tables of groups beyond the paper in this file.")
    ] = None,
    data: Annotated[Path | None, typer.Option(help="Renew the table of stored datasets in this file.")] = None,
) -> None:
    """Make the page that shows verdicts, figures and benchmarks. It needs no network."""
    from . import report as reporting

    loaded()
    options = {"notes": notes, "figures": figures, "beyond": beyond, "data": data}
    documents = {kind: file for kind, file in options.items() if file is not None}
    typer.echo(str(reporting.write(output, root, keep=[*documents.values()])))
    for kind, file in documents.items():
        reporting.renew(kind, file, root)


@commands.command("notebooks", "notebooks pile_dip -o elsewhere")
def notebooks(
    groups: Annotated[
        list[str] | None,
        typer.Argument(help="Figure groups; all of them if none is given.", autocompletion=lambda: list(NAMES)),
    ] = None,
    params: Annotated[Path, typer.Option(help="Parameters of the reproduction.")] = Path("params.yaml"),
    reduced: Annotated[Path, typer.Option(help="Parameters that the notebooks begin with.")] = Path(
        "notebooks/reduced.yaml"
    ),
    output: Annotated[Path, output_option(help="Folder of the notebooks.")] = Path("notebooks"),
) -> None:
    """Write a notebook for each figure group: its parameters, simulation, figures and captions."""
    from . import notebooks as writing

    loaded()
    for path in writing.write(output, groups or NAMES, own=params, reduced=reduced):
        typer.echo(str(path))


@commands.command("archive", "archive -o slabs.zip")
def archive(
    output: Annotated[Path, output_option(help="Archive to make (RO-Crate, zip).")] = Path(
        f"granular-response-{__version__}.zip"
    ),
    root: LockFolder = Path("."),
) -> None:
    """Archive the reproduction: datasets, figures, claims, sources and how each was made.

    Only what is as dvc.lock says goes in, so everything must be up to date.
    """
    from .archive import crate

    loaded()
    names = crate.write(output, root)
    typer.echo(f"{output}: {len(names)} files, {output.stat().st_size / 1e6:.1f} MB")


@commands.command("restore granular-response-0.1.0.zip", "restore https://example.org/granular-response-0.1.0.zip")
def restore(
    archive: Annotated[str, typer.Argument(help="An archive of this project: a file, or its address.")],
    root: LockFolder = Path("."),
) -> None:
    """Take the datasets out of an archive, in place of computing them.

    They must be those of dvc.lock; one that is there already stays.
    """
    from .archive import restore as restoring

    loaded()
    with restoring.local(archive) as file:
        restored = restoring.restore(file, root)
    for path in restored:
        typer.echo(str(root / path))
    typer.echo(f"{archive}: {len(restored)} datasets restored, those there already are the same")


#: Entry point.
main = commands.run
