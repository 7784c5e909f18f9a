"""Observables of the field for a result: its network, its forces, its stiffness, and where the work of a load goes.

``state`` is 0 for the initial equilibrium, then one for each load factor; -1 is the last one.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import xarray as xr

from ..errors import check_positive, require
from ..observe import network
from ..observe.difference import pair_force_difference, wall_force_difference
from ..observe.stress import virial_stress
from ..scene.laboratory import FORCE, LENGTH
from ..solvers.modes import lowest_modes
from ..solvers.modes import stiffness_matrix as _stiffness
from ..solvers.strain import Following, strained
from ..solvers.work import slid, stored
from ..solvers.work import work as done_by_loads
from ..store.result import common_candidates, load_coordinates, state_from
from .result import Result

_AXES = ["x", "z"]
#: Strains and stresses in the order of moduli.
_COMPONENTS = ["xx", "zz", "xz"]
_STRESS = f"{FORCE} / {LENGTH}"


def _along(result: Result) -> dict[str, Any]:
    factors = [state.load_factor for state in result._states]
    return {"state_load_factor": ("state", factors, {"long_name": "load factor"})}


def coordination_number(result: Result) -> xr.Dataset:
    """The coordination number of each state, with and without rattlers.

    Dimension ``state``: the initial equilibrium, then one for each load factor. ``coordination_number`` is the mean
    number of closed contacts of a disk, those with floor and walls included, over all disks. ``without_rattlers``
    leaves out ``rattlers`` disks with all their contacts: those with fewer than two contacts of more than
    1e-8 mg, removed iteratively. nan where all are rattlers.

    Examples
    --------
    >>> found = gr.coordination_number(result)
    >>> found["coordination_number"].values.round(3), found["rattlers"].values
    (array([4.382, 4.382]), array([0, 0]))
    """
    states = result._states
    loose = [network.rattlers(state) for state in states]
    columns = {
        "coordination_number": [network.coordination_number(state) for state in states],
        "without_rattlers": [
            np.nan if gone.all() else network.coordination_number(state, without_rattlers=True)
            for state, gone in zip(states, loose, strict=True)
        ],
        "rattlers": [int(gone.sum()) for gone in loose],
    }
    return xr.Dataset({name: ("state", values) for name, values in columns.items()}, _along(result))


def fabric_tensor(result: Result) -> xr.DataArray:
    """The fabric tensor of each state: the mean of n n over closed contacts between disks, n their unit normal.

    Dimensions ``state``, ``axis`` and ``other_axis``; its trace is 1, and half of the unit tensor is an isotropic
    network. nan without contacts.

    Examples
    --------
    >>> fabric = gr.fabric_tensor(result).isel(state=0)
    >>> round(float(fabric.sel(axis="x", other_axis="x") + fabric.sel(axis="z", other_axis="z")), 12)
    1.0
    """
    tensors = [network.fabric_tensor(state) for state in result._states]
    coordinates = {**_along(result), "axis": _AXES, "other_axis": _AXES}
    return xr.DataArray(np.stack(tensors), coordinates, ("state", "axis", "other_axis"), "fabric_tensor")


def mobilization(result: Result) -> xr.Dataset:
    """The mobilization of each contact: tangential force over friction times normal force.

    1 is full mobilization. ``mobilization`` (state, contact) between disks and ``wall_mobilization`` (state,
    wall_contact) at floor and walls, in the order of ``result.contacts``; nan where a contact is open, or has no
    friction.

    Examples
    --------
    >>> found = gr.mobilization(result)["mobilization"]
    >>> float(found.max()) <= 1.0 + 1e-9, int((found > 1 - 1e-6).sum("contact")[-1])
    (True, 22)
    """
    scene, states = result.scene, common_candidates(result._states, result.to_dataset()["radius"].values)

    def along(kind: str, friction: float) -> np.ndarray:
        found = []
        for contacts in (getattr(state, kind) for state in states):
            limit = np.where(contacts.touching & (contacts.normal_force > 0.0), friction * contacts.normal_force, 0.0)
            unknown = np.full(len(limit), np.nan)
            found.append(np.divide(np.abs(contacts.tangential_force), limit, out=unknown, where=limit > 0.0))
        return np.stack(found)

    data = {
        "mobilization": (("state", "contact"), along("pairs", scene.contact.friction)),
        "wall_mobilization": (("state", "wall_contact"), along("walls", scene.resolved_wall.friction)),
    }
    return xr.Dataset(data, _along(result))


def force_distribution(result: Result, *, state: int = -1, bins: int = 24, to: float = 6.0) -> xr.DataArray:
    """The probability density P(f / <f>) of the normal forces of closed contacts between disks, over their mean.

    There are ``bins`` of equal width from 0 ``to`` this multiple of the mean; forces beyond it count in the norm.
    Dimension ``force``: the middles of the bins; attributes ``mean_force`` in mg and ``contacts``. ``state`` is as of
    :meth:`Result.influence`.

    Examples
    --------
    >>> density = gr.force_distribution(result, state=0, bins=12)
    >>> density.sizes["force"], round(float(density.sum() * 0.5), 6)
    (12, 1.0)
    """
    chosen = result._states[result._index(state)].pairs
    if isinstance(bins, bool) or not isinstance(bins, (int, np.integer)) or bins < 1:
        raise ValueError(f"bins = {bins!r}: must be a whole number, 1 or greater")
    check_positive(to=to)
    forces = chosen.normal_force[chosen.touching]
    require(len(forces) and forces.mean() > 0.0, "result: no contacts between disks that bear a force")
    edges = np.linspace(0.0, to, int(bins) + 1)
    density = np.histogram(forces / forces.mean(), edges)[0] / (len(forces) * np.diff(edges))
    middles = ("force", 0.5 * (edges[1:] + edges[:-1]), {"long_name": "normal force over its mean"})
    labels = {"long_name": "probability density", "mean_force": float(forces.mean()), "contacts": len(forces)}
    return xr.DataArray(density, {"force": middles}, ("force",), "force_distribution", labels)


def disk_stress(result: Result, *, state: int = -1, added: bool | None = None) -> xr.DataArray:
    """The stress of each disk, the virial of its contact forces over its area, in mg per mean radius.

        sigma_ab = - sum_contacts f_a (c - r)_b / (pi R^2)

    with the force f on the disk at its contact c, its centre r and its radius R; compression is positive. Its
    coarse-grained field is :meth:`Result.stress`. LAMMPS's ``stress/atom`` takes half of the branch vector in place of
    c - r, the same between equal disks, and no area.

    Parameters
    ----------
    state : as of :meth:`Result.influence`, with its errors.
    added : as of :meth:`Result.stress` : the incremental forces, the default for states under load.

    Returns
    -------
    Dimensions ``disk``, ``force`` and ``branch`` ("x", "z"): the first index of the tensor is the force's. 0 for a disk
    that no force acts on.

    Raises ValueError for the added part of the initial equilibrium.

    Examples
    --------
    >>> stress = gr.disk_stress(result, state=0)
    >>> pressure = 0.5 * (stress.sel(force="x", branch="x") + stress.sel(force="z", branch="z"))
    >>> pressure.dims, bool((pressure > 0.0).all())
    (('disk',), True)
    """
    index = result._index(state)
    added = result._added(index, added)
    data = result._data
    rest, now = (state_from(data, k) for k in (0, index))  # on one list of candidates
    forces = now.pair_force(), now.wall_force()
    if added:
        forces = pair_force_difference(rest, now), wall_force_difference(rest, now)
    coordinates = {"force": _AXES, "branch": _AXES}
    labels = {"long_name": "incremental stress of a disk" if added else "stress of a disk", "units": _STRESS}
    values = virial_stress(now, data["radius"].values, *forces)
    return xr.DataArray(values, coordinates, ("disk", "force", "branch"), "disk_stress", labels)


def stiffness_matrix(result: Result, *, state: int = -1, sliding: str = "refuse") -> Any:
    """The tangent stiffness K = -dF/dq of a stable state, as a ``scipy.sparse.csc_array`` in mg per mean radius.

    Its unknowns are those of the disks one after another: x and z, and the angle where disks turn. Geometric
    (initial-stress) stiffness is included. ``state`` and ``sliding`` are as of
    :meth:`Result.influence`, and so is what it raises.

    Examples
    --------
    >>> matrix = gr.stiffness_matrix(result, state=0, sliding="stick")
    >>> matrix.shape == (3 * 34, 3 * 34)
    True
    """
    return _stiffness(result._solved.problem, result._solved_state(state), sliding=sliding)


def modes(result: Result, count: int = 6, *, state: int = -1, sliding: str = "refuse") -> xr.Dataset:
    """The lowest vibrations of a stable state: K x = omega^2 M x, with the symmetric part of K.

    So many as ``count``; ``state`` and ``sliding`` are as of :meth:`Result.influence`. Dimensions ``mode``, ``disk``
    and ``component`` ("x", "z" and, where disks turn, "angle"): ``frequency`` omega in sqrt(g/R), and ``displacement``
    with x M x = 1. Rattlers are left out, nan there; so is what a load holds.

    Raises as :meth:`Result.influence` does, and ValueError for a ``count`` that there is not.

    Examples
    --------
    >>> found = gr.modes(result, 3, state=0, sliding="stick")
    >>> found["displacement"].dims, bool((found["frequency"].diff("mode") >= 0.0).all())
    (('mode', 'disk', 'component'), True)
    """
    chosen, problem = result._solved_state(state), result._solved.problem
    values, vectors = lowest_modes(problem, chosen, count, network.rattlers(chosen), sliding=sliding)
    frequency = np.sqrt(np.maximum(values, 0.0))  # a disk that rolls freely has 0, up to rounding
    data: dict[str, Any] = {
        "frequency": ("mode", frequency, {"long_name": "frequency", "units": "1 / reduced_time"}),
        "displacement": (("mode", "disk", "component"), vectors),
    }
    return xr.Dataset(data, {"component": ["x", "z", "angle"][: problem.freedoms]})


def elastic_moduli(
    result: Result, *, state: int = 0, following: Following = "free", margin: float = 0.25, prestress: bool = True
) -> xr.DataArray:
    """The elastic moduli of a packing between periodic sides: stress per small uniform strain, in mg per mean radius.

    The lowest and the highest row move with the strain, and the disks between them relax to equilibrium; stress and
    strain are averaged over these, tension positive. Contacts at the Coulomb limit are taken to stick.

    Parameters
    ----------
    state : 0 for the initial equilibrium, then one for each load factor; -1 is the last one.
    following : "free"; "suppressed" where no disk turns; "affine" where every disk moves with the strain.
    margin : fraction of the rows that is left out at either end, below 1/2.
    prestress : whether geometric (initial-stress) stiffness is included.

    Returns
    -------
    Dimensions ``stress`` and ``strain``: "xx", "zz", "xz".

    Raises ValueError for a packing that is no slab of three rows or more between periodic sides,
    granular_response.SolveError for a state that is not stable.

    Examples
    --------
    >>> slab = gr.Slab(layers=8, disks_per_row=8, sides="periodic", lattice_constant=1.999)
    >>> lattice = gr.solve(gr.Scene(packing=slab, contact=gr.Contact(friction=0.0), loads=[]), progress=False)
    >>> moduli = gr.elastic_moduli(lattice, prestress=False)
    >>> ratio = moduli.sel(stress="xx", strain="xx") / moduli.sel(stress="xx", strain="zz")
    >>> round(float(ratio), 1)  # lambda + 2 mu = 3 lambda
    3.0
    """
    chosen = result._solved_state(state)
    found = strained(result._solved.problem, chosen, following, margin=margin, prestress=prestress)
    labels = {"long_name": "elastic moduli", "units": _STRESS}
    coordinates = {"stress": _COMPONENTS, "strain": _COMPONENTS}
    return xr.DataArray(found.moduli, coordinates, ("stress", "strain"), "elastic_moduli", labels)


def work(result: Result) -> xr.Dataset:
    """Work of the loads from each state to the next, split into stored energy and dissipation by sliding, in mg R.

    Dimension ``load``, as of ``floor_response``. ``work`` : mean force of the loads times the displacement of their
    disks since the state before. ``stored`` : increase of the energy of springs and weights. ``dissipated`` : the
    difference. ``slid`` : the same dissipation from the slip of the contacts, an independent sum. Both hold for a path
    of equilibria, with errors of third and second order in the distance of the states: solve for load factors close to
    each other, and compare the two. ``cumsum("load")`` sums them up.

    Raises ValueError for a result without loads.

    Examples
    --------
    >>> import numpy as np
    >>> growing = gr.solve(result.scene, load_factors=np.linspace(0.1, 1.0, 10), progress=False)
    >>> total = gr.work(growing).sum("load")
    >>> bool(total["work"] > 0.0), bool(abs(total["dissipated"] - total["slid"]) < 0.01 * total["work"])
    (True, True)
    """
    require(result.loaded, "result: no loads in this scene, so no work")
    problem = result._solved.problem
    states = common_candidates(result._states, problem.packing.radius)
    energy = np.array([stored(problem, state) for state in states])
    steps = list(itertools.pairwise(states))
    done = np.array([done_by_loads(problem, before, after) for before, after in steps])
    lost = np.array([slid(problem, before, after).total for before, after in steps])
    columns = {"work": done, "stored": np.diff(energy), "dissipated": done - np.diff(energy), "slid": lost}
    unit = f"{FORCE} * {LENGTH}"
    data = {name: ("load", values, {"long_name": name, "units": unit}) for name, values in columns.items()}
    return xr.Dataset(data, load_coordinates(result.load_factors))
