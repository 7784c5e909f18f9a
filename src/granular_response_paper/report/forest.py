"""The numbers that the paper prints beside ours, in one picture, and what the preparation does to one of them.

Both are drawn from ``quantities`` of the stored claims, so that no number is here that no claim has.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator

from granular_response.plot import style

from ..claims.numbers import shown

Quantities = Sequence[Mapping[str, Any]]

#: Inches: width of a picture, which a telephone shows at a third of its pixels; height of a row; around the rows.
WIDTH, ROW, AROUND = 4.9, 0.25, 0.62

#: Ratios of our numbers to the paper's that the axis names, and its ends, at which points beyond stand as arrows.
RATIOS = (0.01, 0.1, 0.5, 1.0, 2.0)
ENDS = (0.006, 4.5)

#: The claim whose number is shown for each preparation.
PREPARED = "R3a"

#: Colours and names of paler points, by what is other than in the primary case; "": geometry, stiffness, statistic.
PALE = {"gravity": style.OPENED_ELSEWHERE, "lattice": "#9CCDE8", "": style.FAINT}
NAMES = {"gravity": "other gravity", "lattice": "other lattice", "": "other cases"}


def forest(quantities: Quantities) -> Figure:
    """A row for each quantity: ours over the paper's, with its interval, and paler the other cases of the claim."""
    figure, panels = style.figure(width=WIDTH, height=AROUND + ROW * len(quantities))
    axes = panels[0, 0]
    axes.set(xscale="log", xlim=ENDS, ylim=(len(quantities) - 0.4, -1.1))
    axes.plot([1.0, 1.0], [-0.55, len(quantities) - 0.4], color=style.PAPER, linewidth=1.2, linestyle="-", zorder=0.5)
    for row, one in enumerate(quantities):
        for other in one["others"]:
            _point(axes, row, other, one["paper"], PALE[other["prepared"]], 3.2 if other["prepared"] else 2.2)
        _point(axes, row, one["ours"], one["paper"], style.INCREASED, 4.6)
        axes.plot([1.0], [row], marker="|", color=style.PAPER, markersize=9.0, markeredgewidth=1.6, zorder=2)
    for prepared, colour in PALE.items():
        axes.plot([], [], "o", color=colour, markersize=3.2, markeredgewidth=0.0, label=NAMES[prepared])
    set_close = {"fontsize": 6.5, "handletextpad": 0.0, "columnspacing": 0.3}
    axes.legend(loc="upper left", bbox_to_anchor=(-0.04, 1.02), ncols=3, **set_close)
    _columns(axes, quantities)
    axes.xaxis.set_major_locator(FixedLocator(RATIOS))
    axes.xaxis.set_major_formatter(lambda ratio, _: f"{ratio:g}")
    axes.set_xlabel("ours over the paper's")
    _plain(axes)
    return figure


def _columns(axes: Axes, quantities: Quantities) -> None:
    """What the rows are, at the left, and both numbers, at the right; the unit stands behind the paper's."""
    names = [_name(one["what"]) for one in quantities]
    axes.set_yticks(range(len(names)), names, fontsize=7.5, linespacing=0.85)
    said = [("paper", "here")]
    for one in quantities:
        paper, unit = one["paper"] * (100.0 if one["unit"] == "%" else 1.0), f" {one['unit']}".rstrip()
        said.append((f"{paper:g}{unit}", one["ours"]["text"].replace(unit, "") if unit else one["ours"]["text"]))
    for row, (paper, ours) in enumerate(said, -1):
        for text, points, colour in ((paper, 3.0, style.PAPER), (ours, 36.0, style.INCREASED)):
            axes.annotate(text, (1.0, row), (points, 0.0), xycoords=axes.get_yaxis_transform(), color=colour,
                          textcoords="offset points", va="center", fontsize=6.8)  # fmt: skip


def _name(what: str) -> str:
    return (
        textwrap.fill(what.replace("friction ", "µ\u00a0=\u00a0"), width=36)
        .replace("k_T/k_N", "$k_T/k_N$")
        .replace("with k_N", "with $k_N$")
    )


def _point(axes: Axes, row: int, found: Mapping[str, Any], paper: float, colour: str, size: float) -> None:
    """A number over the paper's, of ours with its interval; an arrow from a bound, and at the end of the axis."""
    low, high = found["interval"]
    middle = found["value"] or math.sqrt(low * (high or low))
    at, mark = (low, ">") if high is None else (high, "<") if low <= 0.0 else (middle, "o")
    least, most = ENDS
    if not least < at / paper < most:
        at, mark = (least * paper, "<") if at < paper else (most * paper, ">")
    axes.plot([at / paper], [row], marker=mark, color=colour, markersize=size, markeredgewidth=0.0, zorder=3)
    if colour == style.INCREASED:
        ends = [min(max(end / paper, least), most) for end in (low, at if high is None else high)]
        axes.plot(ends, [row, row], color=colour, linewidth=1.6, linestyle="-", zorder=3)


def preparations(quantities: Quantities) -> Figure:
    """The force at which two peaks appear at friction 0.2, for each way of applying gravity that was tried."""
    (one,) = (one for one in quantities if one["claim"] == PREPARED)
    tried = [other for other in one["others"] if other["prepared"]]
    names = ["gravity at once", *(other["case"].replace("sqrt(R/g)", "√(R/g)") for other in tried)]
    rows = [one["ours"], *tried]
    figure, panels = style.figure(width=WIDTH, height=AROUND + ROW * len(rows))
    axes = panels[0, 0]
    axes.set(xscale="log", ylim=(len(rows) - 0.4, -0.6))
    style.paper_value(axes, one["paper"], "paper", at=0.8)
    for row, found in enumerate(rows):
        low, high = found["interval"]
        colour = style.OPENED if row else style.INCREASED
        axes.plot([low, low if high is None else high], [row, row], color=colour, linewidth=1.6, linestyle="-")
        axes.plot([found["value"] or low], [row], marker="o" if found["value"] else ">", color=colour, markersize=4.6)
        axes.annotate(shown(found["value"] or low), (found["value"] or low, row), (5.0, 0.0), va="center", ha="left",
                      textcoords="offset points", fontsize=7, color=colour)  # fmt: skip
    axes.set_yticks(range(len(rows)), names)
    axes.set_xlim(0.08, 60.0)
    axes.xaxis.set_major_locator(FixedLocator((0.1, 1.0, 10.0)))
    axes.xaxis.set_major_formatter(lambda force, _: f"{force:g}")
    axes.set_xlabel("force at which two peaks appear, friction 0.2 (mg)")
    _plain(axes)
    return figure


def _plain(axes: Axes) -> None:
    """Without a frame and small ticks: the rows are what is read."""
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="y", length=0.0, which="both")
    axes.tick_params(axis="x", top=False)
    axes.spines[["left", "right", "top"]].set_visible(False)


#: The pictures by the names of their files.
FILES = {"forest.png": forest, "preparations.png": preparations}


def render(claims: Mapping[str, Any]) -> dict[str, bytes]:
    """Both pictures as PNG by the names of their files; none where the claims have no such numbers."""
    quantities = claims.get("quantities") or []
    if not any(one["claim"] == PREPARED for one in quantities):
        return {}
    with style.context():
        return {name: style.render(draw(quantities)) for name, draw in FILES.items()}
