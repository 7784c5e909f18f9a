"""The verdicts follow from the stored data: planted data gives every kind of verdict, missing data is named."""

import json
import math
import re
from functools import reduce
from operator import or_

import numpy as np
import pytest
import xarray as xr
import yaml
from claims_data import FORCES, STARTS, STATES, dataset, everything, pile_study
from places import ROOT
from refusals import refuses
from scipy.stats import binom

from granular_response.state import OPEN, SLIDING, STICKING
from granular_response.store import files as store
from granular_response_paper.claims import declared, preparations, table
from granular_response_paper.claims.bootstrap import RARE, over_brackets, over_realizations, part_of
from granular_response_paper.claims.claim import (
    PREPARATION,
    Bound,
    Claim,
    ClaimsError,
    Data,
    NotMeasured,
    Quantity,
    Test,
    at,
    rise,
)
from granular_response_paper.claims.verdict import MEANINGS, SCHEME, Verdict, judge
from granular_response_paper.claims.words import THRESHOLDS, WORDS
from granular_response_paper.groups.frictionless_crossover.claims import size_in_steps
from granular_response_paper.groups.phase_diagram.claims import (
    FOUND,
    Crossover,
    linear_end,
    linear_ends,
    order_of,
    shorter,
    trend,
)
from granular_response_paper.registry import PAPER, collection_of, collections

#: Claims of the paper and of its extensions.
EVERY = [claim for one in collections() for claim in table.claims_in(one)]
CLAIM = {claim.id: claim for claim in EVERY}
ALGEBRA = {"F11", "K2", "K3", "S1a"}
#: Not supported in any data that support the others; and never measured.
ELSE = {"D14": "not supported", "S4a": "not measured"}
FRICTION, SLAB, PHASES = "friction_linear_range", "frictionless_crossover", "phase_diagram"
MEANS = "polydisperse_averages"
NAN = float("nan")


@pytest.fixture(scope="module")
def good():
    return everything()


@pytest.fixture(scope="module")
def entries(good):
    return judged(good)


def judged(groups):
    return [judge(claim, Data(groups)) for claim in EVERY]


def along(**values):
    """Numbers along one dimension."""
    ((dimension, numbers),) = values.items()
    return xr.DataArray(np.array(numbers), dims=dimension)


def edited(group, name, change):
    """Changes a copy of one dataset; the others are shared."""
    return lambda groups: {**groups, group: groups[group] | {name: change(groups[group][name].copy(deep=True))}}


def scaled(group, name, variable, factor):
    return edited(group, name, lambda data: data.assign({variable: data[variable] * factor}))


def both(*changes):
    return lambda groups: reduce(lambda changed, change: change(changed), changes, groups)


def put(group, name, variable, values):
    def change(data):
        old = data[variable]
        same = isinstance(values, xr.DataArray)
        new = values.broadcast_like(old).transpose(*old.dims) if same else np.broadcast_to(np.array(values), old.shape)
        return data.assign({variable: (old.dims, np.array(new))})

    return edited(group, name, change)


def put_at(group, name, values, /, **labels):
    """New values of variables, at the entries with these labels alone."""

    def change(data):
        others = reduce(or_, (data[key] != label for key, label in labels.items()))
        assert not others.all()
        return data.assign({variable: data[variable].where(others, value) for variable, value in values.items()})

    return edited(group, name, change)


def moved(group, event, friction, low, high):
    """An event at another force."""
    labels = {} if np.isnan(friction) else {"friction": friction}
    return put_at(group, "events", {"low": low, "high": high}, name=event, **labels)


def prepared(name, friction, low, high, gravity="slow", damping=0.5):
    """An event at another force in the slabs to which gravity came in this way."""
    labels = {"name": name, "friction": friction, "gravity": gravity, "damping_ratio": damping}
    return put_at("preparation", "events", {"low": low, "high": high}, **labels)


def start(group, name, variable, which, value):
    """A new value for the cases of one start."""
    return put_at(group, name, {variable: value}, lattice_constant=which)


def two_hundred_ends(nonlinear_from):
    """Linear ranges of two hundred packings."""
    ends = np.broadcast_to(np.asarray(nonlinear_from), 200)
    study = dataset(
        linear_until=("realization", 0.9 * np.nan_to_num(ends, nan=1.0)), nonlinear_from=("realization", ends)
    )
    return lambda groups: {**groups, "superposition": {**groups["superposition"], "linear_range": study}}


def two_hundred_errors(factor):
    """Superposition errors of two hundred packings."""

    def change(data):
        return xr.concat([data.isel(realization=[0])] * 200, "realization").map(
            lambda one: one * factor if "error" in str(one.name) else one
        )

    return edited("superposition", "errors", change)


def none_collapses():
    """None of two hundred packings of each case collapses."""
    return edited(
        PHASES, "realizations",
        lambda data: xr.concat([data.isel(realization=[0])] * 200, "realization", data_vars="minimal").assign(
            collapse_force=(("case", "realization"), np.full((14, 200), np.nan))
        ).assign_coords(realizations=("case", [200] * 14)),
    )  # fmt: skip


#: The second protocol loses its symmetry at 97 to 98 mg.
LATER_WITH_A_SLOW_RAMP = both(
    put("symmetry_breaking", "brackets", "low", [91.2, 97.0]),
    put("symmetry_breaking", "brackets", "high", [92.0, 98.0]),
)
ENDS = ("low", "high")
ROLLING = "rolling_resistance"
EXPERIMENTS = "experiments"
#: The reversible range of the second case alone ends early.
IRREVERSIBLE = [[[1.0, 1.0]], [[1.0, 0.2]]]


def alternating(one, other):
    """Draws of crossover forces that are far apart, in neighbouring cases the other way round."""
    first = (np.arange(14)[:, None] + np.arange(41)) % 2 == 0
    return np.where(first, one, other)


#: Responses of two lattices that leave the linear range at once, and of disordered slabs that never do.
LONGER = [[[1, 2, 3, 4, 5, 6, 7]]] * 2 + [[[1] * 7]] * 6
#: Responses of lattices that leave it at the last force, and of disordered slabs that end within it before.
CENSORED = [[[1] * 6 + [2]] * 8] * 2 + [[[1] * 5 + [np.nan] * 2] * 8] * 6
#: Crossovers of means, and of the median realization where packings collapse.
BY_FORCE = ("crossovers", "medians")
#: Crossovers at larger forces where disorder is larger.
REVERSED = along(case=[1] * 3 + [1e-3] * 6 + [1e2] * 3 + [1, 1])
#: Draws without a crossover in every case.
INFINITE = np.full((14, 41), np.inf)
#: The more disorder, the later a range ends; and ends of disordered slabs that scatter about one force.
LATER = [[[0.0] * k + [1.0] * (7 - k)] for k in (1, 1, 2, 2, 4, 4, 6, 6)]
ANYWHERE = np.concatenate(
    [
        np.where(np.arange(7) < 6, 0.0, 1.0) + np.zeros((2, 8, 1)),
        np.random.default_rng(1).uniform(0.5, 2.0, (6, 8, 1)) * np.geomspace(1e-3, 1.0, 7),
    ]
)

#: The literal start renamed to one wider than the largest disks need, with deep dips in all means of both slabs.
WIDER = (
    put(PHASES, "starts", "lattice_constant", [STARTS[0]] * 12 + ["2.5"] * 2),
    start(PHASES, "starts", "dip_of_means_interval", "2.5", 1.0),
)

#: Anisotropy that grows again with friction, by both measures.
AGAIN = (
    put(FRICTION, "friction_axis", "central_dip", [0.9, 0.5, 0.6, -0.03, -0.03]),
    scaled(FRICTION, "friction_axis", "floor_response", [[1.0], [1.0], [1.0], [0.8], [1.0]]),
)
#: Every event of the first openings at another force.
EARLY = both(
    *(put_at(FRICTION, table_, {"low": 0.01, "high": 0.02}, name=name) for table_ in ("events", "events_equal_rows")
      for name in ("first_opening", "first_opening_anywhere"))
)  # fmt: skip


