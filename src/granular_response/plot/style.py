"""The one look of all figures: fonts, sizes, colours, panel letters, and files with reproducible bytes.

A drawing function is called within :func:`context`, makes its figures with :func:`figure`, and they
are written with :func:`save`: then all of it happens under :data:`RC`. Only fonts that matplotlib itself
ships are used, ``pyplot`` is not, and so neither the machine's fonts nor a display change a byte.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.rcsetup import cycler
from PIL import Image

from ..errors import require
from ..store import atomic

#: Column widths of the journal in inches.
SINGLE, DOUBLE = 3.4, 7.0
#: Inches around a page.
MARGIN = 0.06

#: Categorical colours (Okabe and Ito), told apart with every common kind of colour vision; each with a line
#: style and a marker of its own, so that they survive a black-and-white print too.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK = COLOURS
LINE_STYLES: tuple[Any, ...] = (
    "-",
    (0, (5, 1.6)),
    (0, (1.2, 1.2)),
    (0, (6, 1.4, 1.2, 1.4)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (8, 2)),
    (0, (2.5, 2.5)),
)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

#: What colours mean in every picture of a packing, of the library, the paper and its page alike: contacts that a load
#: opened (also apart from the region below it) or closed, contacts that slide, contact forces that it made larger or
#: smaller, the load itself, disks.
OPENED, CLOSED, SLIDING = VERMILION, GREEN, BLUE
OPENED_ELSEWHERE = "#F3B58C"
INCREASED, DECREASED = "#12233F", "#8FA3BF"
LOAD, DISKS = "#9B2D7B", "#EFEDE8"
#: Those of the page's explorer by name: on white, and on a dark screen.
MEANINGS: dict[str, tuple[str, str]] = {
    "opened": (OPENED, "#F0893A"),
    "sliding": (SLIDING, SKY),
    "increased": (INCREASED, "#C9D6EA"),
    "decreased": (DECREASED, "#63779A"),
    "load": (LOAD, "#D987BE"),
}

#: Colour map of magnitudes.
SEQUENTIAL = "viridis"
#: The ends of the ramps of :func:`ordered_colours`, dark to light, one for each quantity that curves are told apart by.
#: The light ends keep a contrast of 3 to white.
RAMPS: dict[str, tuple[str, ...]] = {
    "force": ("#440154", "#31688E", "#2A9D76"),
    "friction": ("#000000", "#004A7F", "#2E9BD6"),
    "polydispersity": ("#1A1A1A", "#A3122A", "#E0792B"),
    "length": ("#2D004B", "#8B3A8F", "#CC79A7"),
    "other": ("#2B1A00", "#7A6A00", "#5F9E2A"),
}

#: Symbols of the paper, for :func:`equals` and for labels: set them between dollar signs.
F_EXT = r"F_{\mathrm{ext}}"
FRICTION, WALL_FRICTION = r"\mu", r"\mu^{\mathrm{wall}}"
BOTH_FRICTIONS = f"{FRICTION} = {WALL_FRICTION}"
STIFFNESS_RATIO = "k_T/k_N"
POLYDISPERSITY = r"\delta"
#: Units: mean disk weight, mean radius, stiffness, torque.
WEIGHT, RADIUS = r"\bar m g", r"\bar R"
STIFFNESS_UNIT, TORQUE_UNIT = rf"{WEIGHT}/{RADIUS}", rf"{WEIGHT}{RADIUS}"

#: One label for each quantity.
POSITION = rf"$x/{RADIUS}$"
HEIGHT = rf"$z/{RADIUS}$"
DEPTH = rf"depth$\,/\,{RADIUS}$"
WIDTH = rf"width$\,/\,{RADIUS}$"
SCALED_POSITION = "$x/h$"
FORCE = rf"${F_EXT}/{WEIGHT}$"
RESPONSE = "normalized floor response"
RESPONSE_AT_CENTRE = f"{RESPONSE} at $x=0$"
FLOOR_FORCE = rf"floor force$\,/\,{WEIGHT}$"
INCREMENTAL_FLOOR_FORCE = f"incremental {FLOOR_FORCE}"
#: Where the response is smoothed, it is a stress.
FLOOR_STRESS = rf"smoothed floor response $\sigma_{{zz}}{RADIUS}/{F_EXT}$"
PRESSURE = rf"floor pressure $p\,h/{F_EXT}$"
STRESS = rf"$\sigma_{{zz}}{RADIUS}/{F_EXT}$"
STRESS_OF_GRAVITY = rf"$\sigma_{{zz}}{RADIUS}/{WEIGHT}$"
STIFFNESS = rf"$k_N{RADIUS}/{WEIGHT}$"
CONTACT_FORCE = rf"$|\,\mathbf{{f}}\,|\,/\,{WEIGHT}$"
ENERGY_UNIT = rf"{WEIGHT}{RADIUS}"
TIME_UNIT = rf"\sqrt{{{RADIUS}/g}}"
#: A difference of stresses has both signs: blue is compression, red the loss of it, white neither.
SIGNED = "RdBu"

#: Greys of things that are there for orientation only.
FAINT, MUTED = "#C8C8C8", "#707070"

#: What the paper says, on a plot: lines with its value beside them, or a band.
PAPER, PAPER_BAND = "#9A7B4F", "#F1E9DA"

_SHEET: Any = mpl.rc_params_from_file(Path(__file__).with_suffix(".mplstyle"), use_default_template=False)
RC: dict[str, Any] = {**_SHEET, "axes.prop_cycle": cycler(color=COLOURS) + cycler(linestyle=LINE_STYLES)}
#: Settings of the program rather than of a picture; resetting some of them warns or switches the backend.
_NOT_STYLE = ("animation", "backend", "backend_fallback", "docstring", "interactive", "keymap", "macosx", "timezone",
              "tk", "toolbar", "webagg")  # fmt: skip


#: Settings that a user of the library may choose, by how their names begin: fonts, sizes, and how files are saved.
#: Colours of the ground and of texts are no part of it: pictures of packings are made for white.
_USERS = ("font.", "mathtext.", "text.usetex", "text.latex", "legend.", "axes.labelsize", "axes.titlesize",
          "axes.titleweight", "axes.labelweight", "axes.linewidth", "axes.prop_cycle", "xtick.", "ytick.", "figure.dpi",
          "lines.linewidth", "lines.markersize", "savefig.", "pdf.", "ps.", "svg.")  # fmt: skip
#: Sizes of texts, which go with the size of the user's font unless he sets them too.
_TEXT_SIZES = ("axes.labelsize", "axes.titlesize", "legend.fontsize", "legend.title_fontsize", "xtick.labelsize",
               "ytick.labelsize")  # fmt: skip


def _defaults() -> dict[Any, Any]:
    return {key: one for key, one in mpl.rcParamsDefault.items() if key.partition(".")[0] not in _NOT_STYLE}


@contextmanager
def context() -> Iterator[None]:
    """Where matplotlib's defaults and then :data:`RC` hold, whatever the user's own settings.

    Legends, colour bars and texts take their looks when they are made, so the whole of a drawing function
    belongs inside: as a decorator, or around its call, as for those of the figure groups.
    """
    with _settings({**_defaults(), **RC}):
        yield


@contextmanager
def with_users() -> Iterator[None]:
    """As :func:`context`, for pictures of the library: fonts, sizes and line widths that the user has set stay.

    What differs from matplotlib's defaults counts as set, so that within :func:`context` nothing changes.
    """
    defaults = _defaults()
    settings = {**defaults, **RC}
    users = {key: mpl.rcParams[key] for key in defaults if key.startswith(_USERS)}
    users = {key: one for key, one in users.items() if one != defaults[key]}
    if users.get("font.size", RC["font.size"]) != RC["font.size"]:
        settings |= {key: defaults[key] for key in _TEXT_SIZES}
    with _settings({**settings, **users}):
        yield


def users_cycle() -> list[Any]:
    """The colours of the user's ``axes.prop_cycle``; none where it is that of matplotlib or of this package."""
    cycle = mpl.rcParams["axes.prop_cycle"]
    known = mpl.rcParamsDefault["axes.prop_cycle"], RC["axes.prop_cycle"]
    return [] if cycle in known else list(cycle.by_key().get("color", ()))


