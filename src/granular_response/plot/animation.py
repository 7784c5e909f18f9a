"""A growing load as an animation: incremental forces, the contacts that it opens, the floor response."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from PIL import Image

from ..errors import require
from ..state import FloatArray
from ..store import atomic
from . import chains, style
from .chains import draw_chains, draw_key, draw_peaks, draw_response
from .shown import HasDataset, PictureError, Shown, check_positive, new_figure, written

Results = HasDataset | xr.Dataset | Mapping[str, HasDataset | xr.Dataset]

#: Endings of files, and how Pillow is to write them; ffmpeg writes .mp4.
FORMATS: Mapping[str, Mapping[str, Any]] = {
    ".gif": {"optimize": False},
    ".webp": {"quality": 80, "method": 4},
    ".html": {},
    ".mp4": {},
}
#: Seconds that the last frame of a file stays at least.
HELD = 1.5
#: Colours of a GIF, and the least difference of two of them, of 255.
COLOURS, APART = 32, 12
#: A contact force of this part of the load has full width.
FULL = 0.6
#: Inches: margins left, right, below and above, gap between pictures, height of a floor response.
_LEFT, _RIGHT, _BELOW, _ABOVE, _GAP, _RESPONSE = 0.55, 0.12, 0.42, 0.3, 0.12, 1.1


def animate(
    results: Results,
    *,
    output: str | os.PathLike[str] | None = None,
    half_width: float | None = None,
    fps: float = 6.0,
    dpi: float = 120.0,
    width: float = style.DOUBLE,
    figure: Figure | None = None,
) -> FuncAnimation:
    """Animation of a growing load: force chains and opened contacts above the floor response, a frame for each load.

    Forces are divided by the applied force, on one scale in all frames, so that only nonlinear changes are seen. Grey:
    response to the first load. Beside each floor response stands whether it has one peak or two. Each frame is one of
    the ``load_factors`` given to ``solve``.

    Parameters
    ----------
    results : one, or several by their titles, which are shown side by side: with the same forces, in the same order.
    output : file to write, atomically: .gif, .webp, .html, or .mp4 where the program ffmpeg is installed.
    half_width : draw what is within this distance of the loaded disk, in mean radii; by default all.
    fps : frames per second; in a file the last one stays for at least a second and a half (not in .html).
    dpi, width : pixels per inch, and inches from side to side.
    figure : drawn into, or a new one of pyplot's.

    Raises PictureError for results without a response or whose forces differ, another ending, a number that is not
    positive, .mp4 without ffmpeg, and a file that cannot be written.

    Examples
    --------
    >>> import numpy as np
    >>> growing = gr.solve(result.scene, load_factors=np.linspace(0.1, 2.0, 20))
    >>> animation = gr.plot.animate(growing, output="growing.gif")  # in a notebook: HTML(animation.to_jshtml())
    """
    check_positive(fps=fps, dpi=dpi)
    check_target(output)
    frames = Frames(results, half_width=half_width, width=width, figure=figure)
    return animated(frames.figure, frames.draw, frames.count, output, fps=fps, dpi=dpi)


def check_target(output: str | os.PathLike[str] | None) -> None:
    """PictureError, before the work, for a file that no animation can be written to."""
    if output is None:
        return
    if (ending := Path(output).suffix) not in FORMATS:
        raise PictureError(f"{output}: format {ending!r} is unknown, must be {', '.join(FORMATS)}")
    if ending == ".mp4" and not FFMpegWriter.isAvailable():
        others = ", ".join(one for one in FORMATS if one != ending)
        raise PictureError(f"{output}: the program ffmpeg, which writes .mp4, is not installed; {others} need none")
    with written(output):
        atomic.make_folder(output)
        atomic.check_writable(output)


def animated(
    figure: Figure, draw: Any, count: int, output: str | os.PathLike[str] | None, *, fps: float, dpi: float
) -> FuncAnimation:
    """An animation of ``count`` frames, written to ``output`` if that is given; PictureError where it cannot be."""
    figure.set_dpi(dpi)
    animation = FuncAnimation(figure, draw, frames=count, interval=1000.0 / fps, blit=False)
    if output is not None:
        with written(output):
            atomic.write_bytes(output, rendered(animation, Path(output).suffix, fps=fps, dpi=dpi))
    return animation


def rendered(animation: FuncAnimation, ending: str = ".gif", *, fps: float = 6.0, dpi: float = 120.0) -> bytes:
    """The file of an animation in memory; of .gif and .webp the same bytes every time."""
    with style.context():
        if ending == ".html":
            return animation.to_jshtml(fps=max(1, round(fps))).encode()
        with atomic.scratch() as folder:
            target = folder / f"animation{ending}"
            writer: AbstractMovieWriter = _Film(fps) if ending == ".mp4" else _Writer(fps, ending)
            animation.save(target, writer=writer, dpi=dpi)
            return target.read_bytes()


class Frames:
    """The figure of an animation, and what draws each of its frames into it."""

    def __init__(
        self,
        results: Results,
        *,
        half_width: float | None = None,
        width: float = style.DOUBLE,
        figure: Figure | None = None,
    ) -> None:
        """Parameters and errors are those of :func:`animate`."""
        check_positive(half_width=half_width, width=width)
        given = results if isinstance(results, Mapping) and not isinstance(results, xr.Dataset) else {"": results}
        self.columns = {title: Shown.of(one) for title, one in given.items()}
        shown = [*self.columns.values()]
        for one in shown:
            require(not one.lack, f"results: {one.lack}, so there is no response", PictureError)
        forces = [np.atleast_1d(one.data["total_force"].values) for one in shown]
        if any(one.shape != forces[0].shape or not np.allclose(one, forces[0], rtol=1e-6) for one in forces):
            raise PictureError("results: must have the same forces, one for each frame")
        self.forces: FloatArray = forces[0]
        rule = "results: one load makes no animation, must have two or more (load_factors)"
        require(len(self.forces) >= 2, rule, PictureError)
        self.half = half_width or max(max(one.origin, one.box.width - one.origin) for one in shown)
        self.responses = [np.atleast_2d(one.data["floor_response"].values) for one in shown]
        near = [np.abs(one.data["x"].values) <= self.half for one in shown]
        seen = np.concatenate([one[:, here].ravel() for one, here in zip(self.responses, near, strict=True)])
        self.limits = min(0.0, 1.05 * float(np.nanmin(seen))), 1.08 * float(np.nanmax(seen))
        with style.context():
            self.figure, self.panels = _panels(shown, self.half, width, figure)

    @property
    def count(self) -> int:
        """One for each load."""
        return len(self.forces)

    def draw(self, frame: int) -> list[Any]:
        """Draw the frame of a load, counted from 0 or from the end; nothing of the one before stays."""
        frame %= self.count
        force = float(self.forces[frame])
        with style.context():
            for k, (title, shown) in enumerate(self.columns.items()):
                above, below = self.panels[:, k]
                above.clear()
                draw_chains(above, Shown(shown.data, frame + 1), largest=FULL * force, half_width=self.half)
                above.set_title(title, pad=0.0)
                below.clear()
                x, responses = shown.data["x"].values, self.responses[k]
                draw_response(below, x, responses[frame], responses[0], half_width=self.half, limits=self.limits)
                draw_peaks(below, shown, responses[frame])
                below.set_xlabel(style.POSITION)
                below.tick_params(labelleft=k == 0)
            self.panels[1, 0].set_ylabel(style.RESPONSE)
            draw_key(self.panels[1, -1], "small load")
            self.panels[0, 0].text(0.0, 1.0, style.equals(style.F_EXT, round(force, 3), style.WEIGHT),
                                   transform=self.panels[0, 0].transAxes, va="bottom")  # fmt: skip
        return []


def _panels(columns: Sequence[Shown], half: float, width: float, figure: Figure | None) -> tuple[Figure, np.ndarray]:
    """A figure with places that stay: a chain picture as wide as the floor response below it, for each result."""
    count = len(columns)
    wide = (width - _LEFT - _RIGHT - (count - 1) * _GAP) / count
    high = wide * (max(map(chains.height, columns)) + 0.5) / (2.0 * half)
    bottom = _BELOW + _RESPONSE + 0.5 * _GAP
    height = bottom + high + _ABOVE
    figure = new_figure(height) if figure is None else figure
    figure.set_layout_engine("none")
    figure.set_size_inches(width, height)
    panels = np.empty((2, count), dtype=object)
    for k in range(count):
        left = (_LEFT + k * (wide + _GAP)) / width
        panels[0, k] = figure.add_axes((left, bottom / height, wide / width, high / height))
        panels[1, k] = figure.add_axes((left, _BELOW / height, wide / width, _RESPONSE / height))
    return figure, panels


class _Film(FFMpegWriter):
    """For any player: colours of half the resolution, and so an even number of pixels to each side."""

    def __init__(self, fps: Any) -> None:
        filters = f"pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,tpad=stop_mode=clone:stop_duration={HELD}"
        super().__init__(fps=fps, codec="libx264", extra_args=["-vf", filters, "-pix_fmt", "yuv420p"])


class _Writer(PillowWriter):
    """Pillow's writer, with one table of colours for all frames of a GIF: then parts that stay take no room."""

    def __init__(self, fps: float, ending: str) -> None:
        super().__init__()
        self.step, self.ending = round(1000.0 / fps), ending
        self.frames: list[Image.Image] = []

    def grab_frame(self, **savefig: Any) -> None:
        buffer = io.BytesIO()
        self.fig.savefig(buffer, format="rgba", dpi=self.dpi, **savefig)
        self.frames.append(Image.frombytes("RGBA", self.frame_size, buffer.getvalue()).convert("RGB"))

    def finish(self) -> None:
        frames = self.frames
        if self.ending == ".gif":
            palette = _palette(frames[-1])
            frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
        durations = [*[self.step] * (len(frames) - 1), max(self.step, round(1000 * HELD))]
        options = {"append_images": frames[1:], "duration": durations, "loop": 0, **FORMATS[self.ending]}
        frames[0].save(self.outfile, save_all=True, **options)


def _palette(frame: Image.Image) -> Image.Image:
    """An image with the most frequent colours of a frame, for ``Image.quantize``."""
    found: Any = frame.getcolors(frame.width * frame.height)
    chosen: list[tuple[int, ...]] = []
    for _, colour in sorted(found, reverse=True):
        if all(max(abs(a - b) for a, b in zip(colour, other, strict=True)) >= APART for other in chosen):
            chosen.append(colour)
        if len(chosen) == COLOURS:
            break
    palette = Image.new("P", (1, 1))
    palette.putpalette([part for colour in chosen for part in colour])
    return palette