def everywhere(event, friction, low, high):
    """An event at another force in both geometries."""
    return both(*(
        put_at(FRICTION, name, {"low": low, "high": high}, name=event, friction=friction)
        for name in ("events", "events_equal_rows")
    ))  # fmt: skip


def sliding(where):
    """Other contacts of the column below the load slide, by their place in it and the force."""
    slides = where(np.arange(16), np.array(STATES)[:, None])
    return put(FRICTION, "states_mu_0.2", "contact_status", np.where(slides, SLIDING, STICKING))


def status(name, values):
    return put(FRICTION, name, "contact_status", values)


NOT_SEEN = "not seen"

#: For every claim a change of its data, and the verdict that must follow.
PLANTED = [
    ("A1", moved(FRICTION, "first_opening", 1.0, 1.0, 1.1), "in part"),
    ("A1", both(put(FRICTION, "response", "response_at_centre", 1.0 - FORCES * [[0.001], [0.01], [0.04]]),
                *(moved(FRICTION, event, mu, force, force) for event in ("first_opening", "linear_range")
                  for mu, force in ((0.0, 3.0), (0.2, 2.0), (1.0, 1.0)))), "not supported"),
    ("A2", AGAIN[0], "in part"),
    ("A2", AGAIN[1], "in part"),
    ("A2", both(*AGAIN), "not supported"),
    ("A3", put("friction_fields", "stress", "distance_to_lattice", [0.1, 0.2, 0.3]), "not supported"),
    ("A4", put("slab_comparison", "slabs", "distance", [0.02, 0.2, 0.03, 0.001]), "in part"),
    ("A4", put("slab_comparison", "slabs", "distance", 0.2), "not supported"),
    ("A5", put(PHASES, "linear_range", "profile_change", LATER), "not supported"),
    ("A5", put(PHASES, "linear_range", "profile_change", ANYWHERE), "cannot tell"),
    ("I1", sliding(lambda contact, force: contact > 9), "not supported"),
    ("I1", sliding(lambda contact, force: (contact > 9) & (force > 10.0)), "in part"),
    ("I2", put(FRICTION, "friction_axis", "sliding_contacts", [0, 300, 200, 250, 10]), "in part"),
    ("I2", put(FRICTION, "friction_axis", "sliding_contacts", [0, 100, 200, 300, 10]), "not supported"),
    ("F1", moved(FRICTION, "first_opening_anywhere", 0.0, 0.01, 0.02), "in part"),
    ("F1", EARLY, "not supported"),
    ("F2", EARLY, "not supported"),
    ("F2", everywhere("first_opening", 0.2, 3.9, 4.3), "in part"),
    ("F3", EARLY, "not supported"),
    ("F3", moved(FRICTION, "first_opening", 1.0, 50.0, NAN), "in part"),
    ("F4a", moved(SLAB, "crossover", 0.0, 60.0, NAN), "in part"),
    *(("F4a", both(moved(SLAB, "crossover", 0.0, force, NAN), everywhere("crossover", 0.0, force, NAN)), verdict)
      for force, verdict in ((50.0, "cannot tell"), (60.0, "not supported"))),
    *(("F4b", both(moved(SLAB, "crossover", 0.0, *ends), everywhere("crossover", 0.0, *ends)), "not supported")
      for ends in ((3.7, 3.8), (1.0, 1.1))),
    ("F5a", put(SLAB, "states", "teardrop_horizontal", [1.0, 0.9, 1.0]), "not supported"),
    ("F5b", put(SLAB, "response", "teardrop_depth", [5.0, 1.0, 12.0]), "not supported"),
    ("F6", scaled(SLAB, "regions", "teardrop_depth", [[1.0], [0.4], [1.0], [1.0]]), "not supported"),
    ("F6", scaled(SLAB, "regions", "teardrop_width", [[1.0], [0.76], [1.0], [0.76]]), "cannot tell"),
    ("F7", put(SLAB, "widths", "crossover_bracket", [3.0, 3.1]), "in part"),
    ("F7", both(*(put(SLAB, n, "crossover_bracket", [[3.0, 3.1], [1.0, 1.1]] * 2) for n in ("sizes", "widths"))),
     "not supported"),
    ("F7", both(put(SLAB, "widths", "crossover_bracket", [[3.0, 3.1], [1.0, 1.1]] * 2),
                put(SLAB, "widths", "open_at_rest", [0, 9, 0, 0])), "supported"),
    ("F8", scaled(SLAB, "stiffness", "response_at_centre", [[1, 1, 1]] * 4 + [[1.2, 1, 1]]), "in part"),
    ("F8", scaled(SLAB, "stiffness", "response_at_centre", [[1.0]] * 4 + [[1.2]]), "not supported"),
    ("F9", scaled(SLAB, "stiffness", "teardrop_depth", [[1.0]] * 4 + [[2.0]]), "not supported"),
    ("F10", scaled(SLAB, "stiffness", "crossover_bracket", [[2.0]] * 4 + [[1.0]]), "in part"),
    ("F10", both(*(scaled(SLAB, "stiffness", name, np.reshape([2.0] * 4 + [1.0], (5,) + (1,) * dims))
                   for name, dims in (("crossover_bracket", 1), ("crossovers", 2)))), "not supported"),
    ("F11", scaled(FRICTION, "response", "response_at_centre", 1.0 + 0.1 * np.arange(3)[:, None]), "derivation"),
    ("F11", scaled(FRICTION, "response", "response_at_centre", np.geomspace(1.0, 9.0, FORCES.size)), "not supported"),
    ("F12", put(FRICTION, "friction_axis", "opened_contacts", [110, 80, 40, 120, 0]), "in part"),
    ("F12", put(FRICTION, "friction_axis", "opened_contacts", [11, 80, 40, 70, 0]), "not supported"),
    ("F13", put("friction_fields", "stress", "stress_zz", 1.0), "not supported"),
    ("R1", moved(FRICTION, "linear_range", 1.0, 2.0, 2.1), "in part"),
    ("R1", both(moved(FRICTION, "linear_range", 1.0, 2.0, 2.1),
                scaled(FRICTION, "response", "response_at_centre", [[1], [1], [1]] - 0.1 * FORCES * [[0], [0], [1]])),
     "not supported"),
    ("R1", moved(FRICTION, "linear_range", 0.0, 0.2, 0.9), "in part"),
    ("R2a", moved(FRICTION, "crossover", 1.0, 30.0, 31.0), "not supported"),
    ("R2a", moved(FRICTION, "crossover", 1.0, 40.0, NAN), "cannot tell"),
    ("R2b", put(FRICTION, "response", "half_maximum_width", 28.0), "not supported"),
    ("R3a", moved(FRICTION, "crossover", 0.2, 12.0, 12.1), "in part"),
    ("R3a", everywhere("crossover", 0.2, 12.0, 12.1), "not supported"),
    ("R3b", everywhere("reaches_floor", 0.2, 12.0, 12.1), "not supported"),
    ("R3b", everywhere("reaches_floor", 0.2, 12.0, 16.0), "cannot tell"),
    ("R4a", moved(FRICTION, "third_peak", 0.2, 80.0, NAN), "not supported"),
    ("R4b", scaled(FRICTION, "response", "third_peak_prominence", 5.0), "not supported"),
    ("R4c", sliding(lambda contact, force: (contact < 14) & (force > 0.0)), "not supported"),
    ("R5a", put("symmetry_breaking", "brackets", "high", [92.0, 97.0]), "in part"),
    ("R5a", LATER_WITH_A_SLOW_RAMP, "in part"),
    ("R5a", both(*(put("symmetry_breaking", n, end, 80.0) for n in ("brackets", "equal_rows") for end in ENDS),
                 prepared("loss_of_symmetry_path", 1.0, 80.0, 80.0, "at-once")), "not supported"),
    ("R5b", put(FRICTION, "large_forces", "asymmetry", [0.0, 0.09, 0.3, 0.6, 0.6, 0.6]), "not supported"),
    ("R6a", put(FRICTION, "large_forces", "mobilised_contacts", 10), "not supported"),
    ("R6b", put(FRICTION, "large_forces", "network_asymmetry", 0.0), "not supported"),
    ("R6c", status("large_force_states", STICKING), "not supported"),
    ("R6d", status("states_mu_1", [[STICKING] * 8, [OPEN] + [STICKING] * 7]), NOT_SEEN),
    ("R7", put(FRICTION, "large_forces", "asymmetry_sign", 1), "not supported"),
    ("R7b", put(FRICTION, "large_forces", "asymmetry", [0.0, 0.0, 1.5, 1.5, 1.2, 0.2]), "in part"),
    ("R7b", put(FRICTION, "large_forces", "asymmetry", [0.0, 0.0, 1.5, 1.5, 0.2, 0.2]), "not supported"),
    ("R8a", everywhere("reaches_floor", 1.0, 30.0, 31.0), "not supported"),
    ("R8b", moved(FRICTION, "crossover", 1.0, 9.0, 9.1), "not supported"),
    ("R9", put(FRICTION, "response", "double_peaked", np.arange(FORCES.size) > [[20], [10], [5]]), "not supported"),
    ("R10", scaled(FRICTION, "response", "opened_contacts", [[1.0], [5.0], [1.0]]), "not supported"),
    ("R11", everywhere("reaches_floor", 0.2, 3.0, 3.1), "not supported"),
    ("R12", sliding(lambda contact, force: contact < np.where(force > 5.0, 13, 2)), "in part"),
    ("R12", sliding(lambda contact, force: (contact > 7) & (contact < 13)), "not supported"),
    ("R13", sliding(lambda contact, force: contact < 3), "not supported"),
    ("R14", put(FRICTION, "response", "floor_response", 1.0), "not supported"),
    ("R15", put_at("preparation", "events", {"low": 9.0, "high": 9.1}, name="linear_range", wall_friction=1.0),
     NOT_SEEN),
    ("K1a", moved("stiffness_ratio_crossover", "two_peaks_end", 10.0, 0.4, 0.41), "not supported"),
    ("K1b", scaled("stiffness_ratio_crossover", "response", "floor_response", np.geomspace(0.1, 1, 8)[:, None]),
     "not supported"),
    ("K2", scaled("theory", "peak_criterion", "root", 1.01), "not supported"),
    ("K3", put("theory", "moduli", "error", 1e-3), "not supported"),
    ("K4", moved(FRICTION, "friction_crossover", NAN, 1.0, NAN), "cannot tell"),
    ("K4", moved(FRICTION, "friction_crossover", NAN, 3.0, NAN), "not supported"),
    ("K5", put("stiffness_ratio_crossover", "response", "sliding_contacts", 1.0), "not supported"),
    ("K6", scaled("stiffness_ratio_crossover", "elastic", "root", [1.0, 0.5]), "in part"),
    ("K6", scaled("stiffness_ratio_crossover", "elastic", "root", 0.5), "not supported"),
    ("K7", scaled(FRICTION, "friction_axis", "floor_response", 0.5), "not supported"),
    ("S1a", put("friction_fields", "stress", "misalignment", 10.0), "not supported"),
    ("S1b", scaled("friction_fields", "stress", "axis_angle", 9.0), "not supported"),
    ("S2", put("friction_fields", "stress", "distance_to_lattice", 0.6), "not supported"),
    ("S3", scaled("friction_fields", "stress", "stress_xz", 10.0), "in part"),
    ("S3", both(scaled("friction_fields", "stress", "stress_xz", 10.0),
                *(put("friction_fields", "stress", f"antisymmetric_near{kind}", 0.3) for kind in ("", "_mean"))),
     "not supported"),
    ("S4b", put("friction_fields", "profiles", "axis_magnitude", 0.9), "not supported"),
    ("P1", put("pile_dip", "stress", "dip", 0.0), "not supported"),
    ("P2", put("pile_dip", "stress", "dip", 0.05), "not supported"),
    ("P3", put("pile_dip", "piles", "central_width", 16.0), "not supported"),
    ("P3", put("pile_dip", "piles", "central_width", [16.0, 16.0, 30.0]), "in part"),
    ("P4", put("pile_dip", "glued", "floor_dip", 0.05), "not supported"),
    ("T1a", scaled("torque", "reach", "force_change", 0.1), "not supported"),
    ("T1b", put("torque", "reach", "stress_change", 0.3), "in part"),
    ("T1b", both(*(put("torque", "reach", n, 0.3) for n in ("stress_change", "antisymmetric_change")),
                 *(put("torque", "stress", f"stress_{c}", np.arange(2.0)[:, None, None] * (1 - 2 * (c == "zx")))
                   for c in ("xx", "xz", "zx", "zz"))), "not supported"),
    ("D1", put(PHASES, "starts", "dip_of_means_interval", [0.0, 0.6]), "cannot tell"),
    ("D1", start(PHASES, "starts", "dip_of_means_interval", STARTS[1], 0.0), "in part"),  # one peak in both slabs
    ("D1", put(PHASES, "starts", "dip_of_means_interval", 0.9), "not supported"),  # two in both
    ("D1", put(PHASES, "starts", "dip_of_means_interval", 0.3), "not supported"),  # peaks that are not very distinct
    ("D2", put(PHASES, "linear_range", "response_at_centre", CENSORED), "cannot tell"),
    ("D2", put(PHASES, "linear_range", "response_at_centre", LONGER), "not supported"),
    ("D3a", put(PHASES, "crossovers", "draws", alternating(0.1, 90.0)), "in part"),
    ("D3a", both(*(scaled(PHASES, n, "draws", along(case=[1, 1e-2, 1e-3] * 4 + [1, 1e-2])) for n in BY_FORCE)),
     "not supported"),
    ("D3a", both(*(put(PHASES, n, "draws", INFINITE) for n in BY_FORCE)), "cannot tell"),
    ("D3b", both(*(put(PHASES, name, "draws", alternating(0.1, 90.0)) for name in BY_FORCE)), "cannot tell"),
    ("D3b", both(*(scaled(PHASES, n, "draws", REVERSED) for n in BY_FORCE)), "not supported"),
    ("D4", put(PHASES, "shapes", "largest_step_interval", [0.6, 0.7, 0.8]), "not supported"),
    ("D4", put(PHASES, "shapes", "largest_step_interval", [0.4, 0.5, 0.8]), "cannot tell"),
    ("D5", put(PHASES, "crossovers", "seen_interval", 0.4), "not supported"),
    ("D5", put(PHASES, "crossovers", "seen_interval", [0.4, 0.6, 0.7]), "cannot tell"),
    ("D5", start(PHASES, "crossovers", "seen_interval", STARTS[1], 0.4), "in part"),
    ("D6", scaled(PHASES, "crossovers", "draws", along(case=[1] * 3 + [100] * 11)), "in part"),
    ("D6", both(*(scaled(PHASES, n, "draws", along(case=[1] * 3 + [100] * 11)) for n in BY_FORCE)), "not supported"),
    ("D7a", scaled(PHASES, "packings", "coordination_number_bulk", 1.2), "in part"),
    ("D7a", both(*(scaled(PHASES, "packings", f"coordination_number{k}", 1.2) for k in ("", "_bulk", "_with_walls"))),
     "not supported"),
    ("D7b", start(PHASES, "packings", "horizontal_contacts", STARTS[1], 0.97), "in part"),
    ("D7b", put(PHASES, "packings", "horizontal_contacts", 0.97), "not supported"),
    ("D8", put(PHASES, "crossovers", "draws", alternating(1.0, 4.0)), "cannot tell"),
    ("D8", put(PHASES, "crossovers", "draws", along(case=[1.0] * 12 + [0.1] * 2)), "not supported"),
    ("D9", scaled(PHASES, "realizations", "difference", 5.0), "not supported"),
    ("D10", put(PHASES, "shapes", "spread_interval", [0.001, 0.002, 0.003]), "cannot tell"),
    ("D10", put(PHASES, "shapes", "spread_interval", along(case=[3, 2, 1] * 4 + [1, 9])), "in part"),
    ("D10", put(PHASES, "shapes", "spread_interval", along(case=[1, 2, 1] * 4 + [1, 9])), "not supported"),
    ("D11", put(PHASES, "realizations", "shape", -0.05), "not supported"),
    ("D11", start(PHASES, "realizations", "shape", STARTS[1], -0.05), "in part"),
    ("D12", put(PHASES, "realizations", "collapse_force", NAN), "cannot tell"),  # none of eight
    ("D12", none_collapses(), "not supported"),  # none of two hundred
    ("D13", put(PHASES, "crossovers", "kind", [0] * 3 + [1] * 11), "in part"),
    ("D13", both(*(put(PHASES, n, "kind", [0] * 3 + [1] * 11) for n in BY_FORCE),
                 *(put(PHASES, n, "force", [9.0] * 3 + [0.01] * 11) for n in BY_FORCE),
                 *(put(PHASES, n, "interval", -np.inf) for n in BY_FORCE)), "not supported"),
    ("D14", scaled(PHASES, "packings", "coordination_number", 0.5), "in part"),
    ("D15", edited(MEANS, "averages", lambda data: data.assign(mean_of_few=data["mean_of_few"].roll(x=3))),
     "not supported"),
    ("D16", put(PHASES, "realizations", "collapse_force", NAN), "cannot tell"),
    ("D16", none_collapses(), NOT_SEEN),
    ("D17", put(MEANS, "packings", "contact_angle_density", 1.0), NOT_SEEN),
    ("D18", put(PHASES, "shapes", "shape_interval", -0.1), NOT_SEEN),
    ("B1", scaled("influence", "saint_venant", "exponent", along(case=[1.0] * 5 + [0.5])), "in part"),
    ("B1", scaled("influence", "saint_venant", "exponent", 0.5), "not supported"),
    ("B2", both(*(scaled("hysteresis", "events", end, IRREVERSIBLE) for end in ENDS)), "in part"),
    ("B2", scaled("hysteresis", "events", "low", IRREVERSIBLE), "in part"),
    ("B2", both(*(scaled("hysteresis", "events", end, [[[1.0, 0.2]]]) for end in ENDS)), "not supported"),
    ("B2", put("hysteresis", "events", "high", NAN), "not measured"),
    ("B3", put("hysteresis", "loops", "slid_again", 0.1), NOT_SEEN),
    ("B3", scaled("hysteresis", "loops", "floor_repeated", [[[1.0]], [[1e3]]]), "in part"),
    ("B4", scaled("moduli", "packings", "difference", 10.0), "not supported"),
    ("B4", scaled("moduli", "packings", "difference", along(case=[1.0, 10.0, 1.0])), "in part"),
    ("B4", scaled("moduli", "packings", "difference", along(solid=[1.0, 1.0, 1.0, 10.0])), "supported"),
    ("B5", scaled("moduli", "packings", "difference", along(solid=[1.0, 1.0, 1.0, 10.0])), "not supported"),
    ("B8", put("crossover_scaling", "powers", "exponent", [-0.1, -0.2, -0.05]), "not supported"),
    ("B8", put("crossover_scaling", "powers", "exponent", [0.1, -0.1, 0.2]), "cannot tell"),
    ("B9", scaled("crossover_scaling", "powers", "exponent", along(series=[0.5] + [1.0] * 6)), "in part"),
    ("B9", scaled("crossover_scaling", "powers", "exponent", 0.5), "not supported"),
    ("B11", scaled("network", "statistics", "tail_variation", 0.75), "not supported"),
    ("B11", scaled("network", "statistics", "tail_variation", [1.0, 0.7]), "in part"),
    ("B12", scaled("network", "statistics", "coordination_number", 1.2), "not supported"),
    ("B12", scaled("network", "statistics", "coordination_number", along(polydispersity=[1.2, 1.0, 1.0])), "in part"),
    ("B13", put("network", "statistics", "hyperstaticity", 0.2), "not supported"),
    ("B13", scaled("network", "statistics", "hyperstaticity", 2.0), "cannot tell"),
    ("B14", both(*(scaled(ROLLING, "thresholds", end, 0.5) for end in ENDS)), "in part"),
    ("B14", both(*(scaled(ROLLING, "thresholds", end, 0.5) for end in ENDS),
                 put(ROLLING, "thresholds", "loose_disks", 0)), "not supported"),
    ("B15", put(ROLLING, "piles", "floor_dip", 0.05), "in part"),
    ("B15", both(*(put(ROLLING, name, "floor_dip", 0.05) for name in ("piles", "thresholds"))), "not supported"),
    ("B16", put(ROLLING, "slabs", "floor_response", 0.1), NOT_SEEN),
    ("B17", both(put(ROLLING, "slabs", "length", 0.3),
                 *(put(ROLLING, "torques", n, 0.3) for n in ("length", "decay_length"))), NOT_SEEN),
    ("B17", scaled(ROLLING, "slabs", "unexplained", [1.0, 10.0]), "in part"),
    ("B18", put("preparation", "mobilized", "force", [[10.0], [9.0], [20.0], [30.0]]), "not supported"),
    ("B18", scaled("preparation", "mobilized", "force", along(case=[2.0, 1.0, 1.0, 1.0])), "not supported"),
    ("B18", scaled("preparation", "mobilized", "mobilized_part", [[1.0, 1.0]] * 3 + [[1.0, 0.1]]), "in part"),
    ("B19", put(EXPERIMENTS, "packings", "moved", 5.0), "not supported"),
    ("B20", put(EXPERIMENTS, "means", "chain", 75.0), "in part"),
    ("B20", both(*(put(EXPERIMENTS, "means", n, of) for n, of in (("chain", 75.0), ("contrast", 1.0)))),
     "not supported"),
    ("B21", put(EXPERIMENTS, "means", "vertical", 0.9), "not supported"),
    ("B22", put(EXPERIMENTS, "means", "contrast", 2.0), "not supported"),
    ("B23", put(EXPERIMENTS, "means", "power", 0.5), "not supported"),
    ("B24", put(EXPERIMENTS, "means", "power", 1.0), NOT_SEEN),
    ("B25", scaled(EXPERIMENTS, "means", "stress", np.r_[np.ones(9), 2.0][:, None, None, None]), "not supported"),
    ("B26", put(EXPERIMENTS, "means", "strongest", 60.0), "not supported"),
    ("B27", put("moduli", "slabs", "crossover", [10.0, 10.0]), "not supported"),
    ("B27", put("moduli", "slabs", "reach", [[[0.5]], [[1.0]], [[1.0]]]), "cannot tell"),
    ("B28", put("moduli", "slabs", "difference", 0.2), NOT_SEEN),
    ("B28", scaled("moduli", "slabs", "difference", [[1.0], [4.0]]), "in part"),
    ("B29", put("moduli", "slabs", "predicted_two_peaks", 1.0), NOT_SEEN),
    ("B29", put("moduli", "slabs", "predicted_two_peaks", 0.0), "in part"),
    ("U1", scaled("superposition", "errors", "floor_error_largest", 10.0), "in part"),
    ("U1", two_hundred_errors(9.0), "not supported"),
    ("U2", put("superposition", "linear_range", "nonlinear_from", 3.0), "cannot tell"),
    ("U2", two_hundred_ends(3.0), "not supported"),
    ("U2", two_hundred_ends(NAN), "not supported"),
    ("U2", two_hundred_ends(np.geomspace(0.1, 3.0, 200)), "supported"),
    ("U3", two_hundred_errors(9.0), "not supported"),
    ("U4", put("superposition", "errors", "row_error", 0.1), "not supported"),
    ("N1", scaled("numerics", "stop_energy", "loaded_error", 100.0), "in part"),
    ("N1", both(*(put("numerics", "stop_energy", n, 0.5) for n in ("loaded_error", "rest_error"))), "not supported"),
    ("N2", scaled("numerics", "restart", "kinetic_energy", 1e8), "not supported"),
    ("N3a", put("numerics", "at_rest", "sliding_contacts", 1.0), "not supported"),
    ("N3b", put("numerics", "swing", "mean_acceleration", 2e-5), "not supported"),
    ("N3b", put("numerics", "swing", "mean_acceleration", [[2e-5] * 3, [1e-6] * 3]), "in part"),
    ("N4", scaled("numerics", "time_step", "difference", 1e4), "not supported"),
    ("N5", scaled("numerics", "integrators", "difference", 1e5), "not supported"),
    ("N6", put("numerics", "damping", "relaxation_time", [12.0, 7.0, 40.0, 30.0, 20.0]), "not supported"),
    ("N7", scaled("numerics", "disorder", "stopped", 1.1), "not supported"),
    ("N7", put("numerics", "disorder", "stopped", [[1.0, 2.0, 1.0], [1.04, 2.05, 1.03]] * 6), "cannot tell"),
    ("N8", both(*(put("numerics", "stop_energy", n, 1e-3) for n in ("loaded_error", "rest_error"))), "not supported"),
    ("N9", scaled("sensitivity", "mu_1", "largest_difference", 3.0), "in part"),
    ("N9", both(*(scaled("sensitivity", f"mu_{mu}", "largest_difference", 3.0) for mu in (0.2, 1))), "not supported"),
]  # fmt: skip

