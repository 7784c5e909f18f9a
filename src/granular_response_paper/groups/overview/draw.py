"""The overview, the growing force and the photoelastic packings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.animation import FuncAnimation
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response.plot.animation import FULL, Frames, animate
from granular_response.plot.chains import CHAINS, draw_chains
from granular_response.plot.photoelastic import photoelastic
from granular_response.plot.pictures import Shown
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import packing

from .parameters import Parameters

#: Mean radii to each side of the load: of slabs, and of photoelastic packings.
HALF_WIDTH, NEAR = 30.0, 18.0
#: Pixels from side to side of a photoelastic packing.
PIXELS = 680


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``overview``, the last frame of ``growing_force``, and ``photoelastic``."""
    frames = Frames(_slabs(datasets), half_width=HALF_WIDTH)
    frames.draw(-1)
    return {
        "overview": _overview(_slabs(datasets)),
        "growing_force": frames.figure,
        "photoelastic": _photoelastic([slab for name, slab in datasets.items() if name.startswith("photoelastic")]),
    }


def animations(datasets: Mapping[str, xr.Dataset]) -> dict[str, FuncAnimation]:
    """``growing_force``."""
    return {"growing_force": animate(_slabs(datasets), half_width=HALF_WIDTH)}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    forces, experiment = parameters.forces, parameters.experiment
    given = of_scene(parameters.scene, friction=parameters.frictions)
    return of_group(
        "overview",
        {
            "overview": {**given, "force": [forces[0], forces[-1]]},
            "growing_force": {**given, "force": forces},
            "photoelastic": of_scene(
                parameters.scene,
                frictions=experiment.friction,
                force=experiment.force,
                polydispersity=experiment.polydispersities,
            ),
        },
    )


def _slabs(datasets: Mapping[str, xr.Dataset]) -> dict[str, xr.Dataset]:
    """Those under a growing force, by their titles."""
    slabs = [slab for name, slab in datasets.items() if name.startswith("slab")]
    return {style.equals(style.FRICTION, float(slab["friction"])): slab for slab in slabs}


def _overview(slabs: Mapping[str, xr.Dataset]) -> Figure:
    """A column for each friction; for the smallest and the largest force the chains above the response."""
    tall = [1.1, 0.85, 1.1, 0.85]
    figure, panels = style.figure(4, len(slabs), width=6.2, height=4.9, height_ratios=tall, sharex="row", sharey="row")
    for k, (title, slab) in enumerate(slabs.items()):
        half = min(HALF_WIDTH, 0.5 * float(slab.attrs["width"]))
        for row, load in ((0, 0), (2, -1)):
            above, below = panels[row : row + 2, k]
            force = float(slab["total_force"][load])
            shown = Shown.of(slab, load % slab.sizes["load"] + 1)
            draw_chains(above, shown, largest=FULL * force, half_width=half)
            x, response = slab["x"].values, slab["floor_response"].values[load]
            below.fill_between(x, slab["elastic_response"].values, color=style.FAINT, linewidth=0.0)
            below.plot(x, response, color=CHAINS, linewidth=1.8, linestyle="-")
            below.set(xlim=(-half, half))
            below.tick_params(top=False, right=False)
            below.spines[["top", "right"]].set_visible(False)
            if k == 0:
                above.text(
                    0.0, 0.97, style.equals(style.F_EXT, force, style.WEIGHT), transform=above.transAxes, va="top"
                )
        panels[0, k].set_title(title, pad=2.0)
    return figure


def _photoelastic(packings: list[xr.Dataset]) -> Figure:
    """Side by side, with the fringes of one material."""
    figure, panels = style.figure(1, len(packings), width=6.2, height=2.9)
    strongest = max(
        float(np.linalg.norm(slab["contact_force"][-1] - slab["contact_force"][0], axis=-1).max()) for slab in packings
    )
    for axes, slab in zip(panels[0], packings, strict=True):
        half = min(NEAR, 0.5 * float(slab.attrs["width"]))
        photoelastic(slab, ax=axes, half_width=half, pixels=PIXELS, fringe=2.0 * strongest / np.pi)
        axes.set_title(packing(float(slab["polydispersity"])), pad=0.0)
    return figure
