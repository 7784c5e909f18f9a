"""Claims N3b, N6, N7, N8: what the paper says about its numerics (Sec. III)."""

from __future__ import annotations

import numpy as np

from granular_response.state import FloatArray
from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.claim import Data, Numbers, needs

GROUP = "numerics"

#: The paper's time step and energy.
STEP, ENERGY = 5e-4, 1e-13


def damping(data: Data) -> Numbers:  # N6
    study = data.get(GROUP, "damping").sortby("damping_ratio")
    stable = study["beeman_limit"].values >= STEP
    time = np.where(study["settled"].values > 0, study["relaxation_time"].values, np.inf)
    half = np.isclose(study["damping_ratio"].values, 0.5)
    needs(len(time) > 4 and (half & stable & np.isfinite(time)).any(), "damping needs five ratios with 0.5")
    yield "", time[half][0] / time[stable].min()


def disorder(data: Data) -> Numbers:  # N7
    study = data.get(GROUP, "disorder")
    stopped, finished = study["stopped"].values, study["finished"].values

    def difference(picked: FloatArray, axis: int) -> FloatArray:
        """Largest difference of the means of the realizations ``picked``, per largest value of the finished one."""
        early, exact = (one[picked.astype(int)].mean(axis=axis) for one in (stopped, finished))
        return np.asarray(np.abs(early - exact).max(axis=-1) / exact.max(axis=-1))

    yield "", over_realizations(np.arange(len(stopped)), difference)


def needed(data: Data) -> Numbers:  # N8
    study = data.get(GROUP, "stop_energy").sortby("stop_kinetic_energy")
    larger = study.isel(stop_kinetic_energy=study["stop_kinetic_energy"].values > 2.0 * ENERGY)
    yield "", larger[["rest_error", "loaded_error"]].isel(stop_kinetic_energy=0).to_array().values.max()