#: The same in another preparation alone: what the second column must say.
VARIED = [
    ("F2", prepared("first_opening", 0.2, 1.0, 1.2), "no"),
    ("R1", prepared("linear_range", 0.2, 0.9, 1.0), "no"),
    ("R1", prepared("linear_range", 0.2, 0.9, 1.0, "at-once", 0.25), "yes"),  # other dashpots: not looked at
    ("A1", prepared("first_opening", 1.0, 1.0, 1.2), "no"),
    ("R2a", prepared("crossover", 1.0, 30.0, 31.0), "no"),
    ("R3a", prepared("crossover", 0.2, 0.0, 0.1), "no"),
    ("R3a", prepared("crossover", 0.2, 24.0, 26.0, "frictionless"), "cannot tell"),
    ("R3b", prepared("reaches_floor", 0.2, 9.0, 10.0), "no"),
    ("R4a", prepared("third_peak", 0.2, 50.0, NAN), "no"),
    ("R5a", prepared("loss_of_symmetry_path", 1.0, 400.0, NAN), "no"),
    ("R8a", prepared("reaches_floor", 0.2, 9.0, 10.0), "no"),
    ("R9", prepared("crossover", 0.2, 0.0, 0.1), "no"),
    ("R11", prepared("reaches_floor", 0.2, 4.0, 4.5), "no"),
    ("A4", put("slab_comparison", "slabs", "gravity", ["at-once"] * 2 + ["slow"] * 2), "yes"),
    ("D1", both(*WIDER), "no"),
]


