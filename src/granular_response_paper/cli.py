"""The command line of the reproduction; what is heavy is imported inside the commands."""

from __future__ import annotations

from contextlib import suppress
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
#: Folders and files that several commands take.
Root = Annotated[Path, typer.Option(help="Folder of the checkout.")]
GroupData = Annotated[Path | None, typer.Option(help="Datasets of the group; data/GROUP.nc if not given.")]


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
    checkout.check(collection_of(group))
    try:
        with TerminalProgress() as progress:
            path = simulation.simulate(group, output, parameter_file=params, workers=workers, progress=progress)
    except KeyboardInterrupt:
        if count := simulation.finished(group, output):
            raise KeyboardInterrupt(f"{count} finished tasks are kept and are not run again") from None
        raise
    typer.echo(str(path))


@commands.command("draw pile_dip", "draw pile_dip --formats pdf,svg", "draw pile_dip --data other.nc -o other-figures")
def draw(
    group: Group,
    data: GroupData = None,
    output: Annotated[Path | None, output_option(help="Folder of the figures; figures/GROUP if not given.")] = None,
    formats: Annotated[str, typer.Option(help="Further formats beside PNG, separated by commas: pdf, svg.")] = "",
) -> None:
    """Draw the figures of a group."""
    from .pipeline import drawing

    loaded()
    checkout.check(collection_of(group))
    others = [name.strip() for name in formats.split(",") if name.strip()]
    for path in drawing.draw(group, data, output, others):
        typer.echo(str(path))


@commands.command("claims", "claims --list", "claims --list --figure 17")
def claims(
    data: Annotated[
        Path | None, typer.Option(help="Folder of the datasets; that of the collection if not given.")
    ] = None,
    output: Annotated[
        Path | None, output_option(help="Table of claims (JSON); figures/claims.json if not given.")
    ] = None,
    others: Annotated[
        Path | None,
        typer.Option(help="Summary of other preparations, left out if not there; extensions/summary.nc if not given."),
    ] = None,
    name: CollectionName = PAPER.name,
    every: Annotated[bool, typer.Option("--list", help="Print the stored table without judging again.")] = False,
    figure: Annotated[
        int | None, typer.Option(help="With --list: the claims of one figure of the paper alone.")
    ] = None,
) -> None:
    """Compare the claims with the stored datasets.

    A table with verdicts on groups whose datasets are not here is not overwritten.
    """
    from .claims import preparations as kept
    from .claims import table

    if figure is not None and not every:
        raise typer.BadParameter("must stand with --list: without it all claims are judged anew", param_hint="--figure")
    loaded()
    one = collection(name)
    output, data = output or one.here / table.OUTPUT, data or one.here / "data"
    if not every:
        checkout.check(one)
        kept.check(others or kept.OUTPUT)
        _keep_verdicts(output, [group for group in table.groups_read(one) if not (data / f"{group}.nc").exists()])
    found = table.read(output) if every else table.write(output, data, others or kept.OUTPUT, collection=one)
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


@commands.command("summary", "summary --data elsewhere/preparation.nc")
def summary(
    data: Annotated[
        Path | None, typer.Option(help="Datasets of the group preparation; those of the extensions if not given.")
    ] = None,
    output: Annotated[Path | None, output_option(help="Summary (netCDF); extensions/summary.nc if not given.")] = None,
) -> None:
    """Write the forces of the events of the slab in other preparations, which the claims read."""
    from .claims import preparations as writing
    from .claims.claim import PREPARATION

    loaded()
    checkout.check(collection_of(PREPARATION))
    typer.echo(str(writing.write(data or writing.SOURCE, output or writing.OUTPUT)))


@commands.command("groups", "groups --collection extensions")
def groups(name: CollectionName = PAPER.name, root: Root = Path(".")) -> None:
    """List the figure groups of a collection: figures, stored run time on two cores, question."""
    from granular_response.inputs import read_json

    from . import captions

    one, stored = collection(name), root / "benchmarks" / "pipeline.json"
    runs = read_json(stored)["runs"] if stored.exists() else []
    times = {row["stage"]: row["seconds"] for row in runs if row["collection"] == name}
    for group in one.groups:
        file = root / one.folder / "figures" / group / captions.FILE
        said = read_json(file) if file.exists() else {}  # a new group is not drawn yet
        numbers = sorted({entry["figure"] for entry in said.values() if entry.get("figure")})
        shown = f"Fig. {', '.join(map(str, numbers))}" if numbers else "-"
        parts = [times.get(f"{part}@{group}") for part in ("simulate", "draw")]
        seconds = f"{sum(filter(None, parts)):.0f} s" if None not in parts else "-"
        typer.echo(f"{group:26} {shown:22} {seconds:>6}  {captions.question(group)}")


@commands.command("reproduce", "reproduce --collection extensions", "reproduce --force")
def reproduce(
    name: CollectionName = PAPER.name,
    root: Root = Path("."),
    force: Annotated[bool, typer.Option("--force", help="Run every stage, also those that are up to date.")] = False,
) -> None:
    """Run every stage of a collection that is out of date, and show the progress."""
    from .pipeline import reproduce as running

    arguments = ["--force"] if force else []
    status = running.reproduce(collection(name), root, arguments=arguments, say=typer.echo)
    if status:
        raise typer.Exit(status)


@commands.command("report", "report --self-contained -o page.html", "report --fragments docs/_generated")
def report(
    output: Annotated[Path | None, output_option(help="Page to make (HTML); figures/report.html if not given.")] = None,
    root: Annotated[
        Path | None, typer.Option(help="Folder with figures/ and data/; that of the collection if not given.")
    ] = None,
    name: CollectionName = PAPER.name,
    embedded: Annotated[
        bool, typer.Option("--self-contained", help="Put the pictures into the page, which otherwise shows the files.")
    ] = False,
    fragments: Annotated[
        Path | None, typer.Option(help="Write the tables that documents include into this folder too.")
    ] = None,
) -> None:
    """Make the page that shows results, figures and verdicts. It needs no network."""
    from . import report as reporting

    loaded()
    one = collection(name)
    checkout.check(one)
    output, root = output or one.here / reporting.OUTPUT, root or one.here
    typer.echo(str(reporting.write(output, root, collection=one, embedded=embedded)))
    for path in reporting.write_fragments(fragments, root, collection=one) if fragments else ():
        typer.echo(str(path))


#: Entry point.
main = commands.run
