"""How far the events of the ordered slab move with what the text leaves open, and with what should not matter.

Each event of Secs. V.A, V.B and V.E is looked for with the paper's protocol and with one thing changed: the *protocol*
(dashpots halved and doubled, another integrator, a smaller time step, ten copies of the packing displaced by 1e-9 R,
the duration of the load ramp), the *width* of the slab, or the *stiffness* of its disks. At large forces and friction 1
ten displaced copies under each force tell which way the response leans, and the same with friction 10, at which no
contact reaches its limit, whether sliding or opening breaks the symmetry.

The study takes some minutes and stands outside the pipeline of the figures; its dataset is part of the repository,
``data/survey/robustness.nc``. ``python -m granular_response_paper.survey.robustness`` makes it anew. Units are reduced:
mean radius, mean mass, g.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granular_response import __version__, studies
from granular_response.scene import Scene
from granular_response.scene.lattice import SlabPacking
from granular_response.state import FloatArray
from granular_response.store import files as store
from granular_response.store.variables import RADII, WEIGHTS
from granular_response_paper import slab_response as slab
from granular_response_paper.datasets import labelled
from granular_response_paper.parameters import UNIT_LOAD
from granular_response_paper.records import column, record, table, variables
from granular_response_paper.survey.simulate import MECHANICS, made_by
from granular_response_paper.tasks import computed

OUTPUT = Path("data") / "survey" / "robustness.nc"

#: The slab of Sec. V: k_T/k_N = 0.8, smooth walls.
BASE = UNIT_LOAD.updated({"contact.stiffness_ratio": 0.8, "wall.friction": 0.0})

#: Of Fig. 6; forces through which paths go, and the last one by friction.
FRICTIONS = (0.0, 0.05, 0.1, 0.2, 0.5, 1.0)
FORCES = (
    *(0.1, 0.2, 0.3, 0.5, 0.6, 0.7, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 11.0),
    *(12.0, 15.0, 18.0, 20.0, 22.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0, 70.0, 80.0, 85.0, 90.0),
)
LAST = {0.0: 10.0, 0.05: 20.0, 0.1: 30.0, 0.2: 50.0, 0.5: 50.0, 1.0: 90.0}

#: Size of displacements of copies: far below any length of the problem, far above rounding. And of the kicks of the
#: control, which a stable symmetric branch forgets.
DISPLACEMENT, KICK = 1e-9, 1e-4

#: Copies of each load path, which is followed through all its events, and at each force beyond the loss of symmetry.
COPIES = 10

#: Asymmetry of the response from which symmetry is lost, as in Fig. 16; forces between which it is lost.
ASYMMETRY, BETWEEN = 0.2, (70.0, 110.0)

#: Between which forces events are looked for by dynamics from rest, by friction, and to which width.
SOUGHT = {
    0.2: {
        "first_opening": (2.0, 8.0),
        "linear_range": (4.0, 16.0),
        "crossover": (14.0, 26.0),
        "third_peak": (26.0, 46.0),
    },
    1.0: {"first_opening": (3.0, 9.0), "linear_range": (4.0, 16.0)},
}
WIDTH = 0.2

#: Durations of the load ramp, in sqrt(R/g): the text names none.
RAMPS = (10.0, 20.0, 100.0)

#: Forces beyond the loss of symmetry at which copies are made, and those of the control.
BEYOND, CONTROL = (92.0, 93.0, 94.0, 95.0, 96.0, 100.0), (95.0, 150.0, 300.0)


@dataclass(frozen=True)
class Variant:
    """One change to the paper's slab or protocol."""

    kind: str
    name: str
    changes: Mapping[str, Any]
    seed: int = -1  #: of the displacement of a copy; -1 for none


def variants() -> Iterator[Variant]:
    """The paper's own first."""
    yield Variant("reference", "as in the paper", {})
    yield Variant("protocol", "dashpots halved", {"contact.damping_ratio": 0.25})
    yield Variant("protocol", "dashpots doubled", {"contact.damping_ratio": 1.0})
    yield Variant("protocol", "velocity Verlet", {"protocol.integrator": "verlet"})
    yield Variant("protocol", "half of the time step", {"protocol.time_step": 2.5e-4})
    yield Variant("protocol", "a quarter of the time step", {"protocol.time_step": 1.25e-4})
    for seed in range(1, COPIES + 1):
        yield Variant("protocol", f"displaced copy {seed}", {}, seed)
    for disks in (121, 241):
        yield Variant("width", f"{disks} disks a row", {"packing.disks_per_row": disks})
    step = 5e-4 * float(np.sqrt(3000.0 / 1e4))  # as far below its stability limit as the paper's
    stiff = {"contact.normal_stiffness": 1e4, "protocol.time_step": step}
    yield Variant("stiffness", "k_N = 10000 mg/R", stiff)


@record
class Found(slab.Event):
    """An event of one variant."""

    kind: str = column("what is changed: reference, protocol, width or stiffness")
    variant: str = column("the change")
    loading: str = column("path: along a load path; dynamics: from rest to each force")
    ramp_time: float = column("duration of the load ramp in sqrt(radius/g); nan along a path")


def load_path(scene: Scene, seed: int = -1, size: float = DISPLACEMENT) -> studies.LoadPath:
    """Of the packing, or of a copy displaced at random by up to ``size`` along each axis."""
    if seed < 0:
        return studies.LoadPath.of(scene)
    packing = SlabPacking.model_validate(scene.packing.model_dump()).build()
    shift: FloatArray = np.random.default_rng(seed).uniform(-size, size, packing.position.shape)
    return studies.LoadPath.of(scene, packing=replace(packing, position=packing.position + shift))