def test_every_claim_has_a_text_and_stands_at_its_section():
    assert len(CLAIM) == len(EVERY)
    texts = [path for one in collections() for path in one.path.glob("*/claims.yaml")]
    assert {name for path in texts for name in yaml.safe_load(path.read_text(encoding="utf-8"))} == set(CLAIM)
    parts = [list(table.PARTS).index(claim.part) for claim in EVERY]
    assert parts == sorted(parts)
    for claim in EVERY:
        assert claim.place and claim.measured and claim.paper
        assert claim.group in table.groups_read(collection_of(claim.group))
        assert claim.paper[0].isupper() and claim.paper.rstrip('”"').endswith((".", ":")), claim.id  # whole sentences
        assert all(1 <= number <= 24 for number in claim.figures)
        assert claim.source == "paper" or claim.part == "extension", claim.id  # no hypothesis is the paper's


def test_data_that_agree_with_the_paper_support_every_claim(entries):
    assert {entry.elsewhere for entry in entries} == {"yes", "not tried"}
    expected = dict.fromkeys(CLAIM, "supported") | dict.fromkeys(ALGEBRA, "derivation") | ELSE
    assert {entry.claim.id: entry.verdict for entry in entries} == expected
    assert all("{" not in entry.here and "nan" not in entry.here for entry in entries)


