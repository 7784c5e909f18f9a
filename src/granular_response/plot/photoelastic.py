"""The disks as a dark-field polariscope shows them: bright where the principal stresses differ by half a fringe."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..observe.disk_stress import disk_stress, principal_difference
from ..state import FloatArray, wall_normals
from . import style
from .shown import HasDataset, Shown, aspect_of, check_positive, draw_loads, new_axes

#: Each pixel is the mean of this many by as many points: near a contact fringes are narrower than a pixel.
POINTS = 2
#: Fringes at the centre of a disk that two of the largest contact forces press together, by default.
ORDERS = 2.0


def photoelastic(
    result: HasDataset | xr.Dataset,
    *,
    ax: Axes | None = None,
    state: int = -1,
    added: bool | None = None,
    fringe: float | None = None,
    half_width: float | None = None,
    pixels: int = 1200,
    **image: Any,
) -> Axes:
    """Photoelastic picture: the stress of each disk under its contact forces, in closed form, and its fringes.

    The intensity is sin²(π D / ``fringe``) with the difference D of the principal stresses, black outside the disks.
    A load acts on the rim of its disk, where its arrow ends. Contact forces that do not balance, such as those
    that support the weight of a disk, are balanced by a force spread evenly over it, and a torque by one that grows
    with the distance from its centre (:mod:`granular_response.observe.disk_stress`).

    Parameters
    ----------
    added : draw the stress of the incremental forces; by default so for states under load.
    fringe : principal stress difference of one fringe, in mean disk weights per mean radius. By default a disk of mean
        radius that two of the largest contact forces press together has two fringes at its centre.
    half_width : draw what is within this distance of the loaded disk, in mean radii; all of it by default.
    pixels : of the picture, from side to side.
    image : goes to ``Axes.imshow``.

    Raises IndexError for a state that does not exist; PictureError unless ``fringe``, ``half_width`` and ``pixels`` are
    positive.

    Examples
    --------
    >>> gr.plot.photoelastic(result, half_width=15.0).figure.savefig("fringes.png")
    """
    shown = Shown.of(result, state)
    check_positive(fringe=fringe, half_width=half_width, pixels=pixels)
    added = shown.index > 0 if added is None else added
    left, right = 0.0, shown.box.width
    if half_width is not None:
        left, right = shown.origin - half_width, shown.origin + half_width
    largest = max(float(np.linalg.norm(force, axis=1).max(initial=0.0)) for force in shown.forces(added))
    # 4 f / π R is the difference at the centre of a disk that two forces f press together
    fringe = fringe or 4.0 * largest / np.pi / ORDERS or 1.0
    size = (right - left) / int(pixels)
    light = _light(shown, added, fringe, left, size, (int(np.ceil(shown.top / size)), int(pixels)))
    with style.with_users():
        axes = new_axes(ax, aspect_of(shown) if half_width is None else 1.25 * shown.top / (right - left))
        extent = (left, left + size * light.shape[1], 0.0, size * light.shape[0])
        axes.imshow(light, **{"cmap": "gray", "vmin": 0.0, "vmax": 1.0, "origin": "lower", "extent": extent, **image})
        style.no_axes(axes)
        draw_loads(axes, shown)
        axes.set(xlim=(left, right), ylim=(0.0, max(axes.dataLim.ymax, shown.top) + 0.5))
    return axes


def _light(shown: Shown, added: bool, fringe: float, left: float, size: float, shape: tuple[int, int]) -> FloatArray:
    """(rows, columns) mean intensity of pixels of a ``size``, from the floor up and from ``left`` on."""
    disk, outward, force = _on_rims(shown, added)
    order = np.argsort(disk, kind="stable")
    disk, outward, force = disk[order], outward[order], force[order]
    begin = np.searchsorted(disk, np.arange(len(shown.radius) + 1))
    fine = size / POINTS
    light = np.zeros((shape[0] * POINTS, shape[1] * POINTS))
    # a disk across a periodic side is seen at both
    copies = (-shown.box.width, 0.0, shown.box.width) if shown.box.periodic else (0.0,)
    for k, (centre, radius) in enumerate(zip(shown.position, shown.radius, strict=True)):
        own = slice(begin[k], begin[k + 1])
        for shift in copies:
            corner = (centre[1], centre[0] + shift - left)
            rows, columns = (
                np.arange(max(0, int((at - radius) / fine)), min(count, int((at + radius) / fine) + 2))
                for at, count in zip(corner, light.shape, strict=True)
            )
            z, x = ((index + 0.5) * fine - at for index, at in zip((rows, columns), corner, strict=True))
            grid = np.stack(np.meshgrid(x, z), axis=-1)
            inside = np.sum(grid**2, axis=-1) < radius**2
            if inside.any():
                difference = principal_difference(disk_stress(grid[inside], outward[own], force[own], float(radius)))
                part = light[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
                seen = np.sin(np.pi * np.nan_to_num(difference, posinf=0.0) / fringe) ** 2
                part[inside] = np.maximum(part[inside], seen)  # disks that overlap
    return light.reshape(shape[0], POINTS, shape[1], POINTS).mean(axis=(1, 3))


def _on_rims(shown: Shown, added: bool) -> tuple[np.ndarray, FloatArray, FloatArray]:
    """Every force on a disk at its rim: the disk, the unit vector to where it acts, the force."""
    first, second = shown.pairs
    separation = shown.box.separation(shown.position[first], shown.position[second])
    normal = separation / np.linalg.norm(separation, axis=1, keepdims=True)
    pair, wall = shown.forces(added)
    inward = wall_normals(shown.values("wall_index"))
    acting = [(disk, *(-force / size), *force) for disk, force, _ in shown.loads if (size := np.hypot(*force))]
    loads = np.reshape(acting, (-1, 5))
    return (
        np.concatenate([first, second, shown.values("wall_disk"), loads[:, 0].astype(int)]),
        np.concatenate([-normal, normal, -inward, loads[:, 1:3]]),
        np.concatenate([pair, -pair, wall, loads[:, 3:]]),
    )
