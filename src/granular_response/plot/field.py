"""Maps of a stress component on a grid."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import FuncNorm, Normalize, PowerNorm
from numpy.typing import ArrayLike

from ..errors import require
from . import style


def root_norm(largest: float, *, signed: bool = False) -> Normalize:
    """Equal steps of the square root up to ``largest``, with ``signed`` down to its opposite.

    The stress under a load falls like 1/depth: so its lower part is seen too. Raises ValueError unless ``largest`` is
    positive.
    """
    require(largest > 0.0, f"largest = {largest}: must be positive")
    if not signed:
        return PowerNorm(0.5, vmin=0.0, vmax=largest)
    return FuncNorm(
        (lambda value: np.sign(value) * np.sqrt(np.abs(value)), lambda root: np.sign(root) * np.square(root)),
        vmin=-largest,
        vmax=largest,
    )


def draw_field(
    axes: Axes, x: ArrayLike, z: ArrayLike, field: ArrayLike, *, norm: Normalize, levels: ArrayLike = (), **mesh: Any
) -> QuadMesh:
    """Draw ``field`` (len(z), len(x)) with equal scales; thin contours at ``levels``.

    Returns what a colour bar takes.
    """
    values = np.asarray(field, dtype=float)
    image = axes.pcolormesh(x, z, values, norm=norm, shading="gouraud", rasterized=True, **mesh)
    if np.size(levels):
        colour = style.MUTED if "cmap" in mesh else "white"
        axes.contour(x, z, values, levels, colors=colour, linewidths=0.4, linestyles="-")
    axes.set_aspect("equal")
    return image
