"""What the stress tests found, in a few numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
import xarray as xr

#: Codes of kicks, and of random scenes with a certified state.
SETTLES, NO_REST_STATE = 0, 3
CERTIFIED = 0


def numbers(datasets: Mapping[str, xr.Dataset]) -> dict[str, float]:
    """Time steps over their predicted limit, outcomes of random scenes, and the largest errors that were found.

    ``stable step`` is the largest ratio up to which every kick settles, ``unstable step`` the smallest from which none
    does: the predicted limit is to lie between them. Residuals are those of certified scenes, in mean disk weights.
    """
    maps = [study for name, study in datasets.items() if name.startswith("time_step_")]
    ratio = maps[0]["ratio"].values
    kicks = np.concatenate([study["outcome"].values.reshape(-1, ratio.size) for study in maps])
    settles, tried = kicks == SETTLES, kicks != NO_REST_STATE
    every, none = (settles | ~tried).all(axis=0), ~(settles & tried).any(axis=0)
    scenes = datasets["random_scenes"]
    certified = scenes["outcome"].values == CERTIFIED
    meanings = re.findall(r"(\d+) ([a-z ]+)", scenes["outcome"].attrs["long_name"])
    counts = {f"scenes {meaning}": float((scenes["outcome"].values == int(code)).sum()) for code, meaning in meanings}
    errors = {
        "max. unbalanced force": "force_residual",
        "max. unbalanced torque": "torque_residual",
        "max. Coulomb violation": "coulomb_excess",
    }
    return {
        "stable step": float(ratio[np.cumprod(every).astype(bool)].max(initial=0.0)),
        "unstable step": float(ratio[np.cumprod(none[::-1])[::-1].astype(bool)].min(initial=np.inf)),
        **counts,
        **{name: float(np.nanmax(scenes[key].values[certified], initial=0.0)) for name, key in errors.items()},
    }
