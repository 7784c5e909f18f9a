"""Fig. 18: force chains below an oblique force with torques, and how far the torques reach."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response_paper.captions import Caption, of_group, of_scene
from granular_response_paper.panels import chain_key, chains, family, titles

from .parameters import Parameters

#: Force of the key, in mean disk weights.
KEY = 5.0


@style.context()
def draw(datasets: Mapping[str, xr.Dataset]) -> dict[str, Figure]:
    """``fig18_torque`` and ``fig18_torque_reach`` from the datasets of the study of the same name."""
    return {"fig18_torque": _chains(datasets["torques"]), "fig18_torque_reach": _reach(datasets["reach"])}


def captions(datasets: Mapping[str, xr.Dataset], parameters: Parameters) -> dict[str, Caption]:
    """By file stem."""
    given = of_scene(parameters.scene, force=parameters.force, angle=parameters.angle, torque=parameters.torques)
    reach = {**given, "torque": parameters.torques[1:], "width": parameters.stress_width}
    last = chr(ord("a") - 1 + len(parameters.torques))
    return of_group("torque", {"fig18_torque": given, "fig18_torque_reach": reach}, last=last)


def _chains(data: xr.Dataset) -> Figure:
    """The central third of the upper half of the slab, all panels on one scale."""
    torques = data["torque"].values
    width, disk = float(data["width"]), int(data["loaded_disk"])
    radius, top = data["radius"].values, float(data["position"].values[0, :, 1].max()) + 1.0
    low, left, right = 0.5 * top, width / 3.0, 2.0 * width / 3.0
    limits = {"xlim": (left - 0.5, right + 0.5), "ylim": (low - 0.5, top + 2.4)}
    rows = (len(torques) + 2) // 3
    height = np.ptp(limits["ylim"]) / np.ptp(limits["xlim"]) * style.DOUBLE / 3.0 + 0.2
    figure, panels = style.figure(rows, 3, width="double", height=float(height) * rows)
    added = data["contact_added_force"].values
    size = np.linalg.norm(added, axis=-1)
    largest = float(size.max())
    pairs = data["contact_disk"].values, data["contact_partner"].values
    for index, axes in enumerate(panels.ravel()):
        style.no_axes(axes)
        if index >= len(torques):
            continue
        position = data["position"].values[index]
        inside = (np.abs(position[:, 0] - 0.5 * width) <= width / 6.0 + 1.0) & (position[:, 1] >= low - 1.0)
        network.draw_disks(axes, position[inside], radius[inside])
        middle = 0.5 * (position[pairs[0]] + position[pairs[1]])
        shown = (middle[:, 0] >= left) & (middle[:, 0] <= right) & (middle[:, 1] >= low)
        chains(axes, position, (pairs[0][shown], pairs[1][shown]), size[index][shown], largest)
        network.draw_loaded_disk(axes, position[disk], float(radius[disk]))
        # the force as a straight arrow to the disk's centre, a clockwise torque as an arc over it
        network.draw_load(axes, position[disk], data["applied_force"].values, length=4.6)
        network.draw_torque(axes, position[disk], -float(torques[index]))
        chain_key(axes, (right - 7.0, top + 1.4), KEY, largest, style.WEIGHT)
        axes.set(**limits)
    titles(panels.flat, map(_torque, torques.tolist()))
    return figure


def _reach(data: xr.Dataset) -> Figure:
    """Not in the paper: what the torque changes, against the distance from the load."""
    figure, panels = style.figure(1, 3, width="double", height=2.7, sharex=True, sharey=True)
    torques = data["torque"].values
    turned = np.flatnonzero(torques)
    panel_of = {
        "force_change": "contact forces",
        "stress_change": "stress tensor",
        "antisymmetric_change": "antisymmetric stress",
    }
    changes = np.concatenate([data[name].values[turned].ravel() for name in panel_of])
    changes = changes[changes > 0.0]  # none without a torque, or where the rings lie beyond the slab
    titles(panels[0], panel_of.values(), stem="fig18_torque_reach")
    for axes, name in zip(panels[0], panel_of, strict=True):
        for k, look in family(turned, of="other"):
            axes.plot(data["ring"], data[name][k], **look, label=f"{torques[k]:g}")
        axes.set(xlabel=rf"distance from the load$\,/\,{style.RADIUS}$", xlim=(0.0, None))
        if changes.size:
            axes.set(yscale="log", ylim=(0.6 * float(changes.min()), 1.6 * float(changes.max())))
    panels[0, 0].set_ylabel("relative change by the torque")
    if len(turned):
        panels[0, 2].legend(title=rf"torque$\,/\,{style.TORQUE_UNIT}$", loc="upper right")
    return figure


def _torque(value: float) -> str:
    return "no torque" if value == 0.0 else rf"torque ${value:g}\,{style.TORQUE_UNIT}$"