@contextmanager
def _settings(settings: dict[Any, Any]) -> Iterator[None]:
    # Not by rc_context, which restores all settings. The first figure of a program may load the backend in here, and
    # that of notebooks switches matplotlib to interactive: were this undone, notebooks would show no further figure.
    before: dict[Any, Any] = {key: mpl.rcParams[key] for key in settings}
    mpl.rcParams.update(settings)
    try:
        yield
    finally:
        mpl.rcParams.update(before)


def figure(
    rows: int = 1, columns: int = 1, *, width: float = DOUBLE, height: float = 2.5, **subplots: Any
) -> tuple[Figure, np.ndarray]:
    """A figure with constrained layout and its (rows, columns) array of axes.

    ``width`` and ``height`` are in inches; ``subplots`` goes to ``Figure.subplots`` (``sharex``, ...).
    """
    with context():
        made = Figure(figsize=(width, height), layout="constrained")
        return made, made.subplots(rows, columns, squeeze=False, **subplots)


def ordered_colours(count: int, *, of: str = "force") -> list[str]:
    """``count`` colours for an ordered family of curves, dark to light, on the ramp of a quantity of :data:`RAMPS`."""
    require(count >= 1, f"count = {count}: must be at least 1")
    ramp = LinearSegmentedColormap.from_list(of, RAMPS[of])
    return [to_hex(colour) for colour in ramp(np.linspace(0.0, 1.0, count))]


