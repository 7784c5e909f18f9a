"""A solved scene as one object: what ``solve`` returns, ``open_result`` reads and ``plot`` draws.

Units are the reduced ones (mean disk radius, mean disk mass, g), as everywhere in the package.
"""

from __future__ import annotations

import html
import math
import os
import warnings
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from ..errors import GranularError, require
from ..observe.broke_in import broke_in
from ..observe.floor import origin_of, sensor_forces, smoothed_response
from ..observe.stress import coarse_grained_stress, contact_forces, grid_points, load_forces
from ..scene import Scene
from ..scene import text as scene_text
from ..scene.arrays import shortened
from ..scene.errors import show
from ..scene.given import finite_numbers
from ..scene.laboratory import FORCE, LENGTH, SAME_RADIUS, LaboratoryUnits
from ..solvers.choice import LARGE
from ..solvers.small_loads import influence
from ..solvers.solution import Progress, Solution, continue_solution, solve_scene
from ..state import Certificate, State, state_index
from ..store import export as exporting
from ..store import files
from ..store.checked import read_result
from ..store.result import contact_table, scene_of, solution_from, state_from, to_dataset
from .event_table import Events
from .terminal import LOG, logged, shown


class Result:
    """The initial equilibrium of a scene, its states under load, and quantities measured on them.

    Made by :func:`solve` and :func:`open_result`.

    Examples
    --------
    >>> result = gr.solve(gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9)))
    >>> len(result.rest.position), result.load_factors, result.certificate.stable
    (34, (1.0,), True)
    """

    def __init__(
        self,
        solution: Solution | None = None,
        dataset: xr.Dataset | None = None,
        *,
        folder: str | os.PathLike[str] | None = None,
    ) -> None:
        rule = "Result: made from a solution or from a dataset, one of them"
        require((solution is None) != (dataset is None), rule, TypeError)
        self._solution, self._dataset, self._folder = solution, dataset, folder

    @cached_property
    def scene(self) -> Scene:
        """What was solved."""
        return self._solution.scene if self._solution else scene_of(self._data, folder=self._folder)

    @cached_property
    def rest(self) -> State:
        """The initial equilibrium, under gravity."""
        return self._solution.rest if self._solution else state_from(self._data, 0)

    @cached_property
    def loaded(self) -> tuple[State, ...]:
        """One state for each load factor, in order; empty for a scene without loads."""
        if self._solution:
            return self._solution.loaded
        return tuple(state_from(self._data, k) for k in range(1, self._data.sizes["state"]))

    @property
    def load_factors(self) -> tuple[float, ...]:
        """Multipliers of the scene's loads, one for each loaded state."""
        return tuple(state.load_factor for state in self.loaded)

    @property
    def _states(self) -> tuple[State, ...]:
        return self.rest, *self.loaded

    @property
    def certificates(self) -> tuple[Certificate, ...]:
        """Unbalanced force and stability of each state, the initial equilibrium first."""
        return tuple(state.certificate for state in self._states)

    @property
    def certificate(self) -> Certificate:
        """Certificate of the last state."""
        return self.certificates[-1]

    @property
    def events(self) -> Events:
        """Events on the load path, in order: contacts that change status, and losses of equilibrium.

        Dynamics and minimisation have no contact events. Where events were processed in a batch, as in packings of many
        thousand disks, ``reached.events_within`` of a state is the load increment of the batch (mg), and
        ``reached.events_error`` estimates, without a bound, the resulting error of a force on the floor or a wall since
        the state before, relative to the load.
        """
        return Events((k, event) for k, state in enumerate(self._states) for event in state.reached.events)

    @property
    def floor_response(self) -> xr.DataArray:
        """The incremental vertical force on each floor disk, over the total magnitude of the applied forces.

        Dimensions ``load`` (with ``load_factor``, ``step`` and ``branch``) and ``floor_disk`` (with ``x``, its position
        relative to the loaded disk in mean radii). NaN where no force is applied, after unloading and under torques
        alone; :attr:`floor_force_change` is defined there.

        Examples
        --------
        >>> result.floor_response.sel(load=1.0).plot(x="x")  # doctest: +ELLIPSIS
        [<matplotlib...
        >>> result.floor_response.set_xindex("x").sel(x=0.3, method="nearest").sizes
        Frozen({'load': 1})
        """
        return self._data["floor_response"].copy()

    @property
    def floor_force_change(self) -> xr.DataArray:
        """The incremental vertical force on each floor disk in mg; defined after unloading too.

        Dimensions as of :attr:`floor_response`.

        Examples
        --------
        >>> round(float(result.floor_force_change.sum()), 6)
        15.0
        """
        return self._data["floor_force_change"].copy()

    def response_at(
        self, x: float | Sequence[float] | np.ndarray = 0.0, *, smooth: float | None = None
    ) -> xr.DataArray:
        """The floor response at the position ``x`` relative to the loaded disk, or at several, for each load.

        Parameters
        ----------
        x : a position in mean radii, or a list of them; the response is that of the nearest floor disk.
        smooth : w of a Gaussian average exp(-(x/w)²) over floor disks, in mean radii (Sec. VI); then the stress per
            force at x, per mean radius.

        Returns
        -------
        Dimension ``load``; of a list also ``floor_disk``, the nearest one to each place, or with ``smooth`` the places
        themselves as ``x``.

        Raises ValueError for places that are not finite, and a width that is not positive.

        Examples
        --------
        >>> result.response_at(0.0).sizes, result.response_at([-2.0, 0.0, 2.0], smooth=2.0).sizes
        (Frozen({'load': 1}), Frozen({'load': 1, 'x': 3}))
        """
        many, data, box = np.ndim(x) > 0, self._data, self.rest.box
        places = _places("x", x if many else [x])
        at = data["x"].values
        if smooth is None:
            away = box.separation(np.c_[at, 0.0 * at][:, None], np.c_[places, 0.0 * places])[..., 0]
            nearest = np.abs(away).argmin(axis=0)
            return data["floor_response"].isel(floor_disk=nearest if many else int(nearest[0])).copy()
        smoothed = smoothed_response(places, at, data["floor_response"].values, smooth, box.period)
        labels = {"long_name": "smoothed floor response", "units": f"1 / {LENGTH}"}
        along = {name: data[name] for name in ("load", "load_factor", "step", "branch")}
        found = xr.DataArray(smoothed, {**along, "x": places}, ("load", "x"), "smoothed_response", labels)
        return found if many else found.isel(x=0)

    def floor_profile(
        self,
        units: LaboratoryUnits,
        sensors: float | Sequence[float] | np.ndarray,
        *,
        state: int = -1,
        added: bool | None = None,
    ) -> xr.DataArray:
        """The vertical force on each sensor of the floor in newtons, along x in millimetres.

        A disk presses on the sensor below its centre. As ``measure`` of :func:`preparations` it gives the band over
        preparations, and of :func:`sweep` the profiles of several packings.

        Parameters
        ----------
        units : of the disks, for one mean radius and one mean particle weight.
        sensors : the width of each in mm, side by side from the left wall until they cover the floor; or their edges,
            in mm from the left wall, a growing list.
        state : as of :meth:`contacts_table`, with its errors.
        added : the incremental forces, the default for states under load; otherwise the whole forces.

        Returns
        -------
        Dimension ``x``: the middle of each sensor, in mm from the left wall.

        Raises ValueError for another ``sensors``, and for the added part of the initial equilibrium.

        Examples
        --------
        >>> result.floor_profile(units, 20.0).round(4).values
        array([0.0118, 0.0255, 0.0107, 0.0012])
        """
        index = self._index(state)
        added = self._added(index, added)
        scale = 1e3 * units.unit("length")
        edges = _edges(sensors, scale * self.rest.box.width, scale)
        forces = [sensor_forces(one, edges / scale) for one in (self._states[index], self.rest)]
        newtons = units.to_laboratory("force", forces[0] - forces[1] if added else forces[0])
        middles = ("x", 0.5 * (edges[1:] + edges[:-1]), {"long_name": "x from the left wall", "units": "mm"})
        labels = {"long_name": f"{'incremental ' if added else ''}force on a sensor of the floor", "units": "N"}
        return xr.DataArray(newtons, {"x": middles}, ("x",), "floor_profile", labels)

    @property
    def displacement(self) -> xr.DataArray:
        """(load, disk, axis) displacement of each disk from the initial equilibrium, in mean radii.

        With the coordinate ``force`` (load), the total magnitude of the applied forces in mg, for a curve of force and
        displacement; :attr:`loaded_disks` says which disks are loaded.

        Examples
        --------
        >>> growing = gr.solve(result.scene, load_factors=[0.5, 1.0])
        >>> growing.displacement.sel(axis="z").isel(disk=growing.loaded_disks[0]).plot(x="force")  # doctest: +ELLIPSIS
        [<matplotlib...
        """
        data = self._data
        position = data["position"]
        moved = (position.isel(state=slice(1, None)) - position.isel(state=0)).rename(state="load")
        along = {name: data[name] for name in ("load", "load_factor", "step", "branch")}
        moved.attrs = {"long_name": "displacement", "units": LENGTH}
        return moved.assign_coords(along | {"force": data["total_force"]}).rename("displacement")

    @property
    def loaded_disks(self) -> np.ndarray:
        """(load_point,) the disk of each load of the scene.

        Examples
        --------
        >>> result.loaded_disks.tolist() == result.to_dataset()["loaded_disk"].values.tolist()
        True
        """
        return self._data["loaded_disk"].values.copy()

    @property
    def reaction(self) -> xr.DataArray:
        """Force x, z, in mg, with which each load holds its disk at its displacement.

        Dimensions ``load``, ``load_point`` and ``axis`` ("x", "z"); 0 along directions that are free. Raises ValueError
        for a scene in which no load displaces a disk.
        """
        require("reaction" in self._data, "reaction: there is none, no load of this scene has a displacement")
        return self._data["reaction"].copy()

    @property
    def contacts(self) -> xr.Dataset:
        """Every candidate contact in every state: between disks (``contact_...``) and at walls (``wall_...``).

        ``contact_status`` and ``wall_status`` are 0 open, 1 sticking, 2 sliding.
        """
        names = [name for name in map(str, self._data.data_vars) if name.startswith(("contact_", "wall_"))]
        return self._data[names].copy(deep=True)

    def contacts_table(self, state: int = -1) -> Any:
        """The closed contacts of one state, a row for each, as a ``pandas.DataFrame``.

        ``first`` and ``second`` are the disks, ``second`` is -1 at a ``wall`` ("floor", "left_wall" or "right_wall", ""
        between disks); ``x``, ``z`` the point of contact from the left wall and the floor; ``status`` "sticking" or
        "sliding"; ``normal_force`` positive in compression; ``tangential_force`` on ``first``, along z × n.
        Where rolling is resisted, ``rolling_force`` and ``rolling_status`` too. ``attrs["units"]`` names the units of
        the columns. ``state`` is 0 for the initial equilibrium, then one for each load factor, -1 the last one; raises
        IndexError for one that there is not, TypeError for what is no integer.

        Examples
        --------
        >>> table = result.contacts_table()
        >>> table[table.status == "sliding"].to_csv("sliding.csv")
        """
        return contact_table(self._states[self._index(state)], self._data["radius"].values)

    def stress(
        self,
        x: Sequence[float] | np.ndarray | None = None,
        z: Sequence[float] | np.ndarray | None = None,
        *,
        state: int = -1,
        added: bool | None = None,
        width: float = 2.0,
    ) -> xr.DataArray:
        """Coarse-grained stress tensor on a grid, in mg per mean radius, compression positive.

        Parameters
        ----------
        x : places from the loaded disk, as in ``floor_response``; every mean radius across the box if left out.
        z : heights above the floor; every mean radius up to the highest disk if left out.
        state : as of :meth:`contacts_table`, with its errors.
        added : the incremental stress (Fig. 14) in place of the whole stress; the default for states under load.
        width : w of the Gaussian exp(-(r/w)²), in mean radii (Sec. V.C: 2).

        Returns
        -------
        Dimensions ``z``, ``x``, ``force`` and ``branch`` ("x", "z"): the first index of the tensor is the force's.

        Raises ValueError unless ``x`` and ``z`` are lists of finite numbers and ``width`` is positive, and for the
        added part of the initial equilibrium.

        Examples
        --------
        >>> stress = result.stress(z=[0.0, 2.0, 4.0]).sel(force="z", branch="z")
        >>> stress.dims
        ('z', 'x')
        """
        state = self._index(state)
        added = self._added(state, added)
        origin, box = self.origin, self.rest.box
        top = float(self.rest.position[:, 1].max()) + 1.0
        # rounded: the same places in results whose loaded disk is at the same place but for its last digits
        left = round(-0.5 * box.width if box.periodic else -origin, 9)
        across = np.arange(left, left + box.width + 0.5) if x is None else _places("x", x)
        up = np.arange(0.0, top) if z is None else _places("z", z)
        rest, now = (state_from(self._data, k) for k in (0, state))  # on one list of candidates
        forces = load_forces(rest, now) if added else contact_forces(now)
        tensor = coarse_grained_stress(forces, grid_points(across + origin, up), width)
        title = "stress that the load adds" if added else "stress"
        names = np.array(["x", "z"])
        coordinates = {"z": up, "x": across, "force": names, "branch": names}
        labels = {"long_name": title, "units": f"{FORCE} / {LENGTH}", "gaussian_width": width}
        return xr.DataArray(tensor, coordinates, tuple(coordinates), "stress", labels)

    def influence(self, *, state: int = -1, sliding: str = "refuse") -> xr.DataArray:
        """The response of each floor force to a small force on any disk, in the limit of zero force.

        The responses of one floor disk follow from one linear system, K^T y = c, with the tangent stiffness K and the
        row c of its floor contact.

        Parameters
        ----------
        state : the loaded state, as of :meth:`contacts_table`, with its errors.
        sliding : with contacts at the Coulomb limit the response depends on the direction of the load. "refuse" raises
            an error then; "stick" takes these contacts as sticking.

        Returns
        -------
        Dimensions ``floor_disk``, ``disk`` and ``component``: the incremental vertical floor force per
        unit force along "x" and "z" and, if disks can rotate, per unit "torque" (1 / mean radius). Coordinates: ``x``
        of floor disks relative to the loaded disk, ``disk_x`` and ``disk_z`` of all disks, in mean radii. NaN for
        rattlers, and along x if nothing holds the packing as a whole. 0 for a disk with prescribed displacement.

        Raises
        ------
        ValueError
            For another ``sliding``.
        granular_response.SolveError
            For a state that is not stable, or has contacts at the Coulomb limit with ``sliding="refuse"``.

        Examples
        --------
        >>> response = result.influence(state=0, sliding="stick").sel(component="z")
        >>> response.dims
        ('floor_disk', 'disk')
        """
        chosen, data = self._solved_state(state), self._data
        disks = data["floor_disk"].values
        found = influence(self._solved.problem, chosen, disks, sliding=sliding)
        across = chosen.box.separation(chosen.position, np.array([self.origin, 0.0]))[:, 0]
        coordinates = {
            "floor_disk": data["floor_disk"],
            "x": ("floor_disk", data["x"].values, data["x"].attrs),
            "disk_x": ("disk", across, {"units": LENGTH}),
            "disk_z": ("disk", chosen.position[:, 1], {"units": LENGTH}),
            "component": ["x", "z", "torque"][: found.shape[2]],
        }
        labels = {"long_name": "vertical floor force per small force on a disk", "units": "1"}
        return xr.DataArray(found, coordinates, ("floor_disk", "disk", "component"), "influence", labels)

    def _index(self, state: int) -> int:
        return state_index(state, len(self.loaded) + 1)

    @staticmethod
    def _added(index: int, added: bool | None) -> bool:
        """Whether incremental forces are meant; raises ValueError for those of the initial equilibrium."""
        rule = "added: a load adds nothing to the initial equilibrium, must be False for state 0"
        require(not added or index != 0, rule)
        return index > 0 if added is None else added

    @property
    def origin(self) -> float:
        """Distance from the left end of the box to where ``x`` is 0: the loaded disk, or the middle of the box."""
        data = self._data
        return origin_of(self.rest.position, data["floor_disk"].values, data["x"].values, self.rest.box)

    def to_dataset(self) -> xr.Dataset:
        """Everything as one labelled dataset: what a stored file holds.

        Examples
        --------
        >>> result.to_dataset()["position"].dims
        ('state', 'disk', 'axis')
        """
        return self._data.copy(deep=True)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Store as netCDF-4, atomically; :func:`open_result` and ``xarray.open_dataset`` read it.

        Raises granular_response.StoreError if the file cannot be written.

        Examples
        --------
        >>> result.save("result.nc")
        >>> gr.open_result("result.nc").load_factors
        (1.0,)
        """
        files.write(path, self._data)

    def export(self, path: str | os.PathLike[str], *, state: int | None = None) -> Path:
        """Write a file for another program; returns its path.

        Parameters
        ----------
        path : its extension is the format: ``.gsd`` and ``.xyz`` for OVITO, ``.vtu`` and ``.pvd`` for ParaView,
            ``.data`` and ``.dump`` for LAMMPS, ``in.lammps`` for a script with the disks and their springs beside it,
            ``.csv`` for disks, ``.contacts.csv`` and ``.events.csv``.
        state : the only one to write, 0 for the initial equilibrium, -1 the last; if left out all, or the last
            one in a format of one state.

        Raises granular_response.ExportError for another extension, a state that does not exist, a scene that the
        program cannot have, a missing library, or a place that cannot be written.

        Examples
        --------
        >>> result.export("slab.contacts.csv", state=0).name
        'slab.contacts.csv'
        >>> path = result.export("slab.csv", state=0)  # a warning: no springs, which are in the table of contacts
        >>> again = gr.Scene(packing=gr.File(path="slab.csv", springs="slab.contacts.csv"))
        >>> result.export("in.lammps", state=0).read_text().splitlines()[9]
        'pair_style gran/hooke/history 3000.0 2400.0 109.54451150103323 97.97958971132712 0.2 1'
        """
        return exporting.export(self._data, path, state=state)

    def continued(self, load_factors: Sequence[float], *, progress: Progress | bool = True) -> Result:
        """The result with states at further ``load_factors``, bitwise those of an uninterrupted run.

        ``progress`` is as of :func:`solve`. Raises as :func:`solve` does, and ResultError where the table of disks has
        changed since.

        Examples
        --------
        >>> result.continued([0.5]).load_factors
        (1.0, 0.5)
        """
        solution = self._solved
        with shown(progress) as report, logged(report):
            further = continue_solution(solution, load_factors, progress=report)
        return vouched(further)

    @cached_property
    def _solved(self) -> Solution:
        """What a solver goes on from."""
        return self._solution or solution_from(self._data, folder=self._folder)

    def _solved_state(self, state: int) -> State:
        """A state with its own list of candidate contacts; raises as :meth:`_index`."""
        return (self._solved.rest, *self._solved.loaded)[self._index(state)]

    @property
    def _data(self) -> xr.Dataset:
        if self._dataset is None:
            assert self._solution is not None
            self._dataset = to_dataset(self._solution)
        return self._dataset

    def _rows(self) -> list[tuple[str, str]]:
        """A line for each state: which, and what its certificate says; whether the load broke in; and how far given
        disks have moved to rest."""
        rows = []
        for k, state in enumerate(self._states):
            touching = int(state.pairs.touching.sum())
            change = touching - int(self.rest.pairs.touching.sum())
            contacts = f"{touching} contacts between disks" + (f" ({change:+d})" if change else "")
            name = f"load factor {state.load_factor:g}" if k else "initial equilibrium"
            stable = {True: "stable", False: "unstable", None: "stability not determined"}[state.certificate.stable]
            stable = stable if state.certificate.balanced else "not in balance"
            text = f"{stable}, max. unbalanced force {state.certificate.force_residual:.1e}, {contacts}"
            if free := len(state.certificate.undetermined):
                text += f", {free} disk{'s' if free > 1 else ''} not determined"
            if stopped := state.reached.stopped_rattlers:
                text += f", {stopped} rolling rattler{'s' if stopped > 1 else ''} stopped by hand"
            rows.append((name, text))
        if said := broke_in(self._states, self._data["loaded_disk"].values):
            rows.append(said)
        if len(self.rest.position) > LARGE and self.rest.reached.time_step is not None:
            rows.append(("time step", self._data.attrs["time_step"]))
        if "distance_from_given" in self._data:
            moved = self._data["distance_from_given"].values[0]
            disk = int(np.argmax(moved))
            text = f"median {np.median(moved):.2g}, largest {moved[disk]:.2g} mean radii (disk {disk})"
            rows.append(("moved from the given places", text))
        return rows

    def _size(self) -> str:
        return f"{len(self.rest.position)} disks in a box {self.rest.box.width:g} wide"

    def __repr__(self) -> str:
        return "\n".join([f"Result: {self._size()}", *(f"  {name}: {text}" for name, text in self._rows())])

    @cached_property
    def _picture(self) -> bytes | None:
        """The response, or the forces on the floor, above the forces in the packing, as PNG; None where none is."""
        from ..plot import pictures  # only a notebook asks for it

        try:
            return pictures.thumbnail(self)
        except GranularError:
            return None

    def _repr_png_(self) -> bytes | None:
        return self._picture

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in self._rows())
        scene = html.escape(scene_text.write(shortened(self.scene.to_dict())))
        picture = self._picture  # notebooks show this text in place of the picture, so it is in it
        image = f'<img src="data:image/png;base64,{b64encode(picture).decode()}" alt="response">' if picture else ""
        return (
            f"<b>Result</b>: {self._size()}{image}<table>{rows}</table>"
            f"<details><summary>scene</summary><pre>{scene}</pre></details>"
        )


def solve(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str],
    *,
    load_factors: Sequence[float] | None = None,
    method: str | None = None,
    progress: Progress | bool = True,
) -> Result:
    """Settle a scene under gravity, then follow its load programme.

    The initial equilibrium r(q) = 0 under gravity comes first. Each state under load continues from the one before it:
    along the contact events of a load path with friction, by minimisation of the energy without. Every state has a
    certificate.

    Parameters
    ----------
    scene : a scene, nested mappings with its keys, or the path of a scene file.
    load_factors : multipliers of the scene's loads (dimensionless), in turn, growing or falling;
        ``protocol.load_factors`` if None.
    method : "auto", "dynamics", "path" or "minimise" in place of ``protocol.method``.
    progress : a bar on the terminal, or a line in a notebook, after two seconds; False for none, or a function that is
        called as ``progress(done, total, stage)``.

    Returns
    -------
    The initial equilibrium and one state for each load factor. Forces are in mg, lengths in mean radii.

    Raises
    ------
    granular_response.SceneError
        For a scene that is not allowed.
    granular_response.SolveError
        If the packing does not settle, or has no equilibrium under a load. The message is one line that says what to
        change.

    Warns
    -----
    UserWarning
        If a state has not settled (``static_finish=False``); if the contact law has no static solver, so that states
        are not certified; if the load is so small that rounding shows in the response; if a setting has no effect with
        the method that is used.

    Examples
    --------
    >>> result = gr.solve(gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9)), load_factors=[0.1, 0.2])
    >>> result.certificate.stable
    True
    """
    asked = described(scene)
    if method is not None:
        asked = asked.updated({"protocol.method": method})
    with shown(progress) as report, logged(report):
        solution = solve_scene(asked, load_factors=load_factors, progress=report)
    return vouched(solution)


def vouched(solution: Solution) -> Result:
    """The result; how it was reached goes into the log, and remarks on it are warnings."""
    for stage, choice in (("gravity", solution.rest_choice), ("loads", solution.load_choice)):
        if choice is not None:
            LOG.info("%s by %s: %s", stage, choice.method, choice.reason)
    for remark in solution.remarks:
        warnings.warn(remark, stacklevel=3)
    return Result(solution)


def described(scene: Scene | Mapping[str, Any] | str | os.PathLike[str]) -> Scene:
    """A scene, or the one that mappings or a file describe; raises SceneError if they do not."""
    if isinstance(scene, (str, os.PathLike)):
        return Scene.from_yaml(scene)
    return scene if isinstance(scene, Scene) else Scene.from_dict(scene)


def _places(name: str, given: Any) -> np.ndarray:
    places = finite_numbers(given)
    require(places is not None, f"{name} = {show(given)}: must be a list of finite numbers")
    return np.array(places)


#: Width of the narrowest sensor, in mean radii: on a narrower one no disk presses, as a rule.
LEAST_SENSOR = 0.01


def _edges(sensors: Any, width: float, radius: float) -> np.ndarray:
    """Edges of sensors, given by them or by the width of each, on a floor of this width."""
    many = np.ndim(sensors) > 0
    given = finite_numbers(sensors if many else [sensors])
    edges = np.array([] if given is None else given)
    said = show(sensors)
    if not many and len(edges) and edges[0] > 0.0:
        rule = f"sensors = {said}: must be in mm, {LEAST_SENSOR:g} of the mean radius of {radius:.3g} mm or more"
        require(edges[0] >= LEAST_SENSOR * radius, rule, ValueError)
        # one for the rest, unless that is what the radius may be off
        count = max(math.floor(width / edges[0] * (1.0 + 1e-12)), math.ceil((1.0 - SAME_RADIUS) * width / edges[0]))
        edges = edges[0] * np.arange(count + 1)
    if len(edges) < 2 or not (np.diff(edges) > 0.0).all():
        raise ValueError(f"sensors = {said}: must be a width in mm, greater than 0, or edges in mm that grow")
    return edges


def open_result(path: str | os.PathLike[str], *, folder: str | os.PathLike[str] | None = None) -> Result:
    """A stored result.

    ``folder`` is that of the scene file, where a packing from a table is to be continued.

    Raises granular_response.StoreError if the file cannot be read; granular_response.ResultError if it holds something
    else than a whole result.

    Examples
    --------
    >>> result.save("result.nc")
    >>> gr.open_result("result.nc").scene == result.scene
    True
    """
    return Result(dataset=read_result(path), folder=folder)
