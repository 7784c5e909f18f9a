"""Pictures of a result: its response, forces on the floor and in the packing, contacts, stress, and the packing itself.

Each takes a ``Result`` or the dataset of one (``Result.to_dataset``, or a stored file as xarray opens it). ``state`` is
0 for the initial equilibrium, then one for each load factor, -1 the last. Without ``ax`` a picture has a
figure of its own, made by pyplot.
"""

from __future__ import annotations

import contextlib
import os
import reprlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from ..errors import GranularError
from ..observe import positive
from ..observe.floor import origin_of
from ..observe.stress import ContactForces, coarse_grained_stress, grid_points
from ..state import OPEN, SLIDING, Box, FloatArray, foot_points, wall_normals
from ..store import atomic
from . import network, style
from .field import draw_field, root_norm

Scale = Literal["linear", "sqrt", "percentile"]


#: Most curves that a legend names: of more, some from the first to the last.
MOST_NAMED = 8


class PictureError(GranularError, ValueError):
    """A picture that cannot be drawn as asked. The message is one line."""


def check_positive(**given: float | None) -> None:
    """PictureError, with its name, for the first of ``given`` that is no number greater than 0; None is left out."""
    try:
        positive.check_positive(**{name: value for name, value in given.items() if value is not None})
    except ValueError as error:
        raise PictureError(str(error)) from None


@contextlib.contextmanager
def written(output: str | os.PathLike[str]) -> Iterator[None]:
    """A file that cannot be written within it is a PictureError."""
    try:
        yield
    except OSError as error:
        raise PictureError(f"{output}: cannot be written: {error.strerror or error}") from error


class HasDataset(Protocol):
    """A result."""

    def to_dataset(self) -> xr.Dataset: ...


@dataclass(frozen=True)
class Shown:
    """One state of a result as pictures take it: plain arrays, contacts on the list that all states share."""

    data: xr.Dataset
    index: int

    @classmethod
    def of(cls, result: HasDataset | xr.Dataset, state: int = -1) -> Shown:
        """Raises TypeError for what is no result, PictureError for a dataset or a state that is not there."""
        if not isinstance(result, xr.Dataset):
            if not hasattr(result, "to_dataset"):
                kind = type(result).__name__
                raise TypeError(f"result: must be a Result or its dataset, not {kind} (open_result reads a file)")
            result = result.to_dataset()
        if not {"position", "contact_force", "wall_force", "state_load_factor"} <= set(result.variables):
            raise PictureError("result: the dataset holds no states of a packing (open_result reads a file)")
        if isinstance(state, bool) or not isinstance(state, (int, np.integer)):
            raise PictureError(f"state = {state!r}: must be an integer, 0 for the initial equilibrium")
        count = result.sizes["state"]
        if not -count <= state < count:
            raise PictureError(f"state = {state}: must be from {-count} to {count - 1}, there are {count} states")
        return cls(result, int(state) % count)

    def values(self, name: str, index: int | None = None) -> np.ndarray:
        """A variable in this state, or in another one."""
        variable = self.data[name]
        if "state" in variable.dims:
            variable = variable.isel(state=self.index if index is None else index)
        return variable.values

    @property
    def position(self) -> FloatArray:
        return self.values("position")

    @property
    def radius(self) -> FloatArray:
        return self.values("radius")

    @property
    def box(self) -> Box:
        return Box.of(self.data.attrs)

    @property
    def top(self) -> float:
        """Highest point of a disk."""
        return float((self.position[:, 1] + self.radius).max())

    @property
    def origin(self) -> float:
        """Where ``x`` of the response is 0."""
        return origin_of(self.values("position", 0), self.values("floor_disk"), self.values("x"), self.box)

    @property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        return self.values("contact_disk"), self.values("contact_partner")

    def across(self, half_width: float | None) -> tuple[float, float]:
        """From where to where a picture goes: ``half_width`` to both sides of the loaded disks, the packing at most.

        Of a periodic packing all is shown, as what is near a load may be at both ends of it.
        """
        ends = -1.5, self.box.width + 1.5
        if half_width is None or not self.loads or self.box.periodic:
            return ends
        x = self.position[[disk for disk, *_ in self.loads], 0]
        return max(ends[0], float(x.min()) - half_width), min(ends[1], float(x.max()) + half_width)

    def forces(self, added: bool) -> tuple[FloatArray, FloatArray]:
        """Of contacts of disks and at walls, whole or ``added``: the incremental forces."""
        pair, wall = (
            self.values(name) - (self.values(name, 0) if added else 0.0) for name in ("contact_force", "wall_force")
        )
        return pair, wall

    @property
    def lack(self) -> str:
        """Why there is no response, which is divided by the force of the loads; empty where there is one."""
        if np.isfinite(self.data["floor_response"].values).any():
            return ""
        if not self.data.sizes["load_point"]:
            return "no loads"
        if self.data.sizes["state"] == 1:
            return "no state under load"
        if "reaction" not in self.data and not self.data["applied_load"].values[:, :2].any():
            return "no load has a force"
        return "the loads apply no force in any state"

    @cached_property
    def loads(self) -> list[tuple[int, FloatArray, float]]:
        """Disk, force and torque of each load in this state."""
        if not self.index:
            return []
        applied = float(self.values("state_load_factor")) * self.values("applied_load")
        if "reaction" in self.data:
            reaction = self.data["reaction"]
            applied[:, :2] += (reaction.isel(load=self.index - 1) if "load" in reaction.dims else reaction).values
        return [
            (int(disk), load[:2], float(load[2]))
            for disk, load in zip(self.values("loaded_disk"), applied, strict=True)
            if load.any()
        ]