def line(index: int) -> dict[str, Any]:
    """Colour and line style number ``index`` of the categorical cycle, as keywords of ``plot``."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": LINE_STYLES[index % len(LINE_STYLES)]}


def marked_line(index: int, *, colour: str | None = None) -> dict[str, Any]:
    """As :func:`line`, solid and with a marker of its own: for curves through few points."""
    return {
        "color": colour or COLOURS[index % len(COLOURS)],
        "linestyle": "-",
        "linewidth": 0.9,
        "marker": MARKERS[index % len(MARKERS)],
        "markeredgewidth": 0.0,
    }


def letter(axes: Axes, name: str, *, place: Literal["inside", "above"] = "inside", text: str = "") -> None:
    """Write the panel letter ``(name)`` in the upper left corner, with a short ``text`` behind it.

    ``above`` puts it over the axes, for panels that are full of drawing.
    """
    label = f"({name})" + (f" {text}" if text else "")
    with with_users():
        if place == "above":
            axes.set_title(label, loc="left", pad=3.0)
        else:
            axes.annotate(
                label, (0.0, 1.0), (5.0, -5.0), xycoords="axes fraction", textcoords="offset points", va="top"
            )


def drawn_letters(drawn: Figure) -> list[str]:
    """The panel letters that a figure has, sorted."""
    texts = [text for axes in drawn.axes for text in (axes.get_title("left"), *(t.get_text() for t in axes.texts))]
    return sorted(match[1] for match in (re.match(r"\(([a-z])\)", text) for text in texts) if match)


def equals(symbol: str, value: float, unit: str = "") -> str:
    """``symbol = value unit`` as it is set: ``equals(F_EXT, 15, WEIGHT)``; whole powers of ten from 1e4 on as such."""
    exponent = round(np.log10(value)) if value >= 1e4 else 0
    number = f"10^{{{exponent}}}" if exponent and np.isclose(value, 10.0**exponent) else f"{value:g}"
    return f"${symbol} = {number}" + (rf"\,{unit}$" if unit else "$")


def paper_value(
    axes: Axes,
    value: float,
    text: str = "",
    *,
    along: Literal["x", "y"] = "x",
    at: float = 0.97,
    side: Literal["before", "behind"] = "before",
) -> None:
    """Mark a ``value`` that the paper prints, in one light style: a dotted line across the axes and ``text`` on it.

    Parameters
    ----------
    along : axis that the value is read on.
    at : where the text ends on the other axis, as a part of it.
    side : the text stands before the line (left of it, above it) or behind it.
    """
    with context():
        upright = along == "x"
        line = axes.axvline if upright else axes.axhline
        line(value, color=PAPER, linewidth=0.8, linestyle=(0, (1.0, 1.6)), zorder=0.5)
        if not text:
            return
        gap, across, over = (1.5, "left", "top") if side == "behind" else (-1.5, "right", "bottom")
        axes.annotate(
            text,
            (value, at) if upright else (at, value),
            (gap, 0.0) if upright else (0.0, -gap),
            xycoords=("data", "axes fraction") if upright else ("axes fraction", "data"),
            textcoords="offset points",
            rotation=90.0 if upright else 0.0,
            ha=across if upright else "right",
            va="top" if upright else over,
            fontsize=7,
            color=PAPER,
        )


def logarithmic(axes: Axes, names: str = "xy") -> None:
    """A logarithmic scale along the axes in ``names`` on which something positive was drawn; others stay linear."""
    for name in names:
        if np.isfinite(getattr(axes.dataLim, f"minpos{name}")):
            axes.set(**{f"{name}scale": "log"})


def no_axes(axes: Axes) -> None:
    """Leave only the drawing, with equal scales: for pictures of packings."""
    axes.set_aspect("equal")
    axes.set_axis_off()


#: What each format must not be told, for the same bytes every time.
_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "svg": {"Date": None, "Creator": None},
}
#: Formats that a figure can be written in.
FORMATS = tuple(_METADATA)


def render(drawn: Figure, file_format: str = "png", *, dpi: float = 200) -> bytes:
    """The file of a figure in memory: ``png``, ``pdf`` or ``svg``, without date or program name."""
    require(file_format in _METADATA, f"file_format = {file_format!r}: must be one of {', '.join(sorted(_METADATA))}")
    buffer = io.BytesIO()
    # what matplotlib compresses would only be taken apart again
    options: dict[str, Any] = {"pil_kwargs": {"compress_level": 0}} if file_format == "png" else {}
    with context():
        drawn.savefig(buffer, format=file_format, dpi=dpi, metadata=_METADATA[file_format], **options)
    if file_format != "png":
        return buffer.getvalue()
    written = io.BytesIO()
    with Image.open(buffer) as image:  # no figure uses the alpha channel: without it files are a tenth smaller
        image.convert("RGB").save(written, "png", dpi=(dpi, dpi))
    return written.getvalue()


def save(
    drawn: Figure,
    stem: str,
    folder: str | os.PathLike[str],
    formats: Sequence[str] = ("png",),
    inputs: Sequence[str | os.PathLike[str]] = (),
) -> list[Path]:
    """Write ``folder/stem.png`` (200 dots per inch) and other ``formats``, each atomically, laid out as the first one.

    Returns the paths. A missing folder is made. The same figure gives the same bytes. Raises OSError if a
    file cannot be written or is one of ``inputs``.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    files, layout = {}, drawn.get_layout_engine()
    for file_format in formats:
        files[target / f"{stem}.{file_format}"] = render(drawn, file_format)
        with context():
            drawn.set_layout_engine(None)  # to lay out takes as long as to draw
    drawn.set_layout_engine(layout or "none")
    for path in files:
        atomic.check_writable(path, inputs)
    for path, data in files.items():
        atomic.write_bytes(path, data)
    return list(files)