def along_path(friction: float, variant: Variant) -> list[Found]:
    """All events of the slab at one friction along a load path."""
    path = load_path(BASE.updated({"contact.friction": friction, **variant.changes}), variant.seed)
    forces = [force for force in FORCES if force <= LAST[friction]]
    states, measures = path.through(forces), studies.Measures(path)
    asked = studies.happenings(measures, states[0], ASYMMETRY)
    asked["first_opening_anywhere"] = studies.first_opening(measures, anywhere=True)
    own = {"kind": variant.kind, "variant": variant.name, "loading": "path", "ramp_time": float("nan")}
    return [Found(**vars(event) | own) for event in slab.locate(path, forces, asked)]


def from_rest(friction: float, variant: Variant, ramp: float, sought: Mapping[str, tuple[float, float]]) -> list[Found]:
    """Events by dynamics from rest to each force, between the forces at which each is ``sought``."""
    dynamics = {"protocol.method": "dynamics", "protocol.ramp_time": ramp}
    path = load_path(BASE.updated({"contact.friction": friction, **dynamics, **variant.changes}), variant.seed)
    measures = studies.Measures(path)
    asked = studies.happenings(measures, path.at(0.5), ASYMMETRY)
    found = []
    for name, (low, high) in sought.items():
        what, width = asked[name], 1.0 if name.startswith("loss") else WIDTH
        ends = slab.between(partial(_happened, path, what), low, high, width)
        text = f"{what.definition}, from rest to each force"
        of = name.removesuffix("_path"), friction, *ends, text
        found.append(Found(*of, variant.kind, variant.name, "dynamics", ramp))
    return found


def _happened(path: studies.LoadPath, what: studies.Happening, force: float) -> bool:
    return bool(what.happened(path.at(force)))


def copy_under(friction: float, force: float, seed: int, size: float = DISPLACEMENT) -> xr.Dataset:
    """What is measured on a displaced copy by the paper's dynamics from rest to one force."""
    changes = {"contact.friction": friction, "protocol.method": "dynamics", "protocol.ramp_time": 20.0}
    path = load_path(BASE.updated(changes), seed, size)
    return slab.measured(studies.Measures(path), [path.at(force)])


def copies_under(
    what: str, frictions: Sequence[float], forces: Sequence[float], seeds: Sequence[int], size: float
) -> xr.Dataset:
    """Displaced copies along ``run``, with what they are."""
    tasks = {place: partial(copy_under, *place, size) for place in product(frictions, forces, seeds)}
    friction, force, seed = zip(*tasks, strict=True)
    return slab.measured_along("run", list(computed(tasks, what).values())).assign(
        variables(
            friction=("run", friction, "coefficient of friction"),
            force=("run", force, f"applied force {WEIGHTS}"),
            seed=("run", seed, "seed of the displacement; -1 for none"),
        )
    )


def paths() -> xr.Dataset:
    """Events (event) of all variants along load paths."""
    tasks = {
        (mu, k): partial(along_path, mu, one)
        for mu in FRICTIONS
        for k, one in enumerate(variants())
        # without friction the equilibrium is one minimum; the widest slab takes ten times as long as others
        if not (mu == 0.0 and one.seed > 0) and not (mu in (0.05, 0.1, 0.5) and "241" in one.name)
    }
    done = computed(tasks, "load paths", work=lambda place: place[1])
    return table([event for one in done.values() for event in one], "event", kind=Found)


def dynamics() -> xr.Dataset:
    """Events (event) from rest: ramps of the load, and the loss of symmetry with every variant."""
    tasks: dict[Any, Any] = {}
    for ramp in RAMPS:
        variant = Variant("protocol", f"load ramp of {ramp:g} sqrt(R/g)", {})
        tasks |= {(mu, ramp): partial(from_rest, mu, variant, ramp, sought) for mu, sought in SOUGHT.items()}
        tasks["loss", ramp] = partial(from_rest, 1.0, variant, ramp, {"loss_of_symmetry_path": BETWEEN})
    for k, variant in enumerate(variants()):
        if variant.kind == "protocol" or variant.name == "121 disks a row":
            tasks["loss", -k] = partial(from_rest, 1.0, variant, 20.0, {"loss_of_symmetry_path": BETWEEN})
    done = computed(tasks, "events from rest")
    return table([event for one in done.values() for event in one], "event", kind=Found)


def main(output: Path = OUTPUT) -> None:
    """Make ``events``, ``events_from_rest``, ``copies`` beyond the loss of symmetry, and ``control``."""
    copies = copies_under("displaced copies", (1.0,), BEYOND, range(1, COPIES + 1), DISPLACEMENT)
    control = copies_under("control without sliding", (1.0, 10.0), CONTROL, (-1, 1, 2, 3), KICK)
    size = f"largest displacement of the packing before it falls {RADII}"
    datasets = {
        "events": paths(),
        "events_from_rest": dynamics(),
        "copies": copies.assign(variables(displacement=("", DISPLACEMENT, size))),
        "control": control.assign(variables(kick=("", KICK, size))),
    }
    attributes = {"group": "robustness", "package_version": __version__, "parameters": BASE.to_yaml()}
    store.write(output, labelled(datasets, BASE), attributes | made_by(MECHANICS))


if __name__ == "__main__":
    main()
