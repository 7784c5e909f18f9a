"""Pictures of a result: its response, forces on the floor and in the packing, contacts, stress, and the packing itself.

Each takes a ``Result`` or the dataset of one (``Result.to_dataset``, or a stored file as xarray opens it). ``state`` is
0 for the initial equilibrium, then one for each load factor, -1 the last; IndexError for one that does not exist.
Without ``ax`` a picture has a figure of its own, made by pyplot. Fonts, sizes, line widths and the cycle of colours of
curves are those that the user has set in ``matplotlib.rcParams``.
"""

from __future__ import annotations

import os
import reprlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cbook import normalize_kwargs
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, is_color_like, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from ..errors import require
from ..observe.stress import ContactForces, coarse_grained_stress, grid_points
from ..state import OPEN, SLIDING, FloatArray, foot_points, wall_normals
from ..store import atomic
from . import network, style
from .field import draw_field, root_norm
from .photoelastic import photoelastic
from .shown import HasDataset, Shown, aspect_of, check_positive, draw_loads, new_axes, new_figure, written
from .shown import PictureError as PictureError

Scale = Literal["linear", "sqrt", "percentile"]

#: A stress whose smallest value is not below this part of its largest is compression everywhere, and drawn so.
ONE_SIGN = -0.02
#: Most curves that a legend names: of more, some from the first to the last.
MOST_NAMED = 8