def test_without_data_nothing_is_measured_and_the_reason_names_what_is_missing():
    for entry in judged({}):
        assert entry.verdict == "not measured" and not entry.tests
        assert re.match(r"data/\w+\.nc is missing|the measured profiles", entry.here), entry.claim.id


@pytest.mark.parametrize(("id_", "change", "expected"), PLANTED, ids=[f"{p[0]}-{p[2]}" for p in PLANTED])
def test_planted_data_changes_the_verdict(good, id_, change, expected):
    entry = judge(CLAIM[id_], Data(change(good)))
    assert entry.verdict == expected, (entry.here, entry.cases)


@pytest.mark.parametrize(("id_", "change", "expected"), VARIED, ids=[f"{p[0]}-{p[2]}" for p in VARIED])
def test_another_preparation_changes_the_second_column_alone(good, id_, change, expected):
    entry = judge(CLAIM[id_], Data(change(good)))
    assert (entry.verdict, entry.elsewhere) == ("supported", expected), entry.preparations
    assert ("Fails" in entry.preparations) == (expected == "no")


def test_every_claim_can_fail_and_every_verdict_comes_out():
    assert {planted[0] for planted in PLANTED} == set(CLAIM) - {"S4a"}  # which has no data
    failing = {planted[0] for planted in PLANTED if planted[2] in ("not supported", "not seen")}
    assert set(CLAIM) - failing == {"D14", "S4a"}
    assert {planted[2] for planted in PLANTED} == set(MEANINGS)


@pytest.mark.parametrize("id_", sorted(set(CLAIM)))
def test_a_missing_variable_means_not_measured(good, id_):
    """Each dataset of a claim's group loses all variables: the claim must not be judged on what is left."""
    group = CLAIM[id_].group
    bare = {name: data.drop_vars(list(data.data_vars)) for name, data in good[group].items()}
    assert judge(CLAIM[id_], Data({**good, group: bare})).verdict == "not measured"


def test_claims_of_the_paper_read_no_dataset_of_an_extension(good, entries):
    """But the summary of other preparations: the datasets of groups with extensions alone are not there."""
    extensions = {claim.group for claim in EVERY if claim.part == "extension"}
    own = {claim.group for claim in EVERY if claim.part != "extension"}
    kept = {group: sets for group, sets in good.items() if group in own or group not in extensions}
    kept[PREPARATION] = {"events": good[PREPARATION]["events"]}
    for entry in entries:
        if entry.claim.part != "extension":
            assert judge(entry.claim, Data(kept)).verdict == entry.verdict, entry.claim.id


def a_test(low, high, case="", prepared="", word=""):
    number = Quantity(0.5 * (low + high), low, high, "confidence")
    return Test("number", number, Bound(1.0, 2.0, word), case, prepared=prepared)


YES, NO, OPEN_ = (1.0, 2.0), (2.1, 3.0), (1.5, 2.5)


def cases(*ends):
    return [a_test(*one, case=str(k)) for k, one in enumerate(ends)]


def a_claim(tests=(), **said):
    return Claim("F1", "I", "", "", lambda data: tests, **said)


def verdict_of(*tests, **said):
    return Verdict(a_claim(**said), tests).verdict


def test_verdicts_follow_from_the_cases():
    assert verdict_of(*cases(YES, YES)) == "supported"
    assert {verdict_of(*cases(*ends)) for ends in ((YES, NO), (NO, OPEN_, YES), (YES, OPEN_))} == {"in part"}
    assert verdict_of(*cases(NO, NO)) == verdict_of(*cases(NO, OPEN_)) == "not supported"
    assert verdict_of(*cases(OPEN_)) == verdict_of(*cases(OPEN_, OPEN_)) == "cannot tell"
    # numbers of one case must hold together
    assert verdict_of(a_test(*YES), a_test(*NO)) == "not supported"
    assert verdict_of(a_test(*YES), a_test(*OPEN_)) == "cannot tell"
    assert verdict_of(*cases(YES), derivation=True) == "derivation"
    assert verdict_of(*cases(NO), derivation=True) == "not supported"
    assert verdict_of(*cases(NO), modal=True) == "not seen"
    for none in ([], [a_test(*YES, prepared="slowly")]):
        assert judge(a_claim(none), Data({})).verdict == "not measured"


def test_a_row_lists_its_cases_and_preparations():
    tests = [a_test(*YES, case="slow"), a_test(*NO, case="fast"), a_test(*NO, prepared="otherwise")]
    entry = judge(a_claim(tests, here="From {0} to {1}."), Data({}))
    assert entry.here == "From 1.5 (1 to 2) to 2.55 (2.1 to 3)."
    assert entry.cases == "Supported for: slow. Not supported for: fast."
    assert entry.preparations == "Fails: otherwise." and (entry.verdict, entry.elsewhere) == ("in part", "no")
    assert judge(a_claim(tests[:1]), Data({})).cases == ""


