"""What the figures of several groups repeat: names of packings, the line at zero."""

from __future__ import annotations

from matplotlib.axes import Axes

from granular_response.plot import style


def packing(polydispersity: float) -> str:
    """A name for titles and legends."""
    return style.equals(style.POLYDISPERSITY, polydispersity) if polydispersity else "lattice"


def material(polydispersity: float, friction: float) -> str:
    """A name for titles and legends."""
    return f"{packing(polydispersity)}, {style.equals(style.FRICTION, friction)}"


def zero(*panels: Axes) -> None:
    """A faint line where there is no response, below everything."""
    for axes in panels:
        axes.axhline(0.0, color=style.FAINT, linewidth=0.5, linestyle="-", zorder=0)