def response(result: HasDataset | xr.Dataset, *, ax: Axes | None = None, **line: Any) -> Axes:
    """The floor response against the position relative to the loaded disk, a curve for each load (Fig. 7).

    ``line`` goes to ``Axes.plot``. Raises PictureError for a result without forces to respond to; see :func:`floor`.

    Examples
    --------
    >>> gr.plot.response(result).figure.savefig("response.png")
    """
    shown = Shown.of(result)
    if shown.lack:
        raise PictureError(f"result: {shown.lack}, so there is no response; floor draws the forces on the floor")
    with style.context():
        axes = _axes(ax, 0.36)
        curves = np.atleast_2d(shown.data["floor_response"].values)
        forces, colours = np.atleast_1d(shown.data["total_force"].values), style.ordered_colours(len(curves))
        branches = shown.data["branch"].values if "branch" in shown.data.variables else ["loading"] * len(curves)
        one_branch = all(branch == "loading" for branch in branches)
        named = set(np.linspace(0, len(curves) - 1, min(len(curves), MOST_NAMED)).round().astype(int).tolist())
        for k, (curve, force, branch) in enumerate(zip(curves, forces, branches, strict=True)):
            if not np.isnan(curve).all():  # unloaded: floor draws what is left
                label = (f"{force:g}" if one_branch else f"{force:g} ({branch})") if k in named else None
                look = {**style.marked_line(k, colour=colours[k]), "markersize": 2.6, "label": label, **line}
                axes.plot(shown.data["x"].values, curve, **look)
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
        axes.set(xlabel=style.POSITION, ylabel=style.RESPONSE)
        axes.margins(x=0.02)
        axes.legend(title=style.FORCE)
    return axes