def response(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    color: Any = None,
    cmap: str | Colormap | None = None,
    **line: Any,
) -> Axes:
    """The floor response against the position relative to the loaded disk, a curve for each load (Fig. 7).

    Parameters
    ----------
    color : of all curves, or a list with a colour for each; by default those of ``cmap``, of the user's
        ``axes.prop_cycle``, or a ramp from dark to light.
    cmap : colour map of matplotlib, from the first curve to the last.
    line : goes to ``Axes.plot``, also as matplotlib shortens its names (``lw``, ``ls``, ``c``).

    Raises
    ------
    granular_response.plot.PictureError
        For a result without forces to respond to, see :func:`floor`, and for colours that are not one or one for each
        curve.

    Examples
    --------
    >>> gr.plot.response(result, cmap="plasma", lw=1.5).figure.savefig("response.png")
    """
    shown = Shown.of(result)
    rule = f"result: {shown.lack}, so there is no response; floor draws the forces on the floor"
    require(not shown.lack, rule, PictureError)
    with style.with_users():
        axes = new_axes(ax, 0.36)
        curves = np.atleast_2d(shown.data["floor_response"].values)
        line = _aliased(line, Line2D, color)
        colours = _colours(len(curves), line.pop("color", None), cmap)
        forces = np.atleast_1d(shown.data["total_force"].values)
        branches = shown.data["branch"].values if "branch" in shown.data.variables else ["loading"] * len(curves)
        one_branch = all(branch == "loading" for branch in branches)
        named = set(np.linspace(0, len(curves) - 1, min(len(curves), MOST_NAMED)).round().astype(int).tolist())
        for k, (curve, force, branch) in enumerate(zip(curves, forces, branches, strict=True)):
            if not np.isnan(curve).all():  # unloaded: floor draws what is left
                label = (f"{force:g}" if one_branch else f"{force:g} ({branch})") if k in named else None
                look = {**_marked(k, colours[k]), "label": label, **line}
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
    with style.with_users():
        axes = new_axes(ax, 0.36)
        look = {**_marked(0, style.ordered_colours(1)[0]), **_aliased(line, Line2D)}
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
    color: Any = None,
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
    color : of forces that the load increases, of which those that it decreases have a pale tint; or two, for these
        and those.
    lines : go to ``LineCollection``, such as ``alpha``.

    Examples
    --------
    >>> gr.plot.forces(result, scale="linear").figure.savefig("forces.png")
    """
    shown = Shown.of(result, state)
    added = shown.index > 0 if added is None else added
    require(scale in network.SCALES, f"scale = {scale!r}: must be one of {', '.join(network.SCALES)}", PictureError)
    check_positive(vmax=vmax, half_width=half_width)
    lines = _aliased(lines, LineCollection, color)
    colours = _two_colours(lines.pop("color", None))
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
    with style.with_users():
        axes = new_axes(ax, aspect_of(shown, half_width))
        _packing(axes, shown, half_width, edgecolor="none", facecolor=style.DISKS)
        # by percentile, half of all forces are large: shorter and thinner lines keep them apart
        crowded = 0.5 if scale == "percentile" else 1.0
        # the largest force is as wide as the radius of a disk across the page, in points
        inches = axes.figure.get_figure(root=True).get_size_inches()[0] * axes.get_position().width
        widest = crowded * float(np.clip(72.0 * inches / np.ptp(axes.get_xlim()), 0.8, 5.0))
        look = {"length_per_force": 4.0 * crowded, "width_per_force": widest, "smallest": 0.02, **lines}
        kinds = network.draw_forces(axes, point, drawn, direction, **look)
        for name, kind in kinds.items():
            kind.set_color(colours[name])
        handles = [Line2D([], [], color=colours[name], linewidth=1.6, label=name) for name in (kinds if added else ())]
        if reference > 0.0 and scale != "percentile":
            for size in (reference, 0.1 * reference):
                part = float(network.SCALES[scale](np.array([size / reference]))[0])
                name = f"${size:.2g}\\,\\bar m g$"
                handles.append(Line2D([], [], color=colours["force increased"], linewidth=widest * part, label=name))
        _legend(axes, handles, shown, half_width)
    return axes


def contacts(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    half_width: float | None = None,
    color: Mapping[str, Any] | None = None,
    **lines: Any,
) -> Axes:
    """What a load changes in the contact network: opened, closed and sliding contacts (Figs. 4, 8, 9).

    ``half_width`` is that of :func:`forces`; ``color`` has colours by kind (unchanged, sliding, closed, opened), such
    as ``{"opened": "tab:red"}``; ``lines`` go to ``LineCollection``. Raises PictureError for a colour of another kind.

    Examples
    --------
    >>> gr.plot.contacts(result).figure.savefig("contacts.png")
    """
    shown = Shown.of(result, state)
    check_positive(half_width=half_width)
    lines = _aliased(lines, LineCollection, color)
    colours = lines.pop("color", None) or {}
    if not isinstance(colours, Mapping) or not set(colours) <= set(network.KINDS):
        kinds = ", ".join(network.KINDS)
        raise PictureError(f"color = {reprlib.repr(colours)}: must be colours by kind, which are {kinds}")
    before, now = shown.values("contact_status", 0), shown.values("contact_status")
    with style.with_users():
        axes = new_axes(ax, aspect_of(shown, half_width))
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
        for kind, colour in colours.items():
            if kind in drawn:
                drawn[kind].set_color(colour)
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
    cmap: str | Colormap | None = None,
    **mesh: Any,
) -> Axes:
    """A component of the coarse-grained stress, by default the incremental stress (Fig. 14).

    In steps of the square root. Where all is compression (no value below :data:`ONE_SIGN` of the largest) it is bright
    where it is large; otherwise compression is blue, its loss red. Within ``width`` of the floor and of side walls
    (dotted) part of the Gaussian lies outside the packing, so the stress falls there.

    Parameters
    ----------
    added : draw the incremental stress (that under gravity subtracted); by default so for states under load.
    component : indices of the tensor, the force's first.
    width : of the Gaussian in mean radii (Sec. V.C).
    vmax : end of the colour scale, in mean disk weights per mean radius; by default the largest magnitude.
    half_width : as of :func:`forces`.
    cmap : colour map of matplotlib; its middle is zero, or its beginning where all is compression.
    mesh : goes to ``Axes.pcolormesh``.

    Examples
    --------
    >>> gr.plot.stress(result, vmax=2.0).figure.savefig("stress.png")
    """
    shown = Shown.of(result, state)
    added = shown.index > 0 if added is None else added
    rule = f"component = {component!r}: must be one of xx, xz, zx, zz"
    require(component in ("xx", "xz", "zx", "zz"), rule, PictureError)
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
    signed = bool(field.min() < ONE_SIGN * field.max())
    with style.with_users():
        axes = new_axes(ax, aspect_of(shown, half_width))
        norm = root_norm(end if end > 0.0 else 1.0, signed=signed)
        mesh = {"cmap": cmap or (style.SIGNED if signed else style.SEQUENTIAL), **mesh}
        image = draw_field(axes, x, z, field, norm=norm, **mesh)
        near: dict[str, Any] = {"color": style.MUTED if signed else style.FAINT, "linewidth": 0.7, "linestyle": ":"}
        axes.axhline(width, **near)
        for side in () if shown.box.periodic else (width, shown.box.width - width):
            axes.axvline(side - shown.origin, **near)
        network.draw_box(axes, shown.box, shown.top, shift=left)
        draw_loads(axes, shown, origin=shown.origin)
        axes.set(ylim=(-0.03 * shown.top, None), xlabel=style.POSITION, ylabel=style.HEIGHT)
        if not shown.box.periodic:
            left, right = shown.across(half_width)
            axes.set_xlim(left - shown.origin, right - shown.origin)
        axes.tick_params(top=False, right=False)
        walls = "the floor" if shown.box.periodic else "the floor and the walls"
        axes.annotate(
            rf"dotted: ${width:g}\,{style.RADIUS}$ from {walls}",
            (1.0, 0.0),
            (0.0, -2.0 * mpl.rcParams["font.size"]),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            va="center_baseline",
            fontsize=mpl.rcParams["legend.fontsize"],
            color=style.MUTED,
        )
        bar = axes.figure.colorbar(image, ax=axes, shrink=0.9, aspect=14, pad=0.02)
        bar.set_label(f"{'incremental ' if added else ''}$\\sigma_{{{component}}}\\bar R/\\bar m g$")
        ticks = [end * part for part in ((-1.0, -0.25, 0.0, 0.25, 1.0) if signed else (0.0, 0.0625, 0.25, 1.0))]
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
    with style.with_users():
        axes = new_axes(ax, aspect_of(shown))
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
            rule = f"values: must have shape {shown.radius.shape}, a disk each, not {number.shape}"
            require(number.shape == shown.radius.shape, rule, PictureError)
            look = {"cmap": cmap, "edgecolor": style.MUTED, **patches}
            disks = _packing(axes, shown, values=number, **look)
            axes.figure.colorbar(disks, ax=axes, shrink=0.9, aspect=14, pad=0.02).set_label(label)
        network.draw_contacts(
            axes, shown.position, *(disks[touching] for disks in shown.pairs), box=shown.box, linewidth=0.5, zorder=3
        )
    return axes


def _aliased(given: Mapping[str, Any], artist: type[Artist], color: Any = None) -> dict[str, Any]:
    """Keywords under their whole names, with ``color``; PictureError for one that is given twice."""
    try:
        return normalize_kwargs({**given, **({} if color is None else {"color": color})}, artist)
    except TypeError as error:
        raise PictureError(f"{error}") from None


def _marked(index: int, colour: Any) -> dict[str, Any]:
    """A curve with markers: those of the user's settings where he has set sizes."""
    look = {**style.marked_line(index, colour=colour), "markersize": 2.6}
    users = {"linewidth": mpl.rcParams["lines.linewidth"], "markersize": mpl.rcParams["lines.markersize"]}
    return look | {name: one for name, one in users.items() if one != style.RC[f"lines.{name}"]}


