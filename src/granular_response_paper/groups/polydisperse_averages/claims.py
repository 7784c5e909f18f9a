"""Claims D15 and D17: means of five packings, and the directions of contacts (Sec. VI.A)."""

from __future__ import annotations

import numpy as np

from granular_response_paper.claims.claim import Data, Numbers, at
from granular_response_paper.records import alike
from granular_response_paper.survey.crossover import lean


def nearly_symmetrical(data: Data) -> Numbers:  # D15
    few = at(data.get("polydisperse_averages", "averages"), width=6.0)
    mean = few["mean_of_few"].transpose("case", "step", "x").values[few["polydispersity"].values > 0.0]
    yield "", np.nanmin(lean(mean))


def preferred_directions(data: Data) -> Numbers:
    """D17, of the first case of each polydispersity."""
    study = data.get("polydisperse_averages", "packings")
    lattice = np.radians([0.0, 60.0, 120.0, 180.0])
    near = (np.abs(study["angle"].values[:, None] - lattice) < np.radians(12.0)).any(axis=1)
    study = study.isel(case=(study["friction"].values == 0.0) & (study["polydispersity"].values > 0.0))
    for (delta,), cases in alike(study, "case", "polydispersity").items():
        density = cases["contact_angle_density"].isel(case=0).mean("realization").values
        yield f"polydispersity {delta:g}", density[near].sum() / density.sum() / near.mean()