def floor(
    result: HasDataset | xr.Dataset, *, ax: Axes | None = None, state: int = -1, added: bool | None = None, **line: Any
) -> Axes:
    """The vertical force on each floor disk in mean disk weights, by default the incremental force.

    For what has no response: an initial equilibrium, and loads that are torques alone.

    Parameters
    ----------
    added : draw incremental forces (those under gravity subtracted); by default so for states under load.
    line : goes to ``Axes.plot``.

    Examples
    --------
    >>> gr.plot.floor(result).figure.savefig("floor.png")
    """
    shown = Shown.of(result, state)
    added = shown.index > 0 if added is None else added
    rest = shown.data["floor_force_rest"].values
    force = np.atleast_2d(shown.data["floor_force"].values)[shown.index - 1] if shown.index else rest
    with style.context():
        axes = _axes(ax, 0.36)
        look = {**style.marked_line(0, colour=style.ordered_colours(1)[0]), "markersize": 2.6, **line}
        axes.plot(shown.data["x"].values, force - rest if added else force, **look)
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
        axes.set(xlabel=style.POSITION, ylabel=style.INCREMENTAL_FLOOR_FORCE if added else style.FLOOR_FORCE)
        axes.margins(x=0.02)
    return axes


def forces(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    added: bool | None = None,
    scale: Scale = "sqrt",
    vmax: float | None = None,
    half_width: float | None = None,
    **lines: Any,
) -> Axes:
    """Force chains: each contact force is a line along it, as long and as wide as it is large (Figs. 2, 13).

    Parameters
    ----------
    added : draw the incremental force of each contact, gravity subtracted as a vector (Sec. III.C): dark where it
        presses the disks together, pale where compression decreases. By default so for states under load.
    scale : of lengths and widths: linear in the force as in the paper, by its square root, which shows the
        chains of a point load beyond its first rows, or by the percentile of the force among all.
    vmax : magnitude that has full length, in mean disk weights; by default that of the largest force. Give several
        pictures the same one to compare them (not for percentiles).
    half_width : draw what is within this distance of the loaded disks, in mean radii; by default all.
    lines : go to ``LineCollection``, such as ``color="tab:blue"`` or ``alpha``.

    Examples
    --------
    >>> gr.plot.forces(result, scale="linear").figure.savefig("forces.png")
    """
    shown = Shown.of(result, state)
    added = shown.index > 0 if added is None else added
    if scale not in network.SCALES:
        raise PictureError(f"scale = {scale!r}: must be one of {', '.join(network.SCALES)}")
    check_positive(vmax=vmax, half_width=half_width)
    pair, wall = shown.forces(added)
    normal = shown.box.separation(*(shown.position[disks] for disks in shown.pairs))
    inward = wall_normals(shown.values("wall_index"))
    between = network.pair_points(shown.position, shown.radius, *shown.pairs, box=shown.box)
    at_wall = shown.values("wall_disk")
    feet = foot_points(shown.position[at_wall], shown.radius[at_wall], shown.values("wall_index"))
    point = np.concatenate([between, feet])
    force, direction = np.concatenate([pair, wall]), np.concatenate([normal, inward])
    reference = float(np.linalg.norm(force, axis=1).max(initial=0.0)) if vmax is None else vmax
    drawn = network.rescaled(force, scale, largest=reference)
    with style.context():
        axes = _axes(ax, _aspect(shown, half_width))
        _packing(axes, shown, half_width, edgecolor="none", facecolor=style.DISKS)
        # by percentile, half of all forces are large: shorter and thinner lines keep them apart
        crowded = 0.5 if scale == "percentile" else 1.0
        # the largest force is as wide as the radius of a disk across the page, in points
        inches = axes.figure.get_figure(root=True).get_size_inches()[0] * axes.get_position().width
        widest = crowded * float(np.clip(72.0 * inches / np.ptp(axes.get_xlim()), 0.8, 5.0))
        look = {"length_per_force": 4.0 * crowded, "width_per_force": widest, "smallest": 0.02, **lines}
        kinds = network.draw_forces(axes, point, drawn, direction, **look)
        handles = [
            Line2D([], [], color=lines.get("color", network.FORCE_LINES[name]["color"]), linewidth=1.6, label=name)
            for name in (kinds if added else ())
        ]
        if reference > 0.0 and scale != "percentile":
            for size in (reference, 0.1 * reference):
                part = float(network.SCALES[scale](np.array([size / reference]))[0])
                name = f"${size:.2g}\\,\\bar m g$"
                handles.append(Line2D([], [], color=style.INCREASED, linewidth=widest * part, label=name))
        _legend(axes, handles, shown, half_width)
    return axes