def _colours(count: int, color: Any, cmap: str | Colormap | None) -> list[Any]:
    """A colour for each of some curves."""
    if color is not None:
        if is_color_like(color):
            return [color] * count
        many = [] if isinstance(color, str) else list(color)
        rule = f"color = {reprlib.repr(color)}: must be a colour, or {count}, one for each load"
        require(len(many) == count and all(map(is_color_like, many)), rule, PictureError)
        return many
    if cmap is not None:
        try:
            return [to_hex(one) for one in mpl.colormaps.get_cmap(cmap)(np.linspace(0.0, 1.0, count))]
        except (TypeError, ValueError):
            raise PictureError(f"cmap = {cmap!r}: must be a colour map of matplotlib, such as 'viridis'") from None
    users = style.users_cycle()
    return [users[k % len(users)] for k in range(count)] if users else style.ordered_colours(count)


def _two_colours(color: Any) -> dict[str, Any]:
    """Those of increased and of decreased forces."""
    if color is None:
        return {name: look["color"] for name, look in network.FORCE_LINES.items()}
    if is_color_like(color):
        pale = tuple(1.0 - 0.45 * (1.0 - part) for part in to_rgb(color))
        return dict(zip(network.FORCE_LINES, (color, pale), strict=True))
    many = [] if isinstance(color, str) else list(color)
    rule = f"color = {reprlib.repr(color)}: must be a colour, or two (increased, decreased)"
    require(len(many) == len(network.FORCE_LINES) and all(map(is_color_like, many)), rule, PictureError)
    return dict(zip(network.FORCE_LINES, many, strict=True))


