"""Renews the tables of the survey in docs/_generated/survey.md from what is stored: python document.py."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import xarray as xr

from granular_response.store import atomic
from granular_response_paper.groups.phase_diagram.simulate import simulate
from granular_response_paper.pipeline.simulation import parameters
from granular_response_paper.report.markdown import table
from granular_response_paper.survey.crossover import ABOVE, BELOW, FOUND
from granular_response_paper.survey.datasets import usual

ROOT = Path(__file__).resolve().parents[2]
NOTES = ROOT / "docs" / "_generated" / "survey.md"
#: Of the smoothing, as in Fig. 22; the polydispersity of which the paper states what contacts are missing.
WIDTH, STATED = 6.0, 0.01
#: Places of the 2.5 and 97.5 per cent quantiles among the stored levels.
ENDS = (0, -1)


def crossovers(datasets: Mapping[str, xr.Dataset]) -> str:
    """A line for each disordered case that starts with the largest disks touching, and for each lattice."""
    found, single = usual(datasets["crossovers"]), usual(datasets["realizations"])
    w = found["width"].values.tolist().index(WIDTH)
    heads = ["δ", "µ", "realizations (collapsed)", "mean response", "median of realizations"]
    rows = []
    for case in np.lexsort((found["friction"].values, found["polydispersity"].values)):
        collapsed = int(np.isfinite(single["collapse_force"].values[case]).sum())
        count = int(found["realizations"].values[case])
        cells = [f"{found['polydispersity'].values[case]:g}", f"{found['friction'].values[case]:g}"]
        cells.append(f"{count} ({collapsed})" if collapsed else f"{count}")
        cells += [force(found, (w, case)), number(float(single["median"].values[w, case]))]
        rows.append(cells)
    return table(heads, rows)


def force(data: xr.Dataset, place: tuple[int, ...]) -> str:
    """A crossover force with its interval, or the bound that is known."""
    value, kind = float(data["force"].values[place]), int(data["kind"].values[place])
    text = {FOUND: "", BELOW: "below ", ABOVE: "above "}[kind] + f"{value:.3g}"
    low, high = (float(data["interval"].values[place][end]) for end in ENDS)
    if low == high:
        return text
    return f"{text} ({number(low)} to {number(high)})"


def number(value: float) -> str:
    return f"{value:.3g}" if np.isfinite(value) else ("beyond" if value > 0.0 else "below all")


def starts(datasets: Mapping[str, xr.Dataset]) -> str:
    """A line for each initial lattice: contacts without friction, and the dips with and without it."""
    data = datasets["starts"]
    heads = ["lattice constant", "coordination number", "horizontal fraction of the missing contacts"]
    heads += ["dip, µ = 0", "dip, µ = 0.2"]
    rows = []
    pairs = zip(data["distance"].values.tolist(), data["friction"].values.tolist(), strict=True)
    place = {(round(distance, 6), mu): case for case, (distance, mu) in enumerate(pairs)
             if data["polydispersity"].values[case] == STATED}  # fmt: skip
    for distance in sorted(distance for distance, mu in place if mu == 0.0 and (distance, 0.2) in place):
        without, full = place[distance, 0.0], place[distance, 0.2]
        name = str(data["lattice_constant"].values[without])
        rows.append(
            [
                f"{distance:.5g}{', largest disks touch' if name.startswith('touching') else ''}",
                with_interval(data, "contacts", (without,), 1.0, 3),
                f"{with_interval(data, 'missing_horizontal', (without,), 100.0, 0)} %",
                f"{with_interval(data, 'dip', (0, without), 100.0, 0)} %",
                f"{with_interval(data, 'dip', (0, full), 100.0, 1)} %",
            ]
        )
    return table(heads, rows)


def with_interval(data: xr.Dataset, name: str, place: tuple[int, ...], factor: float, digits: int) -> str:
    """A mean and half the width of its interval."""
    low, high = (float(data[f"{name}_interval"].values[place][end]) for end in ENDS)
    return f"{factor * float(data[name].values[place]):.{digits}f} ± {0.5 * factor * (high - low):.{digits}f}"


def text(datasets: Mapping[str, xr.Dataset]) -> str:
    """Both tables in Markdown. Equal data give equal text."""
    return "\n".join(
        [
            "Crossover forces in mg (w = 6), with 95 % of the bootstrap draws:",
            "",
            crossovers(datasets),
            "",
            "Initial lattices at δ = 0.01, with half the width of the 95 % interval; contacts with walls counted, dips"
            " under 15 mg smoothed with w = 3:",
            "",
            starts(datasets),
        ]
    )


def measured() -> dict[str, xr.Dataset]:
    """What the study ``phase_diagram`` makes of the stored survey."""
    _, described = parameters("phase_diagram", ROOT / "params.yaml")
    return simulate(described.model_copy(update={"survey": str(ROOT / described.survey)}))  # type: ignore[attr-defined]


def main() -> None:
    atomic.write_bytes(NOTES, f"{text(measured())}\n".encode())


if __name__ == "__main__":
    main()
