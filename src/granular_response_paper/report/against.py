"""The parameters of the paper's captions beside those of the stored datasets, figure by figure and panel by panel.

What the paper states is transcribed in ``stated.csv``, from each caption or from the section that speaks of the figure;
what was simulated is read from the datasets, so the table cannot say what was not done.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.scene import Scene
from granular_response.scene.lattice import TOUCHING_LARGEST
from granular_response.store import files as store

from .markdown import table


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


#: What makes the parameter, by its name in ``stated.csv``; of initial lattice constants some are words.
_OF: Mapping[str, Callable[[NDArray[Any]], Any]] = {
    "": np.ravel,
    "loads": lambda force: round(float(np.hypot(*force)), 9),
    "below_horizontal": lambda force: round(float(np.degrees(np.arctan2(-force[1], force[0]))), 9),
    "realizations": lambda response: response.shape[1],
    "numbers": lambda starts: [float(start) for start in starts if start != TOUCHING_LARGEST],
}
_HEADING, *_STATED = csv.reader(
    resources.files(__package__).joinpath("stated.csv").read_text(encoding="utf-8").splitlines(), delimiter="|"
)

#: In the order of the paper. Values that the paper gives only on its plots are not in its text.
ROWS: tuple[Row, ...] = tuple(
    Row(int(figure), panels, parameter, tuple(map(float, paper.split())), source, remark, _OF[of])
    for figure, panels, parameter, paper, source, remark, of in _STATED
)


def markdown(folder: Path) -> str:
    """Two tables from the datasets in ``folder``: parameters that are the paper's, and those with a remark.

    Raises StoreError for a dataset that cannot be read, ValueError if a parameter is another one than the paper's, and
    no remark says why.
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
    if all(np.isclose(stored, value, rtol=1e-9, atol=0.0).any() for value in row.paper):
        return f"yes; {row.remark}" if row.remark else "yes"
    if not row.remark:
        raise ValueError(f"figure {row.figure}, {row.parameter}: {_values(stored.tolist())} where the paper has "
                         f"{_values(row.paper)}, and nothing says why")  # fmt: skip
    return f"no: {row.remark}"


def _values(values: Sequence[float]) -> str:
    """All of a few, of many the ends and the number."""
    texts = [f"{value:g}" for value in values]
    return ", ".join(texts) if len(texts) <= 8 else f"{texts[0]} to {texts[-1]} ({len(texts)} values)"
