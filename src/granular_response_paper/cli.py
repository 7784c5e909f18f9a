"""The command line of the reproduction; what is heavy is imported inside the commands."""

from __future__ import annotations

from contextlib import nullcontext, suppress
from pathlib import Path
from typing import Annotated

import typer

from granular_response.cli.command_line import CommandLine, loaded, output_option

from . import checkout
from .registry import PAPER, collection, collection_of, collections

commands = CommandLine(
    "granular-response-paper",
    "The reproduction of the paper: simulations, figures, claims, the report.",
    "simulate pile_dip && granular-response-paper draw pile_dip",
    "claims --list",
)


def _every_group() -> list[str]:
    return [name for one in collections() for name in one.groups]


Group = Annotated[str, typer.Argument(help="Figure group.", autocompletion=_every_group)]
CollectionName = Annotated[
    str,
    typer.Option(
        "--collection",
        help="The paper, or another collection of figure groups.",
        autocompletion=lambda: [one.name for one in collections()],
    ),
]


@commands.command(
    "simulate frictionless_crossover",
    "simulate polydisperse_averages --workers 8",
    "simulate pile_dip --params other.yaml -o other.nc",
)
def simulate(
    group: Group,
    workers: Annotated[
        int | None,
        typer.Option(min=1, envvar="GRANULAR_RESPONSE_WORKERS", help="Local processes; all cores if not given."),
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
    try:
        with checkout.unchanged(collection_of(group)), TerminalProgress() as progress:
            path = simulation.simulate(group, output, parameter_file=params, workers=workers, progress=progress)
    except KeyboardInterrupt:
        if count := simulation.finished(group, output):
            raise KeyboardInterrupt(f"{count} finished tasks are kept and are not run again") from None
        raise
    typer.echo(str(path))


@commands.command("draw pile_dip", "draw pile_dip --formats pdf,svg", "draw pile_dip --data other.nc -o other-figures")
def draw(
    group: Group,
    data: Annotated[Path | None, typer.Option(help="Datasets of the group; data/GROUP.nc if not given.")] = None,
    output: Annotated[Path | None, output_option(help="Folder of the figures; figures/GROUP if not given.")] = None,
    formats: Annotated[str, typer.Option(help="Further formats beside PNG, separated by commas: pdf, svg.")] = "",
) -> None:
    """Draw the figures of a group."""
    from .pipeline import drawing

    loaded()
    others = [name.strip() for name in formats.split(",") if name.strip()]
    with checkout.unchanged(collection_of(group)):
        paths = drawing.draw(group, data, output, others)
    for path in paths:
        typer.echo(str(path))


@commands.command("claims", "claims --list", "claims --figure 17")
def claims(
    data: Annotated[
        Path | None, typer.Option(help="Folder of the datasets; that of the collection if not given.")
    ] = None,
    output: Annotated[
        Path | None, output_option(help="Table of claims (JSON); figures/claims.json if not given.")
    ] = None,
    name: CollectionName = PAPER.name,
    every: Annotated[bool, typer.Option("--list", help="Print the stored table without judging again.")] = False,
    figure: Annotated[int | None, typer.Option(help="Print the stored claims on this figure of the paper.")] = None,
) -> None:
    """Compare the claims with the stored datasets.

    A table with verdicts on groups whose datasets are not here is not overwritten. The stored table of the extensions
    comes with the summary of other preparations, which the claims of the paper read.
    """
    from .claims import preparations as kept
    from .claims import table
    from .claims.claim import PREPARATION

    loaded()
    one, every = collection(name), every or figure is not None
    source = one.here / kept.SOURCE.relative_to(kept.OUTPUT.parent)
    summarised = PREPARATION in one.groups and not every and data is output is None and source.exists()
    output, data = output or one.here / table.OUTPUT, data or one.here / "data"
    with nullcontext() if every else checkout.unchanged(one):
        if not every:
            kept.check()
            _keep_verdicts(output, [group for group in table.groups_read(one) if not (data / f"{group}.nc").exists()])
        found = table.read(output) if every else table.write(output, data, kept.OUTPUT, collection=one)
    if summarised:
        typer.echo(str(kept.write(source, one.here / kept.OUTPUT.name)))
    rows = [row for row in found["table"] if figure is None or figure in row["figures"]]
    if every and not rows:
        typer.echo(f"no claim on figure {figure}")
    for row in rows if every else ():
        star = "*" if row["star"] else ""
        typer.echo(f"{row['id']:4} {row['verdict'] + star:15} {row['here']}")
        typer.echo(f"{'':20} {row['source'].capitalize()}, {row['place']}: {row['paper']}")
        elsewhere = (f"Other {what}: {row[what]['text']}." for what in ("gravity", "lattice") if row[what]["of"])
        for text in filter(None, (row["cases"], *elsewhere)):
            typer.echo(f"{'':20} {text}")
    typer.echo(f"{output}: {table.quoted(found)}")


def _keep_verdicts(output: Path, absent: list[str]) -> None:
    """Raises ClaimsError if a table has verdicts on groups whose datasets are ``absent``: they would be lost."""
    from .claims import table
    from .claims.claim import ClaimsError

    rows = []
    with suppress(ClaimsError):  # what is no table has none
        rows = table.read(output)["table"]
    judged = {row["group"] for row in rows if row["verdict"] != "not measured"}
    if lost := [group for group in absent if group in judged]:
        some = ", ".join(lost[:3]) + (f" and {len(lost) - 3} more" if len(lost) > 3 else "")
        raise ClaimsError(
            f"{output}: has verdicts on groups without datasets here ({some}) and stays as it is; make these with make "
            "reproduce, or give another --output"
        )


@commands.command("reproduce", "reproduce --collection extensions", "reproduce --force", "reproduce --group pile_dip")
def reproduce(
    name: CollectionName = PAPER.name,
    group: Annotated[str, typer.Option(help="Simulate and draw this figure group alone.")] = "",
    force: Annotated[bool, typer.Option("--force", help="Run every stage, also those that are up to date.")] = False,
) -> None:
    """Run every stage of a collection that is out of date, and show the progress."""
    from .pipeline import reproduce as running

    arguments, one = ["--force"] if force else [], collection_of(group) if group else collection(name)
    if status := running.reproduce(one, Path(), group=group, arguments=arguments, say=typer.echo):
        raise typer.Exit(status)


@commands.command("report", "report --fragments docs/_generated")
def report(
    name: CollectionName = PAPER.name,
    fragments: Annotated[
        Path | None, typer.Option(help="Write the tables that documents include into this folder too.")
    ] = None,
) -> None:
    """Make the page that shows results, figures and verdicts, figures/report.html. It needs no network."""
    from . import report as reporting

    loaded()
    one = collection(name)
    with checkout.unchanged(one):
        typer.echo(str(reporting.write(one.here, collection=one)))
        for path in reporting.write_fragments(fragments, one.here, collection=one) if fragments else ():
            typer.echo(str(path))


#: Entry point.
main = commands.run