#: The pictures of a page, by name.
PICTURES: Mapping[str, Callable[..., Axes]] = {
    "response": response,
    "floor": floor,
    "forces": forces,
    "contacts": contacts,
    "stress": stress,
    "packing": packing,
    "photoelastic": photoelastic,
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

    By default ``response``, ``forces``, ``contacts`` and ``stress``, with ``floor`` where there is no response. All
    show the same range of x, of a wide packing that within :data:`NEAR` times its height of the loaded disks.
    ``scale`` is that of :func:`forces`; ``figure`` is drawn into, or a new one of pyplot's.

    Raises PictureError for another name, and what the pictures raise.

    Examples
    --------
    >>> gr.plot.page(result, "response,forces").savefig("page.png")
    """
    what = [name.strip() for name in what.split(",")] if isinstance(what, str) else what
    for name in what or ():
        require(name in PICTURES, f"what = {name!r}: must be among {', '.join(PICTURES)}", PictureError)
    require(what is None or what, f"what: nothing to draw, must be among {', '.join(PICTURES)}", PictureError)
    shown = Shown.of(result, state)
    if what is None:
        what = ("floor" if shown.lack else "response", "forces", "contacts", "stress")
    half_width = NEAR * shown.top
    with style.with_users():
        figure = new_figure(style.DOUBLE) if figure is None else figure
        figure.set_layout_engine("none")
        columns = 1 if len(what) == 1 or aspect_of(shown, half_width) < 0.6 else 2
        panels = [figure.add_axes((0.1, 0.1, 0.8, 0.8), label=name) for name in what]
        for k, (name, axes) in enumerate(zip(what, panels, strict=True)):
            options: dict[str, Any] = {} if name == "response" else {"state": state}
            options |= {"half_width": half_width} if name in _CUT else {}
            options |= {"scale": scale} if name == "forces" else {}
            PICTURES[name](shown.data, ax=axes, **options)
            style.letter(axes, chr(ord("a") + k), place="above", text=_title(name, shown))
        _stack(figure, panels, columns, shown, half_width)
    return figure


#: Inches of a page around each picture, for texts of 9 points: left, right with and without a colour bar, above, and
#: below with and without the label of an axis; from a picture to its colour bar, and the width of that.
_LEFT, _BAR_SIDE, _RIGHT, _ABOVE, _AXIS, _BELOW, _GAP, _BAR = 0.55, 0.85, 0.12, 0.24, 0.4, 0.26, 0.1, 0.1


def _stack(figure: Figure, panels: Sequence[Axes], columns: int, shown: Shown, half_width: float) -> None:
    """Give all panels of a page the same x range, place and width; maps are as high as their scale makes them."""
    left, right = shown.across(half_width)
    middle = 0.5 * shown.box.width if shown.box.periodic else shown.origin
    per_text = mpl.rcParams["font.size"] / style.RC["font.size"]
    beside, above = _LEFT * per_text, _ABOVE * per_text
    bars = [next((one.colorbar for one in axes.collections if one.colorbar), None) for axes in panels]
    behind = (_BAR_SIDE if any(bars) else _RIGHT) * per_text
    wide = style.DOUBLE / columns - beside - behind
    heights = []
    for axes in panels:
        name = axes.get_label()
        counted = name in (*_GRAPHS, "stress")  # from the loaded disk, others from the left end of the box
        axes.set_xlim(*((left - middle, right - middle) if counted else (left, right)))
        if name in _GRAPHS:
            _fit(axes)
        graph = (0.36 if columns == 1 else 0.75) * wide
        heights.append(graph if name in _GRAPHS else wide * np.ptp(axes.get_ylim()) / (right - left))
    rows = [slice(k, k + columns) for k in range(0, len(panels), columns)]
    below = [
        per_text * max(_AXIS if axes.axison else _BELOW if axes.get_legend() else 0.05 for axes in panels[row])
        for row in rows
    ]
    tall = [max(heights[row]) for row in rows]
    total = sum(tall) + sum(below) + above * len(rows)
    figure.set_size_inches(style.DOUBLE, total)
    top = total
    for row, height, under in zip(rows, tall, below, strict=True):
        top -= above
        for column, (axes, own, bar) in enumerate(zip(panels[row], heights[row], bars[row], strict=True)):
            start = column * style.DOUBLE / columns + beside
            place = (start / style.DOUBLE, (top - own) / total, wide / style.DOUBLE, own / total)
            axes.set_position(place)
            if bar:
                bar.ax.set_box_aspect(None)
                bar.ax.set_position(((start + wide + _GAP) / style.DOUBLE, place[1], _BAR / style.DOUBLE, place[3]))
        top -= height + under


def _fit(axes: Axes) -> None:
    """Limits of y for what is seen of curves between the limits of x."""
    left, right = axes.get_xlim()
    curves = [np.asarray(line.get_xydata()) for line in axes.lines if line.get_transform() == axes.transData]
    seen = np.concatenate([curve[(left <= curve[:, 0]) & (curve[:, 0] <= right), 1] for curve in curves])
    if np.isfinite(seen).any():
        low, high = min(0.0, float(np.nanmin(seen))), max(0.0, float(np.nanmax(seen)))
        axes.set_ylim(low - 0.04 * (high - low), high + 0.06 * (high - low) or 1.0)


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
    rule = f"{path}: format {path.suffix!r} is unknown, must be .pdf, .png or .svg"
    require(path.suffix in (".pdf", ".png", ".svg"), rule, PictureError)
    with style.context():  # a command draws the same on every machine
        drawn = style.render(page(result, what, state=state, scale=scale, figure=Figure()), path.suffix[1:])
    with written(path):
        atomic.make_folder(path)
        atomic.check_output(path, inputs)
        atomic.write_bytes(path, drawn)
    return path


#: Disks of a packing whose forces a thumbnail still draws, in less than a second; dots per inch of it.
MOST_DISKS, THUMBNAIL_DPI = 5000, 90


def thumbnail(result: HasDataset | xr.Dataset) -> bytes:
    """A :func:`page` as PNG for notebooks: the response or the floor forces, and the forces in a packing that is small.

    Raises as :func:`page`.
    """
    shown = Shown.of(result)
    what = ["floor" if shown.lack else "response", *(["forces"] if len(shown.radius) <= MOST_DISKS else [])]
    return style.render(page(shown.data, what, figure=Figure()), dpi=THUMBNAIL_DPI)


def _title(what: str, shown: Shown) -> str:
    total = sum(float(np.hypot(*force)) for _, force, _ in shown.loads)
    turning = sum(abs(torque) for *_, torque in shown.loads)
    load = f"$F_{{\\mathrm{{ext}}}} = {total:.4g}\\,\\bar m g$" if shown.index else "at rest"
    if turning and not total:
        load = f"torque ${turning:.4g}\\,{style.TORQUE_UNIT}$"
    names = {"floor": "floor forces", "forces": "incremental forces" if shown.index else "forces"}
    return style.RESPONSE if what == "response" else f"{names.get(what, what)}, {load}"


def _packing(axes: Axes, shown: Shown, half_width: float | None = None, **disks: Any) -> Any:
    """Disks, box and loads, without axes."""
    look = {"edgecolor": "#DCDCDC", "linewidth": 0.4, **disks}
    drawn = network.draw_disks(axes, shown.position, shown.radius, zorder=1, **look)
    network.draw_box(axes, shown.box, shown.top)
    draw_loads(axes, shown)
    style.no_axes(axes)
    axes.set(xlim=shown.across(half_width), ylim=(-1.2, max(axes.dataLim.ymax, shown.top) + 0.5))
    return drawn


def _legend(axes: Axes, handles: Sequence[Any], shown: Shown, half_width: float | None) -> None:
    """Below the picture, in two columns where that is narrow."""
    if handles:
        columns = len(handles) if aspect_of(shown, half_width) < 0.6 else 2
        below: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0), "borderaxespad": 0.2}
        axes.legend(handles=handles, ncols=columns, columnspacing=1.4, **below)
