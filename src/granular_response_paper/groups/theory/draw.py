"""Fig. 1: pressure on the floor under a localized force, by the elliptic and the hyperbolic description."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, of_group
from granular_response_paper.panels import family, titles, zero

from .parameters import Parameters


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig01_predictions`` from the dataset ``predictions`` of the study of the same name."""
    data = datasets["predictions"]
    figure, ((elliptic, hyperbolic),) = style.figure(1, 2, width="double", height=2.7, sharex=True, sharey=True)

    x = data["x"].values
    elliptic.plot(x, data["slab_rough"], **style.line(0), label="slab, rough floor")
    elliptic.plot(x, data["slab_smooth"], **style.line(1), label="slab, smooth floor")
    elliptic.plot(x, data["half_plane"], **style.line(2), label="half plane")

    depths = data["depth"].values
    for depth, look in family(depths, of="length", marked=False, dashed=True):
        hyperbolic.plot(x, data["rays"].sel(depth=depth), **look, label=style.equals("h", depth, style.RADIUS))
    titles((elliptic, hyperbolic), ("elliptic", "hyperbolic"), place="inside")
    for axes in (elliptic, hyperbolic):
        zero(axes)
        axes.set(xlabel=style.SCALED_POSITION, xlim=(x[0], x[-1]))
        axes.margins(y=0.08)
        axes.legend(loc="upper right")
    elliptic.set_ylabel(style.PRESSURE)
    return {"fig01_predictions": figure}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    poisson = float(datasets["predictions"]["poisson_ratio"])
    return of_group("theory", {"fig01_predictions": {}}, p=parameters, poisson=poisson)