def test_a_star_marks_verdicts_that_hang_on_a_threshold():
    """Of "about", a quarter: within an eighth, a quarter and a half of 20."""

    def star(force):
        def measure(data):
            return [Test("force", Quantity.exact(force), declared.bound({"about": 20}, data.words))]

        return judge(Claim("F1", "I", "", "", measure), Data({})).star

    assert star(20.0) == star(22.0) == star(31.0) == [] and star(23.0) == star(29.0) == ["about"]


def test_a_test_needs_a_number():
    with pytest.raises(NotMeasured, match="number: no number"):
        _ = Test("number", Quantity.exact(NAN), Bound(most=1.0)).outcome


def test_strict_bounds_leave_out_their_ends():
    def outcome(low, high, strict):
        return Bound(1.0, strict=strict).outcome(Quantity(low, low, high))

    assert outcome(1.0, 2.0, False) == "yes" and outcome(1.0, 2.0, True) == "cannot tell"
    assert outcome(1.1, math.inf, True) == "yes" and outcome(0.5, 1.0, True) == "no"


def test_sampled_events_lie_at_most_a_term_below_the_papers_force():
    def outcome(low, high):
        return declared.bound({"sampled": 10}, THRESHOLDS).outcome(Quantity.bracket(low, high))

    assert outcome(7.5, 10.0) == "yes"
    assert outcome(7.4, 7.6) == outcome(9.9, 10.1) == "cannot tell"
    assert outcome(7.0, 7.4) == outcome(10.1, 10.2) == outcome(20.0, NAN) == "no"


def test_orders_use_the_smallest_step():
    up = [Quantity.bracket(1.0, 1.1), Quantity.bracket(2.0, 2.1), Quantity.bracket(3.0, NAN)]
    assert rise(up).low > 1.0 > rise(up[:2][::-1]).high
    steady = rise([*up[:2], Quantity.bracket(2.0, 2.2)])
    assert steady.low < 1.0 < steady.high


STUDY = dataset(
    {"friction": [0.0, 0.2, 1.0], "kind": ["a", "b"]},
    size=(("friction", "kind"), np.array([[1.0, 2.0], [2.0, 6.0], [4.0, 3.0]])),
    each=(("friction", "realization"), np.array([[1.0, 2.0, 3.0, 2.0]] * 3)),
    ends=(("friction", "estimate"), np.array([[2.0, 1.0, 3.0]] * 3)),
)
#: What a claims.yaml may declare, and the numbers that it must give.
DECLARED = [
    ({"value": "study.size", "at": {"friction": 0.2, "kind": "b"}}, (6.0, 6.0)),
    ({"value": "study.size", "over": {"friction": "max", "kind": "min"}}, (4.0, 4.0)),
    ({"value": "study.size", "at": {"kind": "a"}, "over": {"friction": "last"}, "per": 2}, (2.0, 2.0)),
    (
        {"value": "study.size", "at": {"kind": "a"}, "where": {"friction": [0, 0.5]}, "over": {"friction": "last"}},
        (2.0, 2.0),
    ),
    ({"value": "study.ends", "at": {"friction": 0}, "over": {"estimate": "interval"}}, (1.0, 3.0)),
    ({"value": "study.size", "rises": "friction", "at": {"kind": "a"}}, (2.0, 2.0)),
    ({"value": "study.size", "falls": "friction", "at": {"kind": "b"}}, (1 / 3, 1 / 3)),
    ({"event": "opens", "at": {"friction": 0.2}}, (1.0, 1.5)),
    ({"event": "opens", "at": {"friction": 0.2}, "per": {"event": "opens", "at": {"friction": 1}}}, (0.25, 0.5)),
    ({"event": "study_events.opens", "at": {"side": "rough"}}, (3.0, 4.0)),
    (
        {"value": "study.size", "at": {"friction": 0.2}, "unlike": {"value": "study.size", "at": {"friction": 1}}},
        (0.75, 0.75),
    ),
    ({"value": "study.size", "at": {"kind": "b"}, "over": {"friction": "average"}}, (11 / 3, 11 / 3)),
]


@pytest.mark.parametrize(("spec", "ends"), DECLARED)
def test_a_declared_test_measures_what_it_says(spec, ends):
    table_ = dataset(
        name=("event", ["opens", "opens"]),
        friction=("event", [0.2, 1.0]),
        low=("event", [1.0, 3.0]),
        high=("event", [1.5, 4.0]),
        side=("event", ["smooth", "rough"]),
    )
    data = Data({"group": {"study": STUDY, "events": table_, "study_events": table_}})
    found = declared._number("group", spec, data)
    np.testing.assert_allclose((found.low, found.high), ends)


@pytest.mark.parametrize(
    ("bound", "least", "most"),
    [
        ({"about": 20}, 15.0, 25.0), ({"sampled": 4}, 3.0, 4.0), ({"at most": "visible"}, -math.inf, 0.01),
        ({"at least": "marked"}, 0.5, math.inf), ({"lower by": "marked"}, -math.inf, 0.5),
        ({"higher by": "marked"}, 1.5, math.inf),
        ({"hardly lower by": "slightly"}, 0.75, math.inf), ({"between": [1, 2]}, 1.0, 2.0),
        ({"less than": 1}, -math.inf, 1.0), ({"same size": "similar"}, 1.0 / 1.5, 1.5),
        ({"order of magnitude": "almost"}, 5.0, 20.0), ({"about": 0.25, "plus": 4}, 4.1875, 4.3125),
        ({"at most": "about", "times": 0.02, "plus": 0.02}, -math.inf, 0.025),
    ],
)  # fmt: skip
def test_bounds_are_declared_by_terms_or_numbers(bound, least, most):
    made = declared.bound(bound, THRESHOLDS)
    assert (made.least, made.most) == pytest.approx((least, most))
    kind, *_ = bound
    assert made.strict == (kind == "less than") and bool(made.word) == (kind not in ("between", "less than"))


def test_a_bound_of_no_kind_is_refused():
    refuses(ClaimsError, "bound roughly: must be", declared.bound, {"roughly": 20}, THRESHOLDS)
    assert declared.bound({"more than": 0, "word": "visible"}, THRESHOLDS) == Bound(0.0, word="visible", strict=True)
    assert declared.bound({"at least": "rare"}, THRESHOLDS) == Bound(RARE)


def test_the_docs_name_all_that_can_be_declared():
    page = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    texts = (yaml.safe_load(path.read_text(encoding="utf-8")) for path in PAPER.path.glob("*/claims.yaml"))
    said = {key for text in texts for claim in text.values() for key in claim}
    names = {*declared._KEYS, *declared._ENDS, *declared._OVER, *said} - set(WORDS)
    assert [name for name in names if not re.search(f"`{name}[`:]", page)] == []


def test_a_function_yields_a_number_for_each_test(tmp_path, monkeypatch):
    """Which says for what case it is, what the number is of and which preparation, and may have its own bound."""
    package = tmp_path / "example_of_claims"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "claims.py").write_text(
        "from granular_response_paper.claims.claim import Bound, Case, needs\n"
        "def numbers(data, factor):\n"
        "    yield 'one', 2.0 * factor, None\n"
        "    yield Case('two', of='friction 1', prepared='slowly'), 3.0, (4.0, Bound(5.0))\n"
        "def less(data):\n"
        "    yield '', 1.0\n"
        "def lacks(data):\n"
        "    needs(False, 'no states')\n"
        "    yield '', 1.0\n"
    )
    claim = "F1: {place: I, paper: A., measured: m, %s}"
    tests = "tests: [{what: 'size, {}', unit: mg, bound: {at least: 1}}, {bound: {at most: 9}}]"

    def made(numbers):
        (package / "claims.yaml").write_text(claim % f"{tests}, numbers: {numbers}")
        return declared.read("example_of_claims")[0]

    monkeypatch.syspath_prepend(tmp_path)
    one, two, three = made("{numbers: {factor: 4}}").measure(Data({}))
    assert (one.what, one.case, one.found.value, one.unit, one.prepared) == ("size, ", "one", 8.0, "mg", "")
    assert (two.what, two.case, two.prepared) == ("size, friction 1", "two", "slowly")
    assert (three.what, three.bound) == ("m", Bound(5.0))
    refuses(ValueError, "zip", made("less").measure, Data({}))
    refuses(NotMeasured, r"^data/example_of_claims.nc: no states$", made("lacks").measure, Data({}))
    refuses(ClaimsError, "F1: numbers: more, must be a function", made, "more")
    for wrong, message in (("{bound: {}}", "needs event or value"), ("{event: a, sizes: 1}", "unknown key sizes")):
        (package / "claims.yaml").write_text(claim % f"test: {wrong}")
        refuses(ClaimsError, f"example_of_claims: F1: .*{message}", declared.read, "example_of_claims")


