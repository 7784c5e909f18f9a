"""Slabs for the page's explorer that no figure of the paper shows: small k_T/k_N (Sec. V.B), and disorder (Sec. VI).

One dataset for each slab, as ``friction_linear_range`` stores its states, but with single precision: at rest first,
then under each force. Disordered slabs are single realizations.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import xarray as xr

from granular_response.errors import SolveError
from granular_response.observe.floor import smoothed_response
from granular_response.observe.peaks import peak_count
from granular_response.scene import Scene
from granular_response.state import State
from granular_response.store.result import certificates_dataset
from granular_response.store.variables import RADII
from granular_response_paper.datasets import labelled
from granular_response_paper.groups.explorer.parameters import Parameters
from granular_response_paper.records import variables
from granular_response_paper.slab_response import LoadPath, Measures, disordered, states_picture
from granular_response_paper.tasks import computed


def simulate(parameters: Parameters) -> dict[str, xr.Dataset]:
    """One dataset for each slab."""
    return labelled(computed(_tasks(parameters), "slabs"), parameters.base)


def _tasks(parameters: Parameters) -> dict[str, partial[xr.Dataset]]:
    base, depth, forces = parameters.base, parameters.collapse_depth, parameters.forces
    tasks = []
    for lattice in parameters.lattices:
        changes = {"contact.friction": lattice.friction, "contact.stiffness_ratio": lattice.stiffness_ratio}
        tasks.append(partial(states, base.updated(changes), forces, depth, 0.0))
    for one in parameters.disordered:
        material = {"packing.polydispersity": one.polydispersity, "contact.friction": one.friction}
        fall = disordered(parameters.stop_kinetic_energy)
        scene = base.updated({**material, "wall.friction": one.friction, **fall})
        below = tuple(force for force in forces if force <= one.largest_force)
        tasks.append(partial(states, scene, below, depth, parameters.width))
    return {f"slab_{k}": task for k, task in enumerate(tasks)}


def states(scene: Scene, forces: tuple[float, ...], collapse_depth: float, width: float) -> xr.Dataset:
    """The states of one slab up to the last force before it collapses or finds no rest.

    ``scene`` has one load, of unit force; ``width`` is that of the smoothing Gaussian, 0 for a lattice, whose response
    is not smoothed. Raises what the settling of the slab raises.
    """
    path = LoadPath.of(scene)
    found = [path.rest]
    path.lowest = float(path.rest.position[int(path.problem.load_disk[0]), 1]) - collapse_depth
    for force in forces:
        try:
            state = path.at(force)
        except SolveError:
            break
        if state.position[int(path.problem.load_disk[0]), 1] < path.lowest:  # a minimum of the energy
            break
        found.append(state)
    return _dataset(path, found, width)


def _dataset(path: LoadPath, found: list[State], width: float) -> xr.Dataset:
    scene = path.scene
    pictures = states_picture(found, path.problem).drop_vars("angle")
    measures = Measures(path)
    x = measures.x
    response, smooth = np.full((2, len(found), len(x)), np.nan)
    count = np.zeros(len(found))
    for k, state in enumerate(found[1:], 1):
        response[k] = measures.response(state)
        smooth[k] = smoothed_response(x, x, response[k], width) if width else response[k]
        count[k] = peak_count(x, smooth[k], interior=measures.interior)
    if width:
        centre = smoothed_response([0.0], x, response, width)[:, 0]
        unit = "smoothed with the width w, in 1/mean radius: stress per applied force"
    else:
        centre = np.array([np.interp(0.0, x, one) for one in response])
        unit = "per applied force"
    for name, values in pictures.data_vars.items():
        if values.dtype == np.float64 and values.ndim > 1:
            pictures[name] = values.astype(np.float32)
    packing, contact = scene.packing.model_dump(), scene.contact
    return pictures.merge(certificates_dataset(found)).assign(
        variables(
            floor_response=("state floor_disk", response, "vertical floor force that the load adds, per applied force"),
            smoothed_response=("state floor_disk", smooth, f"floor response {unit}"),
            response_at_centre=("state", centre, f"floor response at x = 0 {unit}"),
            peak_count=("state", count, "number of peaks of the smoothed response; 0 at rest"),
            x=("floor_disk", x, f"rest position of a floor disk from the loaded disk {RADII}"),
            smoothing_width=("", width, f"width w of the smoothing Gaussian {RADII}; 0: none"),
            polydispersity=("", packing["polydispersity"], "delta: spread of the radii"),
            friction=("", contact.friction, "coefficient of friction between disks"),
            wall_friction=("", scene.wall.friction, "coefficient of friction of the walls"),
            stiffness_ratio=("", contact.stiffness_ratio, "k_T/k_N"),
            normal_stiffness=("", contact.normal_stiffness, "k_N in mean disk weight per mean radius"),
        )
    )
