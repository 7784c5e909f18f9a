"""Ensembles of polydisperse slabs under a growing force: Figs. 2, 19, 20 and 21 (Sec. VI), claims D1 to D5 and D7.

A *case* is a polydispersity, a coefficient of friction (of the walls too), a lattice constant of the start and a list
of growing forces; it has several realizations of the radii. One task settles one realization under gravity and
then loads it through all forces of its case, so a packing is settled once. Without friction each load is followed
by minimisation, with friction by stages (``solve.stages``), unless ``method`` asks for the paper's protocol,
dynamics from rest to each force.

What becomes of a realization at each force is stored: ``at_rest``; ``collapsed``, where the load has pushed its
disk down by more than ``collapse_depth``, so that the packing is not the one that was prepared; ``failed``, where no
rest was found; ``not_reached`` after either. Averages are over those at rest, with their number beside them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe import network
from granular_response.observe.floor import floor_disks, floor_force, smoothed_response
from granular_response.paper.datasets import labelled
from granular_response.paper.groups.polydisperse_averages.parameters import Case, Individual, Parameters
from granular_response.scene import Scene, SceneError
from granular_response.solve import SOLVE_ERRORS, Problem, loaded_states
from granular_response.solve.choice import load_method
from granular_response.solve.stages import Collapsed, climb
from granular_response.solve.timestep import stability_limit
from granular_response.state import State
from granular_response.store.result import FORCE, LENGTH, common_candidates, states_dataset, variable
from granular_response.sweeps.rest import rest_state
from granular_response.sweeps.tasks import Progress, map_tasks

FloatArray = NDArray[np.float64]

AT_REST, COLLAPSED, FAILED, NOT_REACHED = 0, 1, 2, 3
OUTCOMES = ("at_rest", "collapsed", "failed", "not_reached")

#: Bins of the contact angles over half a turn.
ANGLE_BINS = 36

#: What is counted on a packing at rest, with long names.
PACKING = {
    "coordination_number": "mean number of contacts between disks",
    "coordination_number_bulk": "mean number of contacts of a disk 10 radii off the side walls, 4 off floor and top",
    "coordination_number_with_walls": "mean number of contacts of a disk, walls included",
    "coordination_number_bearing": "mean number of contacts between disks that bear load",
    "horizontal_contacts": "contacts of disks within 30 degrees of the horizontal, per number of disks",
    "oblique_contacts": "contacts of disks more than 30 degrees from the horizontal, per number of disks",
    "loose_disks": "disks with fewer than two contacts",
    "force_residual": f"largest unbalanced force on a disk at rest {FORCE}",
    "torque_residual": "largest unbalanced torque on a disk at rest, in mean weight times mean radius",
    "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit at rest {FORCE}",
    "negative_modes": "unstable directions of the tangent stiffness at rest",
    "largest_overlap": f"largest overlap of two disks at rest {LENGTH}",
    "settling_steps": "time steps of the fall to rest",
}

#: What is measured on a loaded state, with long names.
LOADED = {
    "sink": f"how far the load has pushed its disk down {LENGTH}",
    "largest_displacement": f"largest displacement of a disk since rest {LENGTH}",
    "force_residual": f"largest unbalanced force on a disk under load {FORCE}",
    "torque_residual": "largest unbalanced torque on a disk under load, in mean weight times mean radius",
    "coulomb_excess": f"largest excess of a tangential force over the Coulomb limit under load {FORCE}",
    "negative_modes": "unstable directions of the tangent stiffness under load",
    "static_until": f"force up to which the stage that ends here was solved by statics, dynamics after it {FORCE}",
}


@dataclass(frozen=True)
class Task:
    """One realization through all forces of its case."""

    scene: Scene  #: with one load, of unit force
    forces: tuple[float, ...]
    collapse_depth: float
    ramp_time: float  #: of a stage, or longer so that the load grows no faster than ``largest_rate``
    largest_rate: float
    stop_kinetic_energy: float  #: under load
    keep: tuple[float, ...] = ()  #: forces whose states are handed back


@dataclass(frozen=True)
class Realization:
    """What is left of a task; arrays along force are nan after its end."""

    x: FloatArray  #: (k,) rest position of the floor disks from the loaded disk
    rest_force: FloatArray  #: (k,) vertical floor force at rest
    response: FloatArray  #: (forces, k)
    outcome: NDArray[np.int8]  #: (forces,)
    loaded: Mapping[str, FloatArray]  #: LOADED, each (forces,)
    packing: Mapping[str, float]  #: PACKING
    angle_density: FloatArray  #: (bins,)
    message: str = ""  #: why it failed
    states: tuple[State, ...] = field(default=(), compare=False)  #: rest, then the kept ones


def realize(task: Task) -> Realization:
    """Settle a packing and load it. What fails is part of the result."""
    count = len(task.forces)
    outcome = np.full(count, NOT_REACHED, np.int8)
    loaded = {name: np.full(count, np.nan) for name in LOADED}
    message = ""
    try:
        problem = Problem.from_scene(task.scene)
        rest = rest_state(problem)
    except SOLVE_ERRORS as error:
        none = np.zeros(0)
        outcome[:1] = FAILED
        return Realization(
            x=none,
            rest_force=none,
            response=np.zeros((count, 0)),
            outcome=outcome,
            loaded=loaded,
            packing=dict.fromkeys(PACKING, np.nan),
            angle_density=np.full(ANGLE_BINS, np.nan),
            message=f"gravity: {error}",
        )
    problem = problem.with_loads(rest.position)
    disk = int(problem.load_disk[0])
    loading = _Loading(task, problem, rest)
    states: list[State] = []
    for k, force in enumerate(task.forces):
        try:
            state, until = loading.to(force)
        except Collapsed as collapse:
            outcome[k], loaded["sink"][k] = COLLAPSED, rest.position[disk, 1] - collapse.height
            break
        except SOLVE_ERRORS as error:
            outcome[k], message = FAILED, f"force {force:g}: {error}"
            break
        moved = state.position - rest.position
        certificate = state.certificate
        values = {
            "sink": -moved[disk, 1],
            "largest_displacement": np.hypot(moved[:, 0], moved[:, 1]).max(),
            "static_until": until,
            **{name: getattr(certificate, name) for name in LOADED if hasattr(certificate, name)},
        }
        for name in LOADED:
            loaded[name][k] = values[name]
        if values["sink"] > task.collapse_depth:
            outcome[k] = COLLAPSED
            break
        outcome[k] = AT_REST
        states.append(state)
    disks = floor_disks([rest, *states], np.flatnonzero(problem.packing.row == 0))
    at_rest = floor_force(rest, disks)
    response = np.full((count, len(disks)), np.nan)
    for k, one in enumerate(states):
        response[k] = (floor_force(one, disks) - at_rest) / task.forces[k]
    kept = tuple(states[k] for k in range(len(states)) if task.forces[k] in task.keep)
    return Realization(
        x=rest.position[disks, 0] - rest.position[disk, 0],
        rest_force=at_rest,
        response=response,
        outcome=outcome,
        loaded=loaded,
        packing=_packing_numbers(problem, rest),
        angle_density=network.contact_angle_histogram(rest, ANGLE_BINS)[1],
        message=message,
        states=(rest, *kept) if task.keep else (),
    )


class _Loading:
    """The growing load on one packing."""

    def __init__(self, task: Task, problem: Problem, rest: State) -> None:
        scene = problem.scene.updated({"protocol.stop_kinetic_energy": task.stop_kinetic_energy})
        self.task, self.rest, self.state = task, rest, rest
        self.problem = replace(problem, scene=scene)
        self.method = load_method(self.problem).method
        self.lowest = float(rest.position[int(problem.load_disk[0]), 1]) - task.collapse_depth
        self.statics = True

    def to(self, force: float) -> tuple[State, float]:
        """The state under ``force`` and the force up to which statics led; raises what ``climb`` raises."""
        if self.method == "dynamics":
            return loaded_states(self.problem, self.rest, [force])[1][0], 0.0
        before = self.state.load_factor
        if self.method != "stages":
            self.state = loaded_states(self.problem, self.state, [force])[1][0]
            return self.state, (force if self.state.reached.relaxation_steps is None else before)
        self.state, stage = climb(
            self.problem,
            self.state,
            force,
            ramp_time=max(self.task.ramp_time, (force - before) / self.task.largest_rate),
            statics=self.statics,
            lowest=self.lowest,
        )
        # where statics has failed once it mostly fails at every larger force
        self.statics = self.statics and stage.static
        return self.state, stage.static_until


def _packing_numbers(problem: Problem, rest: State) -> dict[str, float]:
    count = rest.position.shape[0]
    touching = rest.pairs.touching
    horizontal = np.abs(np.abs(rest.pair_normal()[touching, 0])) > np.cos(np.pi / 6.0)
    certificate = rest.certificate
    bulk = network.bulk_disks(rest, problem.packing.width, min(10.0, 0.2 * problem.packing.width))
    return {
        "coordination_number": network.coordination_number(rest),
        "coordination_number_bulk": network.coordination_number(rest, bulk) if bulk.any() else float("nan"),
        "coordination_number_with_walls": network.coordination_number(rest, walls=True),
        "coordination_number_bearing": network.coordination_number(rest, without_rattlers=True),
        "horizontal_contacts": np.count_nonzero(horizontal) / count,
        "oblique_contacts": np.count_nonzero(~horizontal) / count,
        "largest_overlap": float(rest.pairs.overlap.max()),
        "settling_steps": float(rest.reached.steps or 0),
        **{
            name: float(getattr(certificate, name))
            for name in ("loose_disks", "force_residual", "torque_residual", "coulomb_excess", "negative_modes")
        },
    }


def ensemble_scene(
    parameters: Parameters, case: Case, realization: int, *, wall_friction: float | None = None
) -> Scene:
    """The scene of one realization of a case.

    The time step is ``time_step_part`` of the stability limit of its lightest disk, at most
    ``longest_time_step``: without friction the limit is far beyond what the collisions of the fall need.
    """
    scene = parameters.base.updated(
        {
            "packing.polydispersity": case.polydispersity,
            "packing.lattice_constant": case.lattice_constant,
            "packing.realization": realization,
            "contact.friction": case.friction,
            "wall.friction": case.friction if wall_friction is None else wall_friction,
        }
    )
    limit = stability_limit(Problem.from_scene(scene), smallest=True)
    step = min(parameters.time_step_part * limit, parameters.longest_time_step)
    return scene.updated({"protocol.time_step": step})


def simulate(
    parameters: Parameters, *, workers: int | None = None, progress: Progress | None = None
) -> dict[str, xr.Dataset]:
    """Datasets ``ensembles``, ``averages``, ``individual``, ``packings``, ``linear_range`` and ``forces``."""
    cases, picture, linear = parameters.columns, parameters.forces_picture, parameters.linear_range
    loading = parameters.loading
    usual = (parameters.collapse_depth, loading.ramp_time, loading.largest_rate, loading.stop_kinetic_energy)
    tasks: list[Task] = []
    shown = -1
    for case in cases:
        for realization in range(case.realizations):
            task = Task(ensemble_scene(parameters, case, realization), case.forces, *usual)
            asked = (picture.polydispersity, picture.friction, picture.realization)
            this = (case.polydispersity, case.friction, realization)
            if shown < 0 and this == asked and picture.force in case.forces:
                shown = len(tasks)
                task = replace(task, keep=(picture.force,))
            tasks.append(task)
    grid = [(delta, mu) for delta in linear.polydispersities for mu in linear.frictions]
    for delta, mu in grid:
        case = Case(delta, mu, parameters.lattice_constant, linear.forces, 1)
        task = Task(ensemble_scene(parameters, case, 0, wall_friction=0.0), linear.forces, *usual)
        tasks.append(replace(task, ramp_time=linear.ramp_time))

    found = map_tasks(realize, tasks, workers=workers, progress=progress, what="realizations")
    ensemble, single = found[: len(found) - len(grid)], found[len(found) - len(grid) :]
    ensembles = _ensembles_dataset(cases, ensemble)
    half = round(parameters.reach / parameters.spacing)
    x = np.arange(-half, half + 1, dtype=float) * parameters.spacing
    datasets = {
        "ensembles": ensembles,
        "averages": averages_dataset(ensembles, x, widths=parameters.widths, few=parameters.few),
        "individual": individual_dataset(ensembles, parameters.individual, x),
        "packings": _packings_dataset(cases, ensemble),
        "linear_range": _linear_range_dataset(grid, linear.forces, single, linear.width, linear.tolerance),
        "forces": _forces_dataset(tasks[shown], found[shown], picture.polydispersity),
    }
    return labelled(datasets, tasks[0].scene)


def _case_coordinates(cases: Sequence[Case]) -> dict[str, xr.Variable]:
    lattice = [str(case.lattice_constant) for case in cases]
    return {
        "polydispersity": variable(("case",), [c.polydispersity for c in cases], "delta: spread of the radii"),
        "friction": variable(("case",), [c.friction for c in cases], "coefficient of friction, walls included"),
        "lattice_constant": variable(
            ("case",), lattice, f"distance of neighbours before gravity acts {LENGTH}, or how it is chosen"
        ),
        "realizations": variable(("case",), [c.realizations for c in cases], "number of packings"),
    }


def _ensembles_dataset(cases: Sequence[Case], found: Sequence[Realization]) -> xr.Dataset:
    """Every realization of every case; what a case does not have is nan, or NOT_REACHED."""
    most = max(case.realizations for case in cases)
    steps = max(len(case.forces) for case in cases)
    slots = max(one.x.size for one in found)
    shape = (len(cases), most, steps)
    force = np.full((len(cases), steps), np.nan)
    x = np.full((len(cases), most, slots), np.nan)
    rest_force = np.full_like(x, np.nan)
    response = np.full((*shape, slots), np.nan)
    outcome = np.full(shape, NOT_REACHED, np.int8)
    loaded = {name: np.full(shape, np.nan) for name in LOADED}
    message = np.full((len(cases), most), "", dtype=object)
    left = iter(found)
    for c, case in enumerate(cases):
        k = len(case.forces)
        force[c, :k] = case.forces
        for r in range(case.realizations):
            one = next(left)
            x[c, r, : one.x.size], rest_force[c, r, : one.x.size] = one.x, one.rest_force
            response[c, r, :k, : one.x.size] = one.response
            outcome[c, r, :k] = one.outcome
            message[c, r] = one.message
            for name in LOADED:
                loaded[name][c, r, :k] = one.loaded[name]
    dims = ("case", "realization", "step")
    data = {
        "force": variable(("case", "step"), force, f"applied force {FORCE}"),
        "x": variable(
            ("case", "realization", "slot"), x, f"rest position of a floor disk from the loaded disk {LENGTH}"
        ),
        "floor_force_rest": variable(
            ("case", "realization", "slot"), rest_force, f"vertical floor force at rest {FORCE}"
        ),
        "floor_response": variable(
            (*dims, "slot"), response, "vertical floor force that the load adds, per applied force"
        ),
        "outcome": variable(
            dims,
            outcome,
            "what became of the realization",
            flag_values=np.arange(len(OUTCOMES), dtype=np.int8),
            flag_meanings=" ".join(OUTCOMES),
        ),
        "message": variable(("case", "realization"), message.astype(str), "why a realization failed"),
        **{name: variable(dims, loaded[name], text) for name, text in LOADED.items()},
    }
    return xr.Dataset(data, coords=_case_coordinates(cases))


def smoothed(ensembles: xr.Dataset, case: int, step: int, x: FloatArray, width: float) -> FloatArray:
    """(r, len(x)) smoothed responses of the realizations of a case that are at rest at one force (Sec. VI)."""
    one = ensembles.isel(case=case, step=step)
    rows = [
        smoothed_response(x, at[here], values[here], width)
        for at, values, what in zip(one["x"].values, one["floor_response"].values, one["outcome"].values, strict=True)
        if what == AT_REST and (here := np.isfinite(values)).any()
    ]
    return np.array(rows).reshape(len(rows), len(x))


def averages_dataset(ensembles: xr.Dataset, x: FloatArray, *, widths: Sequence[float], few: int) -> xr.Dataset:
    """Mean smoothed responses with standard errors, and the means of the first ``few`` realizations at rest.

    A standard error needs two realizations, and is nan below.
    """
    cases, steps = ensembles.sizes["case"], ensembles.sizes["step"]
    mean = np.full((len(widths), cases, steps, len(x)), np.nan)
    error, mean_few = mean.copy(), mean.copy()
    count = np.zeros((len(OUTCOMES), cases, steps), np.int32)
    for c in range(cases):
        outcome = ensembles["outcome"].values[c, : int(ensembles["realizations"][c])]
        for s in np.flatnonzero(np.isfinite(ensembles["force"].values[c])):
            count[:, c, s] = np.bincount(outcome[:, s], minlength=len(OUTCOMES))
            for w, width in enumerate(widths):
                rows = smoothed(ensembles, c, int(s), x, width)
                if len(rows):
                    mean[w, c, s], mean_few[w, c, s] = rows.mean(axis=0), rows[:few].mean(axis=0)
                if len(rows) > 1:
                    error[w, c, s] = rows.std(axis=0, ddof=1) / np.sqrt(len(rows))
    dims = ("width", "case", "step", "x")
    per = "in 1/mean radius: vertical stress on the floor per applied force"
    return xr.Dataset(
        {
            "mean": variable(dims, mean, f"ensemble mean of the smoothed response {per}"),
            "standard_error": variable(dims, error, f"standard error of the mean {per}"),
            "mean_of_few": variable(dims, mean_few, f"mean over the first {few} realizations at rest {per}"),
            **{
                f"count_{name}": variable(("case", "step"), count[k], f"realizations that are {name.replace('_', ' ')}")
                for k, name in enumerate(OUTCOMES)
            },
            "force": ensembles["force"].variable,
        },
        coords={
            "width": variable(("width",), np.array(widths), f"width w of the smoothing Gaussian {LENGTH}"),
            "x": variable(("x",), x, f"distance from the loaded disk {LENGTH}"),
            **{name: ensembles[name].variable for name in ("polydispersity", "friction", "lattice_constant")},
        },
        attrs={"few": few},
    )


def individual_dataset(ensembles: xr.Dataset, shown: Individual, x: FloatArray) -> xr.Dataset:
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
        rows = smoothed(ensembles, int(case), step, x, width)[:most]
        response[k, : len(rows)] = rows
    return xr.Dataset(
        {
            "response": variable(
                ("case", "realization", "x"), response, "smoothed response in 1/mean radius: stress per applied force"
            ),
            "force": variable((), force, f"applied force {FORCE}"),
            "width": variable((), width, f"width w of the smoothing Gaussian {LENGTH}"),
        },
        coords={
            "x": variable(("x",), x, f"distance from the loaded disk {LENGTH}"),
            **{
                name: ensembles[name].isel(case=cases).variable
                for name in ("polydispersity", "friction", "lattice_constant")
            },
        },
    )


def _packings_dataset(cases: Sequence[Case], found: Sequence[Realization]) -> xr.Dataset:
    shape = (len(cases), max(case.realizations for case in cases))
    numbers = {name: np.full(shape, np.nan) for name in PACKING}
    density = np.full((*shape, ANGLE_BINS), np.nan)
    left = iter(found)
    for c, case in enumerate(cases):
        for r in range(case.realizations):
            one = next(left)
            density[c, r] = one.angle_density
            for name in PACKING:
                numbers[name][c, r] = one.packing[name]
    dims = ("case", "realization")
    angle = np.pi / ANGLE_BINS * np.arange(ANGLE_BINS)
    return xr.Dataset(
        {
            **{name: variable(dims, numbers[name], text) for name, text in PACKING.items()},
            "contact_angle_density": variable(
                (*dims, "angle"), density, "distribution of the directions of contacts at rest, per radian"
            ),
        },
        coords={
            "angle": variable(("angle",), angle, "angle of a contact with the horizontal, in radians"),
            **_case_coordinates(cases),
        },
    )


def _linear_range_dataset(
    grid: Sequence[tuple[float, float]],
    forces: Sequence[float],
    found: Sequence[Realization],
    width: float,
    tolerance: float,
) -> xr.Dataset:
    """Smoothed response at x = 0 against the force, one packing each, and where it ceases to be constant."""
    centre = np.full((len(grid), len(forces)), np.nan)
    end = np.full((len(grid), 2), np.nan)
    for k, one in enumerate(found):
        for s in np.flatnonzero(one.outcome == AT_REST):
            centre[k, s] = smoothed_response([0.0], one.x, one.response[s], width)[0]
        end[k] = linear_end(np.asarray(forces), centre[k], tolerance)
    dims = ("path", "force")
    below = f"differs by less than {tolerance:.0%} from that to the smallest force"
    return xr.Dataset(
        {
            "response_at_centre": variable(
                dims, centre, "smoothed response at x = 0 in 1/mean radius: stress per applied force"
            ),
            "outcome": variable(dims, np.stack([one.outcome for one in found]), "what became of the packing"),
            "static_until": variable(
                dims, np.stack([one.loaded["static_until"] for one in found]), LOADED["static_until"]
            ),
            "linear_until": variable(("path",), end[:, 0], f"last force {FORCE} at which the response {below}"),
            "nonlinear_from": variable(("path",), end[:, 1], f"first force {FORCE} at which it does not; nan for none"),
        },
        coords={
            "polydispersity": variable(("path",), [delta for delta, _ in grid], "delta: spread of the radii"),
            "friction": variable(("path",), [mu for _, mu in grid], "coefficient of friction, walls frictionless"),
            "force": variable(("force",), np.array(forces), f"applied force {FORCE}"),
        },
        attrs={"width": width, "tolerance": tolerance},
    )


def linear_end(force: FloatArray, response: FloatArray, tolerance: float) -> tuple[float, float]:
    """Forces between which ``response`` first leaves the neighbourhood of its first value.

    Last force before and first force after; the latter is nan if it never leaves.
    """
    away = np.flatnonzero(np.abs(response / response[0] - 1.0) > tolerance)
    if not away.size:
        known = np.flatnonzero(np.isfinite(response))
        return (float(force[known[-1]]) if known.size else float("nan")), float("nan")
    return float(force[away[0] - 1]), float(force[away[0]])


def _forces_dataset(task: Task, found: Realization, polydispersity: float) -> xr.Dataset:
    """The states of Fig. 2: at rest, and under load."""
    problem = Problem.from_scene(task.scene)
    if len(found.states) != 2:
        raise SceneError(f"forces_picture: the realization does not reach its force ({found.message or 'collapsed'})")
    packing = problem.packing
    problem = problem.with_loads(found.states[0].position)
    states = common_candidates(found.states, packing.radius)
    dataset = states_dataset(states)
    dataset["axis"].attrs.update(long_name="axis labels", units="1")
    return dataset.assign(
        force=variable(("state",), np.array([state.load_factor for state in states]), f"applied force {FORCE}"),
        radius=variable(("disk",), packing.radius, f"disk radius {LENGTH}"),
        width=variable((), packing.width, f"distance of the side walls {LENGTH}"),
        loaded_disk=variable((), int(problem.load_disk[0]), "index of the loaded disk"),
        polydispersity=variable((), polydispersity, "delta: spread of the radii"),
        friction=variable((), task.scene.contact.friction, "coefficient of friction, walls included"),
    )
