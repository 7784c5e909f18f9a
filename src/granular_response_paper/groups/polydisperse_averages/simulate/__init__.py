"""Ensembles of polydisperse slabs under a growing force: Figs. 2, 19, 20 and 21 (Sec. VI), claims D1 to D5 and D7.

A *case* is a polydispersity, a coefficient of friction (of the walls too), a lattice constant of the start and a list
of growing forces; it has several realizations of the radii. One task settles one realization under gravity and
then loads it through all forces of its case (``realizations``), so a packing is settled once.

What becomes of a realization at each force is stored: ``at_rest``; ``collapsed``, where the load has pushed its
disk down by more than ``collapse_depth``, so that the packing is not the one that was prepared; ``failed``, where no
rest was found; ``not_reached`` after either. Averages are over those at rest, with their number beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.floor import smoothed_response
from granular_response.scene import Scene, SceneError
from granular_response.solvers.problem import Problem
from granular_response.state import FloatArray
from granular_response.store.variables import RADII, WEIGHTS
from granular_response.studies import linear_end
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import AT_REST, at_rest, datasets, smoothed
from granular_response_paper.ensembles.parameters import Case
from granular_response_paper.ensembles.realizations import Loaded, Realization, ensemble_task
from granular_response_paper.groups.polydisperse_averages.parameters import Individual, LinearRange, Parameters
from granular_response_paper.records import axes, column, columns, record, table, variables
from granular_response_paper.slab_response import states_picture
from granular_response_paper.tasks import computed

#: What tells the cases of a figure apart.
OF_CASE = ("polydispersity", "friction", "lattice_constant")


@record
class Small:
    """The response of one packing to small forces."""

    response_at_centre: FloatArray = column(
        "smoothed response at x = 0 in 1/mean radius: stress per applied force", "force"
    )
    outcome: NDArray[np.int8] = column("what became of the packing", "force")
    by_motion: FloatArray = column(columns(Loaded)["by_motion"].long_name, "force")
    ends: tuple[float, float]  #: forces between which the response ceases to be constant

    @classmethod
    def of(cls, forces: FloatArray, found: Realization, width: float, tolerance: float) -> Small:
        """With a Gaussian of ``width``."""
        centre = np.full(len(forces), np.nan)
        for s in np.flatnonzero(found.outcome == AT_REST):
            centre[s] = smoothed_response([0.0], found.x, found.floor_response[s], width)[0]
        return cls(centre, found.outcome, found.loaded.by_motion, linear_end(forces, centre, tolerance))


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles``, ``averages``, ``individual``, ``packings``, ``linear_range`` and ``forces``."""
    asked, cases, picture, linear = parameters, parameters.columns, parameters.forces_picture, parameters.linear_range
    tasks: dict[tuple[str, int, int], partial[Realization]] = {
        ("ensembles", *place): ensemble_task(asked, cases[place[0]], place[1]) for place in datasets.places(cases)
    }
    shown = "ensembles", asked.pictured[0], picture.realization
    tasks[shown] = partial(tasks[shown], keep=(picture.force,))
    grid = [(delta, mu) for delta in linear.polydispersities for mu in linear.frictions]
    for k, (delta, mu) in enumerate(grid):
        case = Case(delta, mu, asked.start(delta), linear.forces, 1, wall_friction=0.0)
        tasks["linear range", k, 0] = ensemble_task(asked, case, 0)

    done = computed(tasks, "realizations")
    found = {place: done["ensembles", *place] for place in datasets.places(cases)}
    ensembles = datasets.ensembles_dataset(cases, found)
    half = round(asked.reach / asked.spacing)
    x = np.arange(-half, half + 1, dtype=float) * asked.spacing
    made = {
        "ensembles": ensembles,
        "averages": _averages(ensembles, x, asked.widths),
        "individual": _individual(ensembles, asked.individual, x),
        "packings": datasets.packings_dataset(cases, found),
        "linear_range": _linear_range(linear, grid, [done["linear range", k, 0] for k in range(len(grid))]),
        "forces": _forces_dataset(tasks[shown].args[0], done[shown], picture.polydispersity),
    }
    return labelled(made, next(iter(tasks.values())).args[0])