def contacts(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    half_width: float | None = None,
    **lines: Any,
) -> Axes:
    """What a load changes in the contact network: opened, closed and sliding contacts (Figs. 4, 8, 9).

    ``half_width`` is that of :func:`forces`; ``lines`` go to ``LineCollection``.

    Examples
    --------
    >>> gr.plot.contacts(result).figure.savefig("contacts.png")
    """
    shown = Shown.of(result, state)
    check_positive(half_width=half_width)
    before, now = shown.values("contact_status", 0), shown.values("contact_status")
    with style.context():
        axes = _axes(ax, _aspect(shown, half_width))
        _packing(axes, shown, half_width)
        drawn = network.draw_contact_changes(
            axes,
            shown.position,
            *shown.pairs,
            touching_before=before != OPEN,
            touching=now != OPEN,
            sliding=now == SLIDING,
            box=shown.box,
            **lines,
        )
        _legend(axes, list(drawn.values())[::-1], shown, half_width)
    return axes


def stress(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    added: bool | None = None,
    component: Literal["xx", "xz", "zx", "zz"] = "zz",
    width: float = 2.0,
    vmax: float | None = None,
    half_width: float | None = None,
    cmap: str = style.SIGNED,
    **mesh: Any,
) -> Axes:
    """A component of the coarse-grained stress, by default the incremental stress (Fig. 14).

    Compression is blue, its loss red, in steps of the square root. Within ``width`` of the floor and of side walls
    (dotted) part of the Gaussian lies outside the packing, so the stress falls there.

    Parameters
    ----------
    added : draw the incremental stress (that under gravity subtracted); by default so for states under load.
    component : indices of the tensor, the force's first.
    width : of the Gaussian in mean radii (Sec. V.C).
    vmax : end of the colour scale, in mean disk weights per mean radius; by default the largest magnitude.
    half_width : as of :func:`forces`.
    cmap : colour map of matplotlib; zero is in its middle.
    mesh : goes to ``Axes.pcolormesh``.

    Examples
    --------
    >>> gr.plot.stress(result, vmax=2.0).figure.savefig("stress.png")
    """
    shown = Shown.of(result, state)
    added = shown.index > 0 if added is None else added
    if component not in ("xx", "xz", "zx", "zz"):
        raise PictureError(f"component = {component!r}: must be one of xx, xz, zx, zz")
    check_positive(vmax=vmax, half_width=half_width)
    first, second = shown.pairs
    at_wall, wall = shown.position[shown.values("wall_disk")], shown.values("wall_index")
    separation = shown.box.separation(shown.position[first], shown.position[second])
    carried = ContactForces(
        point=np.concatenate([shown.position[first], at_wall]),
        branch=np.concatenate([separation, at_wall - shown.box.on_wall(at_wall, wall)]),
        force=np.concatenate(shown.forces(added)),
        period=shown.box.period,
    )
    step = max(0.5, max(shown.box.width, shown.top) / 240.0)
    left = -0.5 * shown.box.width if shown.box.periodic else -shown.origin
    x = left + np.linspace(0.0, shown.box.width, round(shown.box.width / step) + 1)
    z = np.linspace(0.0, shown.top, round(shown.top / step) + 1)
    tensor = coarse_grained_stress(carried, grid_points(x + shown.origin, z), width)
    field = tensor[..., "xz".index(component[0]), "xz".index(component[1])]
    end = float(np.abs(field).max()) if vmax is None else vmax
    with style.context():
        axes = _axes(ax, _aspect(shown, half_width))
        norm = root_norm(end if end > 0.0 else 1.0, signed=True)
        image = draw_field(axes, x, z, field, norm=norm, cmap=cmap, **mesh)
        near: dict[str, Any] = {"color": style.MUTED, "linewidth": 0.5, "linestyle": ":"}
        axes.axhline(width, **near)
        for side in () if shown.box.periodic else (width, shown.box.width - width):
            axes.axvline(side - shown.origin, **near)
        network.draw_box(axes, shown.box, shown.top, shift=left)
        _loads(axes, shown, origin=shown.origin)
        axes.set(ylim=(-0.03 * shown.top, None), xlabel=style.POSITION, ylabel=style.HEIGHT)
        if not shown.box.periodic:
            left, right = shown.across(half_width)
            axes.set_xlim(left - shown.origin, right - shown.origin)
        axes.tick_params(top=False, right=False)
        bar = axes.figure.colorbar(image, ax=axes, shrink=0.9, aspect=14, pad=0.02)
        bar.set_label(f"{'incremental ' if added else ''}$\\sigma_{{{component}}}\\bar R/\\bar m g$")
        ticks = [end * part for part in (-1.0, -0.25, 0.0, 0.25, 1.0)]
        bar.set_ticks(ticks, labels=[f"${tick:.2g}$" for tick in ticks])
        bar.ax.minorticks_off()
    return axes


