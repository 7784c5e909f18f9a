"""Fig. 1: pressure on the floor under a localized force, by the elliptic and the hyperbolic description."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response_paper.captions import Caption, Datasets, of_group
from granular_response_paper.panels import family, titles, zero

from .parameters import Parameters


def draw(datasets: Datasets) -> dict[str, Figure]:
    data = datasets["predictions"]
    figure, ((elliptic, hyperbolic),) = style.figure(1, 2, height=2.7, sharex=True, sharey=True)

    x = data["x"].values
    elliptic.plot(x, data["slab_rough"], **style.line(0), label="slab, rough floor")
    elliptic.plot(x, data["slab_smooth"], **style.line(1), label="slab, smooth floor")
    elliptic.plot(x, data["half_plane"], **style.line(2), label="half plane")

    depths = data["depth"].values
    for depth, look in family(depths, of="length", marked=False, dashed=True):
        hyperbolic.plot(x, data["rays"].sel(depth=depth), **look, label=style.equals("h", depth, style.RADIUS))
    titles((elliptic, hyperbolic), ("elliptic: one peak", "hyperbolic: two peaks"), place="inside")
    _rays(hyperbolic, float(data["ray_angle"]))
    for axes in (elliptic, hyperbolic):
        zero(axes)
        axes.set(xlabel=style.SCALED_POSITION, xlim=(x[0], x[-1]))
        axes.margins(y=0.16)
        axes.legend(loc="upper right")
    elliptic.set_ylabel(style.PRESSURE)
    return {"fig01_predictions": figure}


def _rays(axes: Axes, angle: float) -> None:
    """A slab with the two characteristics below its load, as a small drawing."""
    inset = axes.inset_axes((0.02, 0.38, 0.26, 0.4))
    foot = float(np.tan(np.radians(angle)))
    for z in (0.0, 1.0):
        inset.plot([-1.2, 1.2], [z, z], color=style.MUTED, linewidth=1.0, linestyle="-")
    inset.plot([-foot, 0.0, foot], [0.0, 1.0, 0.0], color=style.BLUE, linewidth=1.4, linestyle="-")
    inset.text(0.0, 0.1, f"$\\pm{angle:g}°$", ha="center", fontsize=7)
    network.draw_load(inset, (0.0, 1.0), length=0.5)
    style.no_axes(inset)


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    poisson = float(datasets["predictions"]["poisson_ratio"])
    return of_group("theory", {"fig01_predictions": {}}, p=parameters, poisson=poisson)