def _averages(ensembles: xr.Dataset, x: FloatArray, widths: Sequence[float]) -> xr.Dataset:
    """Fig. 21: mean smoothed responses; a standard error needs two realizations, and is nan below."""
    cases, steps = ensembles.sizes["case"], ensembles.sizes["step"]
    mean = np.full((len(widths), cases, steps, len(x)), np.nan)
    error = mean.copy()
    count = np.zeros((cases, steps), np.int32)
    for w, width in enumerate(widths):
        for c in range(cases):
            responses = smoothed(ensembles.isel(case=c), x, width)
            for s in range(steps):
                rows = at_rest(responses, s)
                count[c, s] = len(rows)
                if len(rows):
                    mean[w, c, s] = rows.mean(axis=0)
                if len(rows) > 1:
                    error[w, c, s] = rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
    dims, per = "width case step x", "in 1/mean radius: vertical stress on the floor per applied force"
    data = variables(
        mean=(dims, mean, f"ensemble mean of the smoothed response {per}"),
        standard_error=(dims, error, f"standard error of the mean {per}"),
        count_at_rest=("case step", count, "realizations that are at rest"),
    )
    coordinates = axes(
        width=(widths, f"width w of the smoothing Gaussian {RADII}"), x=(x, f"distance from the loaded disk {RADII}")
    )
    kept = {name: ensembles[name].variable for name in (*OF_CASE, "realizations")}
    return xr.Dataset(data | {"force": ensembles["force"].variable}, coordinates | kept)


def _individual(ensembles: xr.Dataset, shown: Individual, x: FloatArray) -> xr.Dataset:
    """Fig. 19: smoothed responses of single realizations at one force, of every start that has a case.

    nan where there are fewer realizations at rest than asked for.
    """
    force, most, width = shown.force, shown.realizations, shown.width
    alike = ensembles["polydispersity"].values == shown.polydispersity
    alike &= np.isin(ensembles["friction"].values, shown.frictions)
    cases = np.flatnonzero(alike & (ensembles["force"].values == force).any(axis=1))
    response = np.full((len(cases), most, len(x)), np.nan)
    for k, case in enumerate(cases):
        step = int(np.flatnonzero(ensembles["force"].values[case] == force)[0])
        rows = at_rest(smoothed(ensembles.isel(case=int(case)), x, width), step)[:most]
        response[k, : len(rows)] = rows
    kept = {name: ensembles[name].isel(case=cases).variable for name in OF_CASE}
    return xr.Dataset(
        variables(
            response=("case realization x", response, "smoothed response in 1/mean radius: stress per applied force"),
            force=("", force, f"applied force {WEIGHTS}"),
            width=("", width, f"width w of the smoothing Gaussian {RADII}"),
        ),
        coords=axes(x=(x, f"distance from the loaded disk {RADII}")) | kept,
    )


def _linear_range(asked: LinearRange, grid: Sequence[tuple[float, float]], found: Sequence[Realization]) -> xr.Dataset:
    """Smoothed response at x = 0 against the force, one packing each, and where it ceases to be constant."""
    forces = np.array(asked.forces)
    each = [Small.of(forces, one, asked.width, asked.tolerance) for one in found]
    below = f"differs by less than {asked.tolerance:.0%} from that to the smallest force"
    until, beyond = zip(*(one.ends for one in each), strict=True)
    ends = variables(
        linear_until=("path", until, f"last force {WEIGHTS} at which the response {below}"),
        nonlinear_from=("path", beyond, f"first force {WEIGHTS} at which it does not; nan for none"),
    )
    deltas, frictions = zip(*grid, strict=True)
    coordinates = variables(
        polydispersity=("path", deltas, "delta: spread of the radii"),
        friction=("path", frictions, "coefficient of friction, walls frictionless"),
        force=("force", asked.forces, f"applied force {WEIGHTS}"),
    )
    found_at = table(each, "path").assign(ends).assign_coords(coordinates)
    return found_at.assign_attrs(width=asked.width, tolerance=asked.tolerance)


def _forces_dataset(scene: Scene, found: Realization, polydispersity: float) -> xr.Dataset:
    """The states of Fig. 2: at rest, and under load."""
    if len(found.states) != 2:
        raise SceneError(f"forces_picture: the realization does not reach its force ({found.message or 'collapsed'})")
    problem = Problem.from_scene(scene).with_loads(found.states[0].position)
    return states_picture(found.states, problem, of=None).assign(
        variables(
            polydispersity=("", polydispersity, "delta: spread of the radii"),
            friction=("", scene.contact.friction, "coefficient of friction, walls included"),
        )
    )