def packing(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    values: ArrayLike | None = None,
    label: str = "",
    cmap: str = style.SEQUENTIAL,
    **patches: Any,
) -> Axes:
    """The disks with their contacts, the box and the loads.

    ``values`` (n,) fill the disks with colours of ``cmap``; ``label`` names them at the colour bar. ``patches`` go to
    the ``PatchCollection`` of the disks.

    Examples
    --------
    >>> gr.plot.packing(result, values=result.rest.angle, cmap="viridis").figure.savefig("packing.png")
    """
    shown = Shown.of(result, state)
    touching = shown.values("contact_status") != OPEN
    with style.context():
        axes = _axes(ax, _aspect(shown))
        if values is None:
            _packing(axes, shown, **{"edgecolor": style.MUTED, "facecolor": "#EDF2F6", **patches})
            network.draw_rotations(
                axes, shown.position, shown.radius, shown.values("angle"), color=style.SKY, linewidth=0.5
            )
        else:
            try:
                number: FloatArray = np.ma.filled(np.ma.array(values, dtype=float), np.nan)  # masked: not known
            except (TypeError, ValueError):
                raise PictureError(f"values = {reprlib.repr(values)}: must be numbers, a disk each") from None
            if number.shape != shown.radius.shape:
                raise PictureError(f"values: must have shape {shown.radius.shape}, a disk each, not {number.shape}")
            look = {"cmap": cmap, "edgecolor": style.MUTED, **patches}
            disks = _packing(axes, shown, values=number, **look)
            axes.figure.colorbar(disks, ax=axes, shrink=0.9, aspect=14, pad=0.02).set_label(label)
        network.draw_contacts(
            axes, shown.position, *(disks[touching] for disks in shown.pairs), box=shown.box, linewidth=0.5, zorder=3
        )
    return axes


def _photoelastic(result: HasDataset | xr.Dataset, **options: Any) -> Axes:
    from .photoelastic import photoelastic  # which is drawn with what is here

    return photoelastic(result, **options)


#: The pictures of a page, by name.
PICTURES: Mapping[str, Callable[..., Axes]] = {
    "response": response,
    "floor": floor,
    "forces": forces,
    "contacts": contacts,
    "stress": stress,
    "packing": packing,
    "photoelastic": _photoelastic,
}
#: Those that are curves over the floor, not maps of the packing.
_GRAPHS = ("response", "floor")
#: Those that a page shows near the loaded disks, and how near, per height of the packing.
_CUT, NEAR = ("forces", "contacts", "stress"), 1.5


