"""The numerics of the paper, measured: what a stopping energy leaves, what is quiet at rest, what damps fastest."""

from __future__ import annotations

from typing import Any

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import family, titles

from .parameters import Parameters

#: What the paper says: floor forces within 1 %, energy after a restart below 1e-22, nu = sqrt(k) half of critical.
FORCE_ERROR, RESTART_ENERGY, PAPER_RATIO = 1e-2, 1e-22, 0.5

#: Legends stand below their panels.
BELOW: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.45, -0.2), "handlelength": 2.4}


def draw(datasets: Datasets) -> dict[str, Figure]:
    figure, axes = style.figure(1, 3, height=2.9)
    stop, restart, damping = axes[0]
    _stop_energy(stop, datasets["stop_energy"])
    _restart(restart, datasets["restart"])
    _damping(damping, datasets["damping"])
    titles(axes.flat)
    return {"numerics": figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    return of_group("numerics", {"numerics": of_scene(parameters.scene, friction=None)}, p=parameters)


def _stop_energy(panel: Axes, study: xr.Dataset) -> None:
    study = study.sortby("stop_kinetic_energy")
    for friction, look in family(study["friction"].values, of="friction"):
        curves, mu = study.sel(friction=friction), style.equals(style.FRICTION, friction)
        for name, text, dashes in (("loaded_error", "forces", "-"), ("response_error", "response", "--")):
            energy = curves["stop_kinetic_energy"]
            panel.loglog(energy, curves[name], label=f"{mu}, {text}", **look | {"linestyle": dashes})
    style.paper_value(panel, FORCE_ERROR, "paper: 1 %", along="y", at=0.45)
    panel.set(xlabel=rf"$E_\mathrm{{stop}}/{style.ENERGY_UNIT}$", ylabel="relative error")
    panel.legend(**BELOW)


def _restart(panel: Axes, study: xr.Dataset) -> None:
    for load, look in family(study["load"].values, of="force", marked=False, dashed=True):
        name = style.equals(style.F_EXT, load, style.WEIGHT)
        panel.semilogy(study["step"] / 1e3, study["kinetic_energy"].sel(load=load), label=name, **look)
    style.paper_value(panel, RESTART_ENERGY, "paper: below $10^{-22}$", along="y")
    panel.set_ylim(top=RESTART_ENERGY * 100.0)
    panel.set(xlabel="thousands of time steps", ylabel=f"$E_k/{style.ENERGY_UNIT}$ per disk")
    panel.legend(**BELOW)


def _damping(panel: Axes, study: xr.Dataset) -> None:
    study = study.sortby("damping_ratio")
    settled = study["settled"].values.astype(bool)
    panel.plot(study["damping_ratio"][settled], study["relaxation_time"][settled], **style.marked_line(0))
    style.paper_value(panel, PAPER_RATIO, r"paper: $\nu=\sqrt{k}$", side="behind")
    panel.set_ylim(bottom=0.0)
    panel.set(xlabel=r"$\nu/\nu_\mathrm{c}$", ylabel=rf"time to rest$\,/{style.TIME_UNIT}$")
