"""The numerics of the paper, measured: what a stopping energy leaves, what is quiet at rest, what damps fastest."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_response.plot import style

#: What the paper says: floor forces within 1 %, energy after a restart below 1e-22, nu = sqrt(k) half of critical.
FORCE_ERROR, RESTART_ENERGY, PAPER_RATIO = 1e-2, 1e-22, 0.5


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """One figure with three panels."""
    figure, axes = style.figure(1, 3, width="double", height=2.5)
    stop, restart, damping = axes[0]
    _stop_energy(stop, datasets["stop_energy"])
    _restart(restart, datasets["restart"])
    _damping(damping, datasets["damping"])
    style.letters(axes)
    return {"numerics": figure}


def _limit(panel: Axes, value: float, text: str, *, vertical: bool = False) -> None:
    line = panel.axvline if vertical else panel.axhline
    line(value, color=style.MUTED, linewidth=0.8, linestyle=(0, (4, 2)), label=text, zorder=0)


def _stop_energy(panel: Axes, study: xr.Dataset) -> None:
    study = study.sortby("stop_kinetic_energy")
    index = 0
    for friction in study["friction"].values:
        curves = study.sel(friction=friction)
        for name, text in (("loaded_error", "forces"), ("response_error", "response")):
            panel.loglog(
                curves["stop_kinetic_energy"],
                curves[name],
                label=rf"$\mu={friction:g}$, {text}",
                **style.marked_line(index),
            )
            index += 1
    _limit(panel, FORCE_ERROR, "1 %")
    low, high = panel.get_ylim()
    panel.set_ylim(low, high * 300.0)
    panel.set(xlabel=r"$E_\mathrm{stop}/\overline{m}g\overline{R}$", ylabel="error, per largest")
    panel.legend(loc="upper right", handlelength=1.6)


def _restart(panel: Axes, study: xr.Dataset) -> None:
    for index, load in enumerate(study["load"].values):
        curve = study["kinetic_energy"].isel(load=index)
        panel.semilogy(study["step"] / 1e3, curve, label=rf"$F_\mathrm{{ext}}={load:g}\,mg$", **style.line(index))
    _limit(panel, RESTART_ENERGY, "paper")
    low, _ = panel.get_ylim()
    panel.set_ylim(low, RESTART_ENERGY * 1e6)
    panel.set(xlabel="thousands of time steps", ylabel=r"$E_k/\overline{m}g\overline{R}$ per disk")
    panel.legend(loc="upper right", handlelength=1.6)


def _damping(panel: Axes, study: xr.Dataset) -> None:
    study = study.sortby("damping_ratio")
    settled = study["settled"].values.astype(bool)
    panel.plot(study["damping_ratio"][settled], study["relaxation_time"][settled], **style.marked_line(0))
    _limit(panel, PAPER_RATIO, r"$\nu=\sqrt{k}$", vertical=True)
    _, high = panel.get_ylim()
    panel.set_ylim(0.0, high * 1.1)
    panel.set(xlabel=r"$\nu/\nu_\mathrm{c}$", ylabel=r"time to rest$\,/\sqrt{\overline{R}/g}$")
    panel.legend(loc="upper right", handlelength=1.6)
