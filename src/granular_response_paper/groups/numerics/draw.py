"""The numerics of the paper have no picture: their numbers are in the claims of the group."""

from __future__ import annotations

from matplotlib.figure import Figure

from granular_response_paper.captions import Caption, Datasets

from .parameters import Parameters


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    return {}