def test_a_number_says_its_method_and_how_many_packings_it_has(entries):
    rows = {row["id"]: row["tests"] for row in table.document(entries)["table"]}
    assert rows["F2"][0]["method"] == "both ends of the bracket" and rows["F2"][0]["samples"] == 1
    assert rows["D1"][0]["method"] == "quantile of means of 15, bootstrap" and rows["D1"][0]["samples"] == 8
    assert rows["D3a"][0]["method"] == "Kendall's tau of the draws"
    assert rows["A5"][1]["method"] == "Jonckheere's statistic, bootstrap"
    assert (rows["U2"][0]["method"], rows["U2"][0]["samples"]) == ("exact binomial interval", 8)


def test_a_path_that_ends_inside_its_linear_range_is_censored():
    """Whether such a packing has a shorter range than a lattice that leaves its own later is not known."""
    off = np.array([[0.0, 0.001, 0.002], [0.0, 0.02, 0.3], [0.0, 0.0, NAN]])
    ends = linear_ends(np.array([0.1, 1.0, 11.0]), off, 0.01)
    assert ends[0].tolist() == [11.0, np.inf] and ends[2].tolist() == [1.0, np.inf]
    assert 0.1 < ends[1, 0] == ends[1, 1] < 1.0
    lattice = np.array([41.0, 41.0])
    found = shorter(ends, lattice)  # one is shorter, two are not known: not one of three
    assert found.value == 1.0 and found.high == 1.0 and found.low == part_of([True, False, False]).low
    assert shorter(ends, np.array([0.5, 0.5])).value == part_of([True, False, False]).value  # all are known


def test_the_median_and_the_order_of_censored_ranges():
    ends = np.array([[1.0, 1.0], [2.0, 2.0], [3.0, np.inf], [3.0, np.inf], [3.0, np.inf]])
    median = linear_end(ends)
    assert median.low >= 1.0 and median.high == np.inf and math.isnan(median.value)
    short, long = np.full((4, 2), 3.3), np.tile([11.0, np.inf], (4, 1))
    assert order_of([long, short]).high == -1.0  # the longer path shows the order
    censored = np.tile([3.3, np.inf], (4, 1))
    unknown = order_of([long, censored])
    assert (unknown.low, unknown.high) == (-1.0, 1.0)  # a path to 3.3 says nothing beside one to 11


def test_the_bootstrap_knows_the_error_of_a_mean():
    values = np.random.default_rng(1).standard_normal(400)
    found = over_realizations(values, np.mean)
    assert found.kind == "confidence" and found.value == pytest.approx(values.mean())
    assert 0.5 * (found.high - found.low) == pytest.approx(1.96 * values.std() / 20.0, rel=0.1)
    assert over_realizations([*values, NAN], np.mean) == found
    refuses(NotMeasured, "2 realizations", over_realizations, [1.0, NAN, 2.0])


def test_the_interval_of_a_part_is_exact_and_open_at_its_ends():
    none, few = part_of(np.zeros(20)), part_of(np.arange(20) < 5)
    assert none.low == 0.0 and none.high == pytest.approx(1.0 - 0.025 ** (1.0 / 20.0))
    assert (few.value, few.low, few.high) == pytest.approx((0.25, 0.0866, 0.4910), abs=1e-4)
    assert part_of(np.ones(20)).high == 1.0
    refuses(NotMeasured, "no realizations", part_of, [])


#: How often a trend is seen, as docs/reproduction-notes.md says: of three crossover forces (D3b) and of four (D3a) that
#: are known to so much in their logarithm and grow by such a factor.
TREND_POWER = [
    (3, 0.1, [(1.0, 0.02), (1.25, 0.91), (1.5, 1.0), (2.0, 1.0)]),
    (3, 0.2, [(1.0, 0.02), (1.25, 0.34), (1.5, 0.80), (2.0, 1.0)]),
    (4, 0.1, [(1.0, 0.0), (1.25, 0.94), (1.5, 1.0), (2.0, 1.0)]),
    (4, 0.2, [(1.0, 0.0), (1.25, 0.31), (1.5, 0.93), (2.0, 1.0)]),
]
#: The same of three groups of so many packings (A5) whose means are so many standard deviations apart.
GROUPS = (40, 20, 20)
ORDER_POWER = [(0.0, 0.02), (0.3, 0.56), (0.5, 0.95), (0.7, 1.0)]


@pytest.mark.parametrize(
    ("cases", "scatter", "step", "power"), [(n, s, *one) for n, s, row in TREND_POWER for one in row]
)
def test_the_power_of_the_trend(cases, scatter, step, power):
    """Crossover forces that grow by ``step`` from case to case and are known to ``scatter``, 200 times."""
    rng = np.random.default_rng(0)

    def line():
        for centre in np.arange(cases) * np.log(step) + scatter * rng.standard_normal(cases):
            draws = np.exp(centre + scatter * rng.standard_normal(500))
            yield Crossover(Quantity.exact(np.exp(centre)), FOUND, np.stack([draws, draws]))

    assert np.mean([trend(list(line())).low > 0.0 for _ in range(200)]) == pytest.approx(power, abs=0.07)


@pytest.mark.parametrize(("step", "power"), ORDER_POWER)
def test_the_power_of_the_order_of_realizations(step, power):
    """Three groups, as in A5, apart by parts of their scatter: how often the order is clear."""
    rng = np.random.default_rng(0)

    def order():
        ends = [rng.standard_normal(number) - step * place for place, number in enumerate(GROUPS)]
        return order_of([np.stack([one, one], axis=-1) for one in ends], draws=200)

    assert np.mean([order().high < 0.0 for _ in range(100)]) == pytest.approx(power, abs=0.1)


#: The same of a part of so many packings that is to be above a half (D2), or not rare (U2), if it is in truth so large.
PART_POWER = [
    (20, 0.5, [(0.5, 0.02), (0.7, 0.42), (0.8, 0.80), (0.9, 0.99)]),
    (40, 0.5, [(0.5, 0.02), (0.7, 0.70), (0.8, 0.98), (0.9, 1.0)]),
    (150, 0.025, [(0.025, 0.01), (0.05, 0.34), (0.1, 0.97), (0.15, 1.0)]),
]


@pytest.mark.parametrize(("packings", "least", "powers"), PART_POWER)
def test_the_power_of_a_part(packings, least, powers):
    clear = [part_of(np.arange(packings) < hits).low > least for hits in range(packings + 1)]
    for part, power in powers:
        assert binom.pmf(np.arange(packings + 1), packings, part)[clear].sum() == pytest.approx(power, abs=0.005)


def test_what_no_packing_has_is_rare_from_146_packings_on():
    assert part_of(np.zeros(145)).high > RARE > part_of(np.zeros(146)).high


def test_the_notes_quote_the_power():
    notes = (ROOT / "docs" / "reproduction-notes.md").read_text(encoding="utf-8")
    rows = [
        f"| {cases} crossover forces, {scatter:g} | {' | '.join(f'{power:.0%}' for _, power in row)} |"
        for cases, scatter, row in TREND_POWER
    ]
    rows += [f"| {', '.join(map(str, GROUPS))} packings | {' | '.join(f'{power:.0%}' for _, power in ORDER_POWER)} |"]
    rows += [f"| {n} packings | {' | '.join(f'{power:.0%}' for _, power in row)} |" for n, _, row in PART_POWER]
    assert [row for row in rows if row.replace("%", " %") not in notes] == []