def page(
    result: HasDataset | xr.Dataset,
    what: str | Sequence[str] | None = None,
    *,
    state: int = -1,
    scale: Scale = "sqrt",
    figure: Figure | None = None,
) -> Figure:
    """One figure with a picture for each of ``what``, in this order.

    ``what`` are names of the functions of this module or ``photoelastic``, as a list or as text with commas.

    By default ``response``, ``forces``, ``contacts`` and ``stress``, with ``floor`` where there is no response.
    Forces, contacts and stress of a wide packing are shown within :data:`NEAR` times its height of the loaded disks.
    ``scale`` is that of :func:`forces`; ``figure`` is drawn into, or a new one of pyplot's.

    Raises PictureError for another name, and what the pictures raise.

    Examples
    --------
    >>> gr.plot.page(result, "response,forces").savefig("page.png")
    """
    what = [name.strip() for name in what.split(",")] if isinstance(what, str) else what
    for name in what or ():
        if name not in PICTURES:
            raise PictureError(f"what = {name!r}: must be among {', '.join(PICTURES)}")
    if what is not None and not what:
        raise PictureError(f"what: nothing to draw, must be among {', '.join(PICTURES)}")
    shown = Shown.of(result, state)
    if what is None:
        what = ("floor" if shown.lack else "response", "forces", "contacts", "stress")
    half_width = NEAR * shown.top
    with style.context():
        columns = 1 if len(what) == 1 or _aspect(shown, half_width) < 0.6 else 2
        rows = -(-len(what) // columns)
        wide = style.DOUBLE / columns
        shape = {name: _aspect(shown, half_width if name in _CUT else None) for name in what}
        heights = [0.36 * wide if name in _GRAPHS else shape[name] * wide + 0.25 for name in what]
        in_row = [max(heights[k * columns : (k + 1) * columns]) + 0.12 for k in range(rows)]
        figure = _new_figure(sum(in_row)) if figure is None else figure
        figure.set_size_inches(style.DOUBLE, sum(in_row))
        figure.set_layout_engine("compressed")
        panels = figure.subplots(rows, columns, squeeze=False, height_ratios=in_row)
        for k, axes in enumerate(panels.ravel()):
            if k >= len(what):
                axes.set_axis_off()
                continue
            options: dict[str, Any] = {} if what[k] == "response" else {"state": state}
            options |= {"half_width": half_width} if what[k] in _CUT else {}
            options |= {"scale": scale} if what[k] == "forces" else {}
            PICTURES[what[k]](shown.data, ax=axes, **options)
            if what[k] in _GRAPHS and columns > 1:
                axes.set_box_aspect(0.75)
            style.letter(axes, chr(ord("a") + k), place="above", text=_title(what[k], shown))
        figure.draw_without_rendering()  # maps keep their shape: what they leave of the estimated height is cut off
        figure.set_size_inches(style.DOUBLE, figure.get_tightbbox().height + 2.0 * style.MARGIN)
    return figure


def save(
    result: HasDataset | xr.Dataset,
    output: str | os.PathLike[str],
    what: str | Sequence[str] | None = None,
    *,
    state: int = -1,
    scale: Any = "sqrt",
    inputs: Sequence[str | os.PathLike[str]] = (),
) -> Path:
    """Write the :func:`page` of a result as ``.pdf``, ``.png`` or ``.svg``, atomically; returns its path.

    Raises PictureError for another format, for what :func:`page` refuses, and for a place that cannot be written or is
    one of ``inputs``.
    """
    path = Path(output)
    if path.suffix not in (".pdf", ".png", ".svg"):
        raise PictureError(f"{path}: format {path.suffix!r} is unknown, must be .pdf, .png or .svg")
    drawn = style.render(page(result, what, state=state, scale=scale, figure=Figure()), path.suffix[1:])
    with written(path):
        atomic.make_folder(path)
        atomic.check_output(path, inputs)
        atomic.write_bytes(path, drawn)
    return path


def _title(what: str, shown: Shown) -> str:
    total = sum(float(np.hypot(*force)) for _, force, _ in shown.loads)
    turning = sum(abs(torque) for *_, torque in shown.loads)
    load = f"$F_{{\\mathrm{{ext}}}} = {total:.4g}\\,\\bar m g$" if shown.index else "at rest"
    if turning and not total:
        load = f"torque ${turning:.4g}\\,{style.TORQUE_UNIT}$"
    names = {"floor": "floor forces", "forces": "incremental forces" if shown.index else "forces"}
    return style.RESPONSE if what == "response" else f"{names.get(what, what)}, {load}"


def _axes(ax: Axes | None, aspect: float) -> Axes:
    """The given axes, or those of a new figure as high as ``aspect`` times its width."""
    if ax is not None:
        return ax
    return _new_figure(max(1.4, aspect * style.DOUBLE + 0.35)).subplots()


def _new_figure(height: float) -> Figure:
    """A figure that notebooks show and ``pyplot.show`` opens, ``height`` inches high."""
    import matplotlib.pyplot as plt  # here, so that figures without a display never touch it

    return plt.figure(figsize=(style.DOUBLE, height), layout="constrained")


def _aspect(shown: Shown, half_width: float | None = None) -> float:
    """Height over width of a picture of the packing, with room for the arrow of a load."""
    return float(1.2 * shown.top / np.ptp(shown.across(half_width)))


def _packing(axes: Axes, shown: Shown, half_width: float | None = None, **disks: Any) -> Any:
    """Disks, box and loads, without axes."""
    look = {"edgecolor": "#DCDCDC", "linewidth": 0.4, **disks}
    drawn = network.draw_disks(axes, shown.position, shown.radius, zorder=1, **look)
    network.draw_box(axes, shown.box, shown.top)
    _loads(axes, shown)
    style.no_axes(axes)
    axes.set(xlim=shown.across(half_width), ylim=(-1.2, max(axes.dataLim.ymax, shown.top) + 0.5))
    return drawn


def _loads(axes: Axes, shown: Shown, *, origin: float | None = None) -> None:
    """Loaded disks, and an arrow for each force that ends at the disk it pushes, the largest a fifth of the height.

    ``origin`` : from where the picture counts x, the shortest way.
    """
    if not shown.loads:
        return
    # loads that look alike are drawn once
    loads = dict.fromkeys((disk, *force.tolist(), torque) for disk, force, torque in shown.loads)
    largest = max((float(np.hypot(*force)) for _, *force, _ in loads), default=0.0)
    disks = list(dict.fromkeys(disk for disk, *_ in loads))
    centres = shown.position[disks]
    if origin is not None:
        centres = shown.box.separation(centres, np.array([origin, 0.0]))
    network.draw_loaded_disk(axes, centres, shown.radius[disks])
    places = dict(zip(disks, centres, strict=True))
    for disk, *components, torque in loads:
        force, centre, radius = np.array(components), places[disk], float(shown.radius[disk])
        if size := float(np.hypot(*force)):
            length = max(3.0, 0.16 * shown.top) * size / largest
            network.draw_load(axes, centre - radius * force / size, force, length=length)
        network.draw_torque(axes, centre, torque, radius=1.7 * radius)
        if torque and not largest:  # no arrow of a force makes room for the arc
            network.include(axes, centre[None] + (0.0, 2.2 * radius))


def _legend(axes: Axes, handles: Sequence[Any], shown: Shown, half_width: float | None) -> None:
    """Below the picture, in two columns where that is narrow."""
    if handles:
        columns = len(handles) if _aspect(shown, half_width) < 0.6 else 2
        below: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "borderaxespad": 0.2}
        axes.legend(handles=handles, ncols=columns, columnspacing=1.4, **below)
