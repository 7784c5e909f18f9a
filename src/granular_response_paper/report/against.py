"""The parameters of the paper's captions beside those of the stored datasets, figure by figure and panel by panel.

What the paper states is transcribed here, from each caption or from the section that speaks of the figure; what was
simulated is read from the datasets, so the table cannot say what was not done.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.store import files as store

from .markdown import table

#: Name of the generated lines in the document.
BLOCK = "figures"

#: Largest relative difference of two numbers that count as the same.
_SAME = 1e-9


@dataclass(frozen=True)
class Row:
    """A parameter of a figure.

    ``source`` is ``group/dataset`` with ``:variable``, ``@key.of.the.scene`` or ``#attribute``; ``of`` makes the
    parameter of what stands there.
    """

    figure: int
    panels: str
    parameter: str
    paper: tuple[float, ...]  #: all that the paper states; none if it states nothing
    source: str
    remark: str = ""  #: why it is another one here, or what the paper does not say
    of: Callable[[NDArray[Any]], Any] = np.ravel

    @property
    def group(self) -> str:
        return self.source.partition("/")[0]

    def stored(self, datasets: Mapping[str, xr.Dataset]) -> NDArray[np.float64]:
        """What was simulated. Raises KeyError if it is not there."""
        rest = self.source.partition("/")[2]
        name, mark, key = next(rest.partition(mark) for mark in ":@#" if mark in rest)
        data = datasets[name]
        if mark == "@":
            scene = Scene.from_text(data.attrs["scene"])
            value: Any = scene.to_dict() | {"wall": scene.resolved_wall.model_dump()}
            for part in key.split("."):
                value = value[part]
        else:
            value = data[key].values if mark == ":" else data.attrs[key]
        return np.atleast_1d(self.of(np.asarray(value))).astype(float)


def _loads(force: NDArray[Any]) -> float:
    return round(float(np.hypot(*force)), 9)


def _below_horizontal(force: NDArray[Any]) -> float:
    return round(float(np.degrees(np.arctan2(-force[1], force[0]))), 9)


_SLAB, _RANGE, _PILE, _TWO = "frictionless_crossover", "friction_linear_range", "pile_dip", "superposition"
_MEANS, _FIELDS, _TORQUE = "polydisperse_averages", "friction_fields", "torque"
_RATIO = "stiffness_ratio_crossover"

#: In the order of the paper. Values that the paper gives only on its plots are not in its text.
ROWS: tuple[Row, ...] = (
    Row(1, "(a)", "Poisson ratio of the slab", (), "theory/predictions:poisson_ratio", "schematic in the paper"),
    Row(1, "(a), (b)", "height of the slab, R", (), "theory/predictions:depth", "schematic in the paper"),
    Row(1, "(b)", "angle of the rays, degrees", (), "theory/predictions:ray_angle", "schematic in the paper"),
    Row(2, "(a), (b)", "δ", (0.25,), f"{_MEANS}/forces:polydispersity"),
    Row(2, "(a), (b)", "µ = µ_wall", (0.2,), f"{_MEANS}/forces:friction"),
    Row(2, "(a), (b)", "k_T/k_N", (0.8,), f"{_MEANS}/forces@contact.stiffness_ratio"),
    Row(2, "(a) rest, (b) load", "F_ext, mg", (5.0,), f"{_MEANS}/forces:force"),
    Row(3, "all", "layers (Sec. IV.A)", (15.0,), f"{_SLAB}/response:layers"),
    Row(3, "all", "disks in a row (Sec. IV.A)", (60.0,), f"{_SLAB}/response:disks_per_row",
        "61 and 60 in turn, so that a disk of the top row is in the middle"),
    Row(3, "all", "k_N, mg/R (Sec. IV.C)", (3000.0,), f"{_SLAB}/response:normal_stiffness"),
    Row(3, "all", "F_ext, mg", (), f"{_SLAB}/response:force", "on the plots only"),
    Row(4, "(a) to (c)", "F_ext, mg", (), f"{_SLAB}/states:force", "on the plots only"),
    Row(5, "all", "layers", (), f"{_SLAB}/sizes:layers", "on the plots only"),
    Row(6, "all", "µ_wall", (0.0,), f"{_RANGE}/response@wall.friction"),
    Row(6, "all", "k_T/k_N", (0.8,), f"{_RANGE}/response@contact.stiffness_ratio"),
    Row(6, "all", "µ (Sec. V.B)", (0.0, 0.2, 1.0), f"{_RANGE}/response:friction"),
    Row(6, "all", "F_ext of the first opening, mg (Sec. V.B)", (0.75,), f"{_SLAB}/response:force", "without friction"),
    Row(6, "all", "F_ext of the first opening, mg (Sec. V.B)", (4.0, 6.0), f"{_RANGE}/response:force", "µ = 0.2 and 1"),
    Row(7, "(a), (b)", "µ (Sec. V.A)", (0.2, 1.0), f"{_RANGE}/response:friction"),
    Row(7, "(b)", "largest F_ext, mg (Sec. V.A)", (50.0,), f"{_RANGE}/response:force"),
    Row(7, "(a), (b)", "µ_wall", (0.0,), f"{_RANGE}/response@wall.friction"),
    Row(7, "(a), (b)", "k_T/k_N", (0.8,), f"{_RANGE}/response@contact.stiffness_ratio"),
    Row(8, "(a) to (c)", "µ", (0.2,), f"{_RANGE}/response:friction"),
    Row(8, "(a) to (c)", "µ_wall", (0.0,), f"{_RANGE}/states_mu_0.2@wall.friction"),
    Row(8, "(a) to (c)", "k_T/k_N", (0.8,), f"{_RANGE}/states_mu_0.2@contact.stiffness_ratio"),
    Row(8, "(a) to (c)", "F_ext, mg", (), f"{_RANGE}/states_mu_0.2:force", "on the plots only"),
    Row(9, "(a) to (c)", "µ", (1.0,), f"{_RANGE}/response:friction"),
    Row(9, "(a) to (c)", "µ_wall", (0.0,), f"{_RANGE}/states_mu_1@wall.friction"),
    Row(9, "(a) to (c)", "k_T/k_N", (0.8,), f"{_RANGE}/states_mu_1@contact.stiffness_ratio"),
    Row(9, "(a) to (c)", "F_ext, mg", (), f"{_RANGE}/states_mu_1:force", "on the plots only"),
    Row(10, "all", "µ", (10.0,), f"{_RATIO}/response@contact.friction"),
    Row(10, "all", "F_ext, mg", (15.0,), f"{_RATIO}/response:force"),
    Row(10, "all", "k_T/k_N at the crossover (Sec. V.B)", (0.3,), f"{_RATIO}/response:stiffness_ratio"),
    Row(10, "all", "µ_wall", (), f"{_RATIO}/response@wall.friction", "not stated; as in Figs. 6 to 9"),
    Row(12, "all", "k_T/k_N", (0.8,), f"{_RANGE}/friction_axis@contact.stiffness_ratio"),
    Row(12, "all", "F_ext, mg", (15.0,), f"{_RANGE}/friction_axis:force"),
    Row(12, "all", "µ_wall", (), f"{_RANGE}/friction_axis@wall.friction", "not stated; as in Figs. 6 to 9"),
    Row(13, "all", "µ = µ_wall (Sec. V.D)", (1.0,), f"{_FIELDS}/forces:friction"),
    Row(13, "all", "k_T/k_N", (0.8,), f"{_FIELDS}/forces@contact.stiffness_ratio"),
    Row(13, "all", "F_ext, mg", (15.0,), f"{_FIELDS}/forces:force"),
    Row(14, "all", "w, R", (2.0,), f"{_FIELDS}/stress:stress_width"),
    Row(14, "all", "F_ext, mg", (15.0,), f"{_FIELDS}/stress:force"),
    Row(14, "all", "µ = µ_wall (Sec. V.D)", (1.0,), f"{_FIELDS}/stress:friction"),
    Row(15, "(a), (b)", "F_ext, mg", (150.0,), f"{_FIELDS}/profiles:force"),
    Row(15, "(a) 0, (b) 1", "µ = µ_wall", (0.0, 1.0), f"{_FIELDS}/profiles:friction"),
    Row(15, "(b)", "k_T/k_N", (0.8,), f"{_FIELDS}/profiles@contact.stiffness_ratio"),
    Row(16, "(a), (b)", "µ_wall", (0.0,), f"{_RANGE}/large_forces@wall.friction"),
    Row(16, "(a), (b)", "k_T/k_N", (0.8,), f"{_RANGE}/large_forces@contact.stiffness_ratio"),
    Row(16, "(a)", "F_ext, mg (Sec. V.E)", (20.0, 40.0), f"{_RANGE}/states_mu_0.2:force"),
    Row(16, "(b)", "µ (Sec. V.E)", (1.0,), f"{_RANGE}/large_forces:friction"),
    Row(16, "(b)", "F_ext, mg (Sec. V.E)", (91.0, 95.0), f"{_RANGE}/large_forces:force"),
    Row(17, "(b), (d), (f)", "µ", (0.94,), f"{_PILE}/piles@contact.friction"),
    Row(17, "(b), (d), (f)", "µ_wall", (0.35,), f"{_PILE}/piles@wall.friction"),
    Row(17, "(b), (d), (f)", "k_T/k_N", (0.5,), f"{_PILE}/piles@contact.stiffness_ratio"),
    Row(17, "(c), (d)", "w, R", (2.0,), f"{_PILE}/stress:stress_width"),
    Row(17, "all", "layers (Sec. V.F)", (11.0,), f"{_PILE}/piles@packing.layers"),
    Row(18, "(a) to (f)", "layers (Sec. V.G)", (13.0,), f"{_TORQUE}/torques@packing.layers"),
    Row(18, "(a) to (f)", "disks in a row (Sec. V.G)", (25.0,), f"{_TORQUE}/torques@packing.disks_per_row"),
    Row(18, "(a) to (f)", "δ", (1e-3,), f"{_TORQUE}/torques@packing.polydispersity"),
    Row(18, "(a) to (f)", "F_ext, mg", (10.0,), f"{_TORQUE}/torques:applied_force", of=_loads),
    Row(18, "(a) to (f)", "angle to the horizontal, degrees", (30.0,), f"{_TORQUE}/torques:applied_force",
        of=_below_horizontal),
    Row(18, "(a) to (f)", "torque, mgR", (), f"{_TORQUE}/torques:torque", "below the paper's panels only"),
    Row(18, "(a) to (f)", "µ (Sec. V.G)", (0.5,), f"{_TORQUE}/torques@contact.friction"),
    Row(18, "(a) to (f)", "µ_wall (Sec. V.G)", (0.5,), f"{_TORQUE}/torques@wall.friction"),
    Row(18, "(a) to (f)", "k_T/k_N (Sec. V.G)", (0.5,), f"{_TORQUE}/torques@contact.stiffness_ratio"),
    Row(19, "both", "δ", (0.01,), f"{_MEANS}/individual:polydispersity"),
    Row(19, "both", "µ = µ_wall", (0.0, 0.2), f"{_MEANS}/individual:friction"),
    Row(19, "both", "k_T/k_N", (0.8,), f"{_MEANS}/individual@contact.stiffness_ratio"),
    Row(19, "both", "F_ext, mg", (15.0,), f"{_MEANS}/individual:force"),
    Row(19, "both", "w, R", (3.0,), f"{_MEANS}/individual:width"),
    Row(19, "both", "realizations", (15.0,), f"{_MEANS}/individual:response",
        of=lambda response: response.shape[1]),
    Row(19, "both", "initial lattice constant, R (Sec. III.C)", (2.0,), f"{_MEANS}/ensembles:lattice_constant",
        "in (e), (f); before them one with the paper's contacts, and one in which the largest disks touch",
        of=lambda starts: [float(start) for start in starts if start != "touching-largest"]),
    Row(20, "all", "δ", (0.01,), f"{_MEANS}/linear_range:polydispersity"),
    Row(20, "all", "µ_wall", (0.0,), f"{_MEANS}/linear_range@wall.friction"),
    Row(20, "all", "k_T/k_N", (0.8,), f"{_MEANS}/linear_range@contact.stiffness_ratio"),
    Row(20, "all", "w, R", (3.0,), f"{_MEANS}/linear_range#width"),
    Row(21, "all", "δ", (0.01, 0.1, 0.25), f"{_MEANS}/averages:polydispersity"),
    Row(21, "all", "k_T/k_N", (0.8,), f"{_MEANS}/averages@contact.stiffness_ratio"),
    Row(21, "all", "w, R", (6.0,), f"{_MEANS}/averages:width"),
    Row(21, "all", "configurations of a mean", (5.0,), f"{_MEANS}/ensembles:realizations",
        "more decide more; what five would show is in the picture five_realizations"),
    Row(21, "δ = 0.1, µ = 0.2", "configurations at the largest force", (3.0,), f"{_MEANS}/ensembles:realizations",
        "more; those that collapse are left out, as in the paper"),
    Row(22, "all", "δ (Fig. 21)", (0.01, 0.1, 0.25), "phase_diagram/crossovers:polydispersity"),
    Row(22, "all", "w, R (Fig. 21)", (6.0,), "phase_diagram/crossovers:width"),
    Row(23, "all", "δ", (0.01,), f"{_TWO}/responses@packing.polydispersity"),
    Row(23, "all", "µ", (0.05,), f"{_TWO}/responses@contact.friction"),
    Row(23, "all", "µ_wall", (0.0,), f"{_TWO}/responses@wall.friction"),
    Row(23, "all", "k_T/k_N", (0.8,), f"{_TWO}/responses@contact.stiffness_ratio"),
    Row(23, "all", "F_ext, mg", (0.2,), f"{_TWO}/responses:force"),
    Row(23, "all", "d, diameters", (), f"{_TWO}/responses:distance", "on the plots only"),
    Row(24, "all", "F_ext, mg", (1.0,), f"{_TWO}/responses:force"),
    Row(24, "all", "linear up to F_ext, mg (Sec. VI)", (0.4,), f"{_TWO}/responses:force"),
)  # fmt: skip


def markdown(folder: Path) -> str:
    """Two tables from the datasets in ``folder``: parameters that are the paper's, and those with a remark.

    Equal data give equal text.

    Raises
    ------
    granular_response.store.files.StoreError
        If a dataset is missing or cannot be read.
    ValueError
        If a parameter is another one than the paper's, and no remark says why.
    """
    datasets = {group: store.read(folder / f"{group}.nc") for group in dict.fromkeys(row.group for row in ROWS)}
    same: dict[tuple[str, str], list[str]] = {}
    others = []
    for row in ROWS:
        stored = row.stored(datasets[row.group])
        paper, here, judged = _values(row.paper), _values(np.unique(stored).tolist()), _judged(row, stored)
        if judged == "yes":
            same.setdefault((str(row.figure), row.panels), []).append(f"{row.parameter}: {paper}")
        else:
            others.append((str(row.figure), row.panels, row.parameter, paper or "–", here, judged))
    agreed = [(*place, "; ".join(parameters)) for place, parameters in same.items()]
    heads = ("figure", "panels", "parameter", "paper", "here", "the same")
    return table(("figure", "panels", "as in the paper"), agreed) + "\n\n" + table(heads, others)


def _judged(row: Row, stored: NDArray[np.float64]) -> str:
    if not row.paper:
        return row.remark
    if all(np.isclose(stored, value, rtol=_SAME, atol=0.0).any() for value in row.paper):
        return f"yes; {row.remark}" if row.remark else "yes"
    if not row.remark:
        raise ValueError(f"figure {row.figure}, {row.parameter}: {_values(stored.tolist())} where the paper has "
                         f"{_values(row.paper)}, and nothing says why")  # fmt: skip
    return f"no: {row.remark}"


def _values(values: Sequence[float]) -> str:
    """All of a few, of many the ends and the number."""
    texts = [f"{value:g}" for value in values]
    return ", ".join(texts) if len(texts) <= 8 else f"{texts[0]} to {texts[-1]} ({len(texts)} values)"