def test_an_order_counts_pairs():
    one, other = (np.stack([values] * 2, axis=1) for values in (np.array([1.0, 4.0, 2.0]), np.full(3, 9.0)))
    same = order_of([one] * 2)
    assert same.value == 0.0
    assert same.low < 0.0 < same.high
    assert order_of([one, other]) == Quantity(1.0, 1.0, 1.0, "confidence")


def test_a_size_in_whole_steps_is_known_in_the_mean():
    """However a size that grows evenly lies between its steps."""
    for start in np.linspace(0.0, 1.0, 7):
        for grown in (2.5, 4.0, 7.3):
            smooth = start + grown * (np.arange(200) + 0.5) / 200
            found = size_in_steps(np.floor(smooth), 1.0)
            assert found.low - 1e-9 <= smooth.mean() <= found.high + 1e-9


def test_what_is_not_ordered_widens_a_trend():
    one, later, bound = (
        Crossover(Quantity.bracket(low, high), FOUND, np.tile([[low], [high]], 50))
        for low, high in ((1.0, 1.0), (2.0, 2.0), (1.5, np.inf))
    )
    assert (trend([one, later]).low, trend([later, one]).high) == (1.0, -1.0)
    assert (trend([one, bound]).low, trend([later, bound]).low, trend([later, bound]).high) == (1.0, -1.0, 1.0)


def test_a_median_of_brackets_holds_what_is_not_known_of_each():
    middle = np.random.default_rng(1).uniform(1.0, 2.0, 40)
    sharp = over_brackets([Quantity.exact(value) for value in middle])
    same = over_realizations(middle)
    assert sharp.value == same.value and (sharp.low, sharp.high) == pytest.approx((same.low, same.high), abs=0.02)
    wide = over_brackets([Quantity.bracket(value - 0.1, value + 0.1) for value in middle])
    assert (wide.value, wide.low, wide.high) == pytest.approx((sharp.value, sharp.low - 0.1, sharp.high + 0.1))
    assert wide.kind == "confidence"
    # the larger half has no upper end, so neither has the interval; a few do not matter
    order = np.sort(middle)
    open_ends = [Quantity.bracket(value, NAN if value > order[20] else value) for value in order]
    assert not over_brackets(open_ends).happens and over_brackets(open_ends).low == pytest.approx(sharp.low)
    few = [Quantity.bracket(value, NAN if value > order[-3] else value) for value in order]
    assert over_brackets(few).happens
    refuses(NotMeasured, "2 realizations", over_brackets, few[:2])


def test_every_term_is_used_and_no_other(entries):
    used = {test.bound.word for entry in entries for test in entry.tests}
    assert used - {""} == set(WORDS)


def test_labels_are_found_exactly_and_together():
    data = dataset({"stop": [1e-9, 1e-13], "kind": ("stop", ["a", "b"])}, value=("stop", [1.0, 2.0]))
    assert float(at(data, stop=1e-13, kind="b")["value"]) == 2.0
    for labels in ({"stop": 1e-11}, {"kind": "a", "stop": 1e-13}):
        refuses(NotMeasured, f"stop = {labels['stop']}", at, data, **labels)
    with pytest.raises(NotMeasured, match=r"pile_dip\.nc holds no dataset piles"):
        Data({"pile_dip": {"stress": data}}).get("pile_dip", "piles")


def test_the_stored_table_is_the_one_file_of_verdicts(tmp_path):
    store.write(tmp_path / "data" / "pile_dip.nc", pile_study())
    found = table.write(tmp_path / "claims.json", tmp_path / "data", tmp_path / "none.nc")
    stored = json.loads((tmp_path / "claims.json").read_text())
    assert stored == found == table.read(tmp_path / "claims.json")
    assert [row["id"] for row in stored["table"]] == [claim.id for claim in table.claims_in(PAPER)]
    assert stored["scheme"] == list(SCHEME)
    ordered = stored["counts"]["ordered"]
    assert ordered["supported"] == 4 and ordered["not_measured"] == sum(ordered.values()) - 4
    assert sum(sum(part.values()) for part in stored["counts"].values()) == len(stored["table"])
    row = next(row for row in stored["table"] if row["id"] == "P1")
    assert (row["verdict"], row["elsewhere"], row["value"], row["interval"]) == ("supported", "not tried", 0.07, None)
    assert row["here"] == "Without friction the stress dips by 7 % under the apex."
    assert [one["outcome"] for one in row["tests"]] == ["yes"]
    again = (tmp_path / "claims.json").read_bytes()
    table.write(tmp_path / "claims.json", tmp_path / "data", tmp_path / "none.nc")
    assert (tmp_path / "claims.json").read_bytes() == again
    damaged = ({**stored, "counts": {}}, {**stored, "table": [{"id": "P1"}]}, {**stored, "table": 3})
    for partial in (*damaged, {"counts": {}, "table": []}):
        (tmp_path / "claims.json").write_text(json.dumps(partial))
        refuses(ClaimsError, "is not a whole table of claims", table.read, tmp_path / "claims.json")


def test_the_counts_in_words(good):
    pile = put("pile_dip", "stress", "dip", 0.0)(good)["pile_dip"]
    data = Data({**{k: v for k, v in good.items() if k != "symmetry_breaking"}, "pile_dip": pile})
    entries = judged(data.groups)
    found = table.document(entries)
    ordered, disorder, extension, firm = table.quoted(found).splitlines()
    number = sum(found["counts"]["ordered"].values())
    assert ordered == (
        f"Of {number} statements on ordered slabs, piles, theory and method: {number - 3 - len(ALGEBRA)} supported, "
        f"1 not supported, {len(ALGEBRA)} derivations, 2 not measured."
    )
    beyond = sum(claim.part == "extension" for claim in EVERY)
    assert disorder.endswith("1 not supported.") and extension.endswith(f": {beyond} supported.")
    assert table.quoted(table.document([e for e in entries if e.claim.part == "extension"])) == extension
    tried = sum(row["elsewhere"] == "yes" and row["part"] != "extension" for row in found["table"])
    assert f"Under another preparation {tried} were tried: {tried} hold, 0 fail, 0 cannot be told." in firm


def other_ways(data):
    return list(preparations.along(data, lambda other: other.event(FRICTION, "crossover", friction=0.2)))


def test_the_summary_of_preparations_is_read_in_place_of_their_datasets(tmp_path, good):
    """It has the layout of the dataset ``events``, and says what it was made from."""
    store.write(tmp_path / "preparation.nc", good["preparation"], {"group": "preparation", "parameters": "ways: []"})
    path = preparations.write(tmp_path / "preparation.nc", tmp_path / "extensions" / "summary.nc")
    made = store.read_attributes(path)
    assert made["source"] == "preparation.nc" and made["parameters"] == "ways: []" and len(made["source_sha256"]) == 64
    data = table.collect(tmp_path / "none", path)
    assert other_ways(data) == other_ways(Data(good)) != []
    assert table.collect(tmp_path / "none", tmp_path / "none.nc").groups == {}
    store.write(tmp_path / "other.nc", pile_study(), {"group": "pile_dip"})
    with pytest.raises(NotMeasured, match="no events of the group preparation"):
        preparations.write(tmp_path / "other.nc", tmp_path / "summary.nc")


def test_the_readme_quotes_the_stored_table():
    """The counts in words; and verdicts in its table, by the claims that the comment before the table names."""
    found = table.read(ROOT / "figures" / "claims.json")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [line for line in table.quoted(found).splitlines() if line not in readme] == []
    named, rows = re.search(r"<!-- verdicts of figures/claims.json: (.*?) -->\n(.*?)\n\n", readme, re.DOTALL).groups()
    quoted = [line.strip("| ").split(" | ")[-1] for line in rows.splitlines()[2:]]
    verdicts = {row["id"]: row["verdict"] for row in found["table"]}
    said = {one: verdict.partition(",")[0] for one, verdict in zip(named.split(", "), quoted, strict=True)}
    assert said == {one: verdicts[one] for one in said}
