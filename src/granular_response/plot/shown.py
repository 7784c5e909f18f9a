"""One state of a result as pictures take it, the figures that they are drawn in, and the loads that they show."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .. import errors
from ..errors import GranularError
from ..observe.floor import interior_mask, origin_of, wall_margin
from ..state import Box, FloatArray, state_index
from . import network, style


class PictureError(GranularError, ValueError):
    """A picture that cannot be drawn as asked. The message is one line."""


def check_positive(**given: float | None) -> None:
    """PictureError, with its name, for the first of ``given`` that is no number greater than 0; None is left out."""
    errors.check_positive(PictureError, **{name: value for name, value in given.items() if value is not None})


@contextlib.contextmanager
def written(output: str | os.PathLike[str]) -> Iterator[None]:
    """A file that cannot be written within it is a PictureError."""
    try:
        yield
    except OSError as error:
        raise PictureError(f"{output}: cannot be written: {error.strerror or error}") from error


class HasDataset(Protocol):
    """A result."""

    def to_dataset(self) -> xr.Dataset: ...


@dataclass(frozen=True)
class Shown:
    """One state of a result as pictures take it: plain arrays, contacts on the list that all states share."""

    data: xr.Dataset
    index: int

    @classmethod
    def of(cls, result: HasDataset | xr.Dataset, state: int = -1) -> Shown:
        """Raises TypeError for what is no result or no integer, PictureError for a dataset of something else, and
        granular_response.state.StateIndexError for a state that does not exist.
        """
        if not isinstance(result, xr.Dataset):
            if not hasattr(result, "to_dataset"):
                kind = type(result).__name__
                raise TypeError(f"result: must be a Result or its dataset, not {kind} (open_result reads a file)")
            result = result.to_dataset()
        if not {"position", "contact_force", "wall_force", "state_load_factor"} <= set(result.variables):
            raise PictureError("result: the dataset holds no states of a packing (open_result reads a file)")
        return cls(result, state_index(state, result.sizes["state"]))

    def values(self, name: str, index: int | None = None) -> np.ndarray:
        """A variable in this state, or in another one."""
        variable = self.data[name]
        if "state" in variable.dims:
            variable = variable.isel(state=self.index if index is None else index)
        return variable.values

    @property
    def position(self) -> FloatArray:
        return self.values("position")

    @property
    def radius(self) -> FloatArray:
        return self.values("radius")

    @property
    def box(self) -> Box:
        return Box.of(self.data.attrs)

    @property
    def top(self) -> float:
        """Highest point of a disk."""
        return float((self.position[:, 1] + self.radius).max())

    @property
    def origin(self) -> float:
        """Where ``x`` of the response is 0."""
        return origin_of(self.values("position", 0), self.values("floor_disk"), self.values("x"), self.box)

    @property
    def interior(self) -> np.ndarray:
        """Which places of the response are away from the side walls, where peaks are looked for."""
        x, width = self.values("x"), self.box.width
        if self.box.periodic:
            return np.full(x.shape, True)
        return interior_mask(x, width, wall_margin(width), left_wall=-self.origin)

    @property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        return self.values("contact_disk"), self.values("contact_partner")

    def across(self, half_width: float | None) -> tuple[float, float]:
        """From where to where a picture goes: ``half_width`` to both sides of the loaded disks, the packing at most.

        Of a periodic packing all is shown, as what is near a load may be at both ends of it.
        """
        ends = -1.5, self.box.width + 1.5
        if half_width is None or not self.loads or self.box.periodic:
            return ends
        x = self.position[[disk for disk, *_ in self.loads], 0]
        return max(ends[0], float(x.min()) - half_width), min(ends[1], float(x.max()) + half_width)

    def forces(self, added: bool) -> tuple[FloatArray, FloatArray]:
        """Of contacts of disks and at walls, whole or ``added``: the incremental forces."""
        pair, wall = (
            self.values(name) - (self.values(name, 0) if added else 0.0) for name in ("contact_force", "wall_force")
        )
        return pair, wall

    @property
    def lack(self) -> str:
        """Why there is no response, which is divided by the force of the loads; empty where there is one."""
        if np.isfinite(self.data["floor_response"].values).any():
            return ""
        if not self.data.sizes["load_point"]:
            return "no loads"
        if self.data.sizes["state"] == 1:
            return "no state under load"
        if "reaction" not in self.data and not self.data["applied_load"].values[:, :2].any():
            return "no load has a force"
        return "the loads apply no force in any state"

    @cached_property
    def loads(self) -> list[tuple[int, FloatArray, float]]:
        """Disk, force and torque of each load in this state."""
        if not self.index:
            return []
        applied = float(self.values("state_load_factor")) * self.values("applied_load")
        if "reaction" in self.data:
            reaction = self.data["reaction"]
            applied[:, :2] += (reaction.isel(load=self.index - 1) if "load" in reaction.dims else reaction).values
        return [
            (int(disk), load[:2], float(load[2]))
            for disk, load in zip(self.values("loaded_disk"), applied, strict=True)
            if load.any()
        ]


def new_axes(ax: Axes | None, aspect: float) -> Axes:
    """The given axes, or those of a new figure as high as ``aspect`` times its width."""
    if ax is not None:
        return ax
    return new_figure(max(1.4, aspect * style.DOUBLE + 0.35)).subplots()


def new_figure(height: float) -> Figure:
    """A figure that notebooks show and ``pyplot.show`` opens, ``height`` inches high."""
    import matplotlib.pyplot as plt  # here, so that figures without a display never touch it

    return plt.figure(figsize=(style.DOUBLE, height), layout="constrained")


def aspect_of(shown: Shown, half_width: float | None = None) -> float:
    """Height over width of a picture of the packing, with room for the arrow of a load."""
    return float(1.2 * shown.top / np.ptp(shown.across(half_width)))


def draw_loads(axes: Axes, shown: Shown, *, origin: float | None = None) -> None:
    """Loaded disks, and an arrow for each force that ends at the disk it pushes, the largest a fifth of the height.

    ``origin`` : from where the picture counts x, the shortest way.
    """
    if not shown.loads:
        return
    # loads that look alike are drawn once
    loads = dict.fromkeys((disk, *force.tolist(), torque) for disk, force, torque in shown.loads)
    largest = max((float(np.hypot(*force)) for _, *force, _ in loads), default=0.0)
    disks = list(dict.fromkeys(disk for disk, *_ in loads))
    centres = shown.position[disks]
    if origin is not None:
        centres = shown.box.separation(centres, np.array([origin, 0.0]))
    network.draw_loaded_disk(axes, centres, shown.radius[disks])
    places = dict(zip(disks, centres, strict=True))
    for disk, *components, torque in loads:
        force, centre, radius = np.array(components), places[disk], float(shown.radius[disk])
        if size := float(np.hypot(*force)):
            length = max(3.0, 0.16 * shown.top) * size / largest
            network.draw_load(axes, centre - radius * force / size, force, length=length)
        network.draw_torque(axes, centre, torque, radius=1.7 * radius)
        if torque and not largest:  # no arrow of a force makes room for the arc
            network.include(axes, centre[None] + (0.0, 2.2 * radius))
