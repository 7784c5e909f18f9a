"""Fig. 11, a drawing: the triangular lattice with normal and tangential springs between its disks."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.network import draw_disks
from granular_response.state import FloatArray

#: Disks are drawn smaller than they are, so that the springs have room between them; the bonds have length 2. Of coils,
#: to each side.
_RADIUS, _AMPLITUDE = 0.36, 0.085
_COLOUR = {"n": style.BLUE, "t": style.VERMILION}


def draw_spring_model() -> dict[str, Figure]:
    """``fig11_spring_model``: three disks of the lattice, a coil for each spring, labelled as in Sec. V.C."""
    figure, ((axes,),) = style.figure(width=style.SINGLE, height=3.0)
    centre = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, np.sqrt(3.0)]])
    draw_disks(axes, centre, _RADIUS, facecolor="#ECECEC", edgecolor=style.MUTED, linewidth=0.8, zorder=3)
    axes.plot(*centre.T, linestyle="none", marker="o", markersize=2.5, color=style.BLACK, zorder=4)
    for first, second, family, outside in ((0, 1, "1", -1.0), (0, 2, "2", 1.0), (1, 2, "2", -1.0)):
        _bond(axes, centre[first], centre[second], family, outside)
    # Stubs of the bonds to the other neighbours say that the lattice goes on.
    for index, disk in enumerate(centre):
        for angle in np.radians(np.arange(0, 360, 60)):
            ray = np.array([np.cos(angle), np.sin(angle)])
            neighbour = disk + 2.0 * ray
            if np.min(np.linalg.norm(np.delete(centre, index, axis=0) - neighbour, axis=1)) > 0.1:
                ends = np.stack([disk + _RADIUS * ray, disk + 0.6 * ray])
                axes.plot(*ends.T, color=style.FAINT, linewidth=0.8, linestyle=(0, (2, 1.5)))
    style.no_axes(axes)
    return {"fig11_spring_model": figure}


def _bond(axes: Axes, start: FloatArray, end: FloatArray, family: str, outside: float) -> None:
    """The two springs of one bond and their names.

    The normal spring lies along the line of centres. The tangential one lies across it, between two rigid
    arms, one fixed to each disk, so that it stretches when the disks shift past each other. ``outside`` is
    the side of the bond, left (+1) or right (-1) of its direction, that faces out of the triangle.
    """
    along = (end - start) / np.linalg.norm(end - start)
    across = outside * np.array([-along[1], along[0]])

    def at(distance: float, aside: float) -> FloatArray:
        return start + distance * along + aside * across

    near, far = 0.13, 0.62
    surface = float(np.sqrt(_RADIUS**2 - near**2))
    axes.plot(*_coil(at(surface, -near), at(2.0 - surface, -near), 9).T, color=_COLOUR["n"], linestyle="-")
    for arm in ([at(surface, near), at(1.0, near)], [at(2.0, _RADIUS), at(2.0, far), at(1.0, far)]):
        axes.plot(*np.transpose(arm), color=style.MUTED, linewidth=0.9, linestyle="-")
    axes.plot(*_coil(at(1.0, near), at(1.0, far), 4).T, color=_COLOUR["t"], linestyle="-")
    for kind, (x, z) in (("n", at(1.0, -0.35)), ("t", at(0.74, 0.43))):
        axes.text(x, z, f"$k_{family}^{kind}$", color=_COLOUR[kind], ha="center", va="center", fontsize=11)


def _coil(start: FloatArray, end: FloatArray, turns: int) -> FloatArray:
    """(n, 2) zigzag spring from ``start`` to ``end`` with a straight piece at each end."""
    length = np.linalg.norm(end - start)
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    lead = 0.14 * length
    steps = np.linspace(lead, length - lead, 2 * turns + 1)
    swing = _AMPLITUDE * np.where(np.arange(2 * turns + 1) % 2 == 0, -1.0, 1.0)
    swing[[0, -1]] = 0.0
    distance = np.concatenate([[0.0], steps, [length]])
    side = np.concatenate([[0.0], swing, [0.0]])
    return start + distance[:, None] * along + side[:, None] * across
