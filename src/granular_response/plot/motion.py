"""The motion of disks as an animation."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.animation import FuncAnimation
from matplotlib.figure import Figure

from ..errors import require
from ..state import Box
from . import network, style
from .animation import animated, check_target
from .shown import PictureError, check_positive, new_figure

#: Inches for the line of text above the picture; height over width up to which that is as wide as a page.
_ABOVE, _TALLEST = 0.3, 1.2


def motion(
    moved: xr.Dataset,
    *,
    output: str | os.PathLike[str] | None = None,
    fps: float = 12.0,
    dpi: float = 120.0,
    width: float = style.DOUBLE,
    figure: Figure | None = None,
) -> FuncAnimation:
    """Animation of what ``gr.motion`` returns: disks coloured by speed and marked by their rotation, at each time.

    Parameters
    ----------
    moved : the dataset of ``gr.motion``, or some of its times (``moved.isel(time=slice(0, 50))``).
    output : file to write, as of :func:`animate`.
    fps, dpi, width : frames per second; pixels per inch, and inches from side to side.
    figure : drawn into, or a new one of pyplot's.

    Raises PictureError for another dataset or fewer than two times, another ending, a number that is not positive, and
    a file that cannot be written.

    Examples
    --------
    >>> ball = gr.Scene.from_arrays(x=[5.0], z=[3.0], radius=1.0, width=10.0, vx=0.5, scene={"loads": []})
    >>> film = gr.plot.motion(gr.motion(ball, [0.0, 0.5, 1.0]), output="fall.gif")
    """
    check_positive(fps=fps, dpi=dpi, width=width)
    check_target(output)
    needed = {"time", "position", "velocity", "angle", "radius"}
    if not isinstance(moved, xr.Dataset) or not needed <= set(moved.variables) or moved["time"].ndim != 1:
        raise PictureError("moved: must be a dataset of gr.motion with the dimension time")
    require(moved.sizes["time"] >= 2, "moved: one time makes no animation, must have two or more", PictureError)
    radius, speed = moved["radius"].values, np.hypot(*np.moveaxis(moved["velocity"].values, -1, 0))
    position, box = moved["position"].values, Box.of(moved.attrs)
    if box.periodic:
        position = position.copy()
        position[..., 0] %= box.width
    fastest, top = float(speed.max()) or 1.0, float((position[..., 1] + radius).max())
    with style.context():
        figure = new_figure(1.0) if figure is None else figure
        figure.set_layout_engine("none")
        wide = min(width, width * _TALLEST * (box.width + 2.0) / (top + 1.0))
        high = wide * (top + 1.0) / (box.width + 2.0)
        figure.set_size_inches(wide, high + _ABOVE)
        axes = figure.add_axes((0.0, 0.0, 1.0, high / (high + _ABOVE)))

    def draw(frame: int) -> list[Any]:
        with style.context():
            axes.clear()
            now = position[frame]
            network.draw_disks(
                axes, now, radius, values=speed[frame], cmap="viridis", clim=(0.0, fastest), edgecolor=style.MUTED
            )
            network.draw_rotations(axes, now, radius, moved["angle"].values[frame], color="white", linewidth=0.8)
            network.draw_box(axes, box, top)
            style.no_axes(axes)
            axes.set(xlim=(-1.0, box.width + 1.0), ylim=(-0.5, top + 0.5))
            time, fast = float(moved["time"][frame]), float(speed[frame].max())
            axes.set_title(f"t = {time:.4g}, fastest disk {fast:.3g}", pad=2.0)
        return []

    return animated(figure, draw, moved.sizes["time"], output, fps=fps, dpi=dpi)
