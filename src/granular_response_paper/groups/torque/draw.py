"""Fig. 18: force chains below an oblique force with torques."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granular_response.plot import network, style
from granular_response_paper.captions import RADIUS, Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import ContactLines, added_forces, force_key, forces, titles

from .parameters import Parameters

#: Forces near the disk (radii), and those along the applied force (degrees), of which the caption says the part.
NEAR, ALONG = 12.0, 15.0
#: Force of the key, in mean disk weights.
KEY = 5.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"fig18_torque": _chains(datasets["torques"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    given = of_scene(parameters.scene, force=parameters.force, angle=parameters.angle, torque=parameters.torques)
    found = {"fig18_torque": _finding(datasets["torques"], parameters.angle)}
    return of_group("torque", {"fig18_torque": given}, found)


def _finding(data: xr.Dataset, angle: float) -> str:
    """Which part of the forces near the disk points along the applied force, without torque and with the largest."""
    disk, along = int(data["loaded_disk"]), data["applied_force"].values
    along = along / np.linalg.norm(along)
    parts = []
    for state in (0, -1):
        position, vector = data["position"].values[state], data["contact_added_force"].values[state]
        point = ContactLines.of(data, position).point[: len(vector)]
        near = np.linalg.norm(point - position[disk], axis=1) < NEAR
        size = np.linalg.norm(vector[near], axis=1)
        within = np.abs(vector[near] @ along) > np.cos(np.radians(ALONG)) * size
        parts.append(100.0 * float((size * within).sum() / size.sum()) if size.any() else np.nan)
    return (
        f"Without torque {parts[0]:.0f} % of the forces within {NEAR:g} {RADIUS} of the disk are within {ALONG:g}° "
        f"of the applied one, with the largest torque {parts[1]:.0f} %."
    )


def _chains(data: xr.Dataset) -> Figure:
    """The central third of the upper half of the slab, all panels on one scale."""
    torques = data["torque"].values
    width, disk = float(data["width"]), int(data["loaded_disk"])
    radius, top = data["radius"].values, float(data["position"].values[0, :, 1].max()) + 1.0
    low, left, right = 0.5 * top, width / 3.0, 2.0 * width / 3.0
    limits = {"xlim": (left - 0.5, right + 0.5), "ylim": (low - 0.5, top + 2.4)}
    rows = (len(torques) + 2) // 3
    height = np.ptp(limits["ylim"]) / np.ptp(limits["xlim"]) * style.DOUBLE / 3.0 + 0.2
    figure, panels = style.figure(rows, 3, height=float(height) * rows)
    added, largest = added_forces(data)
    for index, axes in enumerate(panels.ravel()):
        style.no_axes(axes)
        if index >= len(torques):
            continue
        position = data["position"].values[index]
        inside = (np.abs(position[:, 0] - 0.5 * width) <= width / 6.0 + 1.0) & (position[:, 1] >= low - 1.0)
        network.draw_disks(axes, position[inside], radius[inside], facecolor=style.DISKS, edgecolor="none")
        contacts = ContactLines.of(data, position)
        x, z = contacts.point.T
        shown = (x >= left) & (x <= right) & (z >= low)
        forces(axes, contacts, added[index], largest, shown=shown)
        network.draw_loaded_disk(axes, position[disk], float(radius[disk]))
        # the force as a straight arrow to the disk's centre, a clockwise torque as an arc over it
        network.draw_load(axes, position[disk], data["applied_force"].values, length=4.6)
        network.draw_torque(axes, position[disk], -float(torques[index]))
        if index == 0:
            force_key(axes, (right - 6.0, top + 1.4), KEY, largest, style.WEIGHT)
        axes.set(**limits)
    turning = [rf"torque ${torque:g}\,{style.TORQUE_UNIT}$ clockwise" for torque in torques[1:]]
    titles(panels.flat, ["no torque", *turning])
    return figure
