"""The verdicts follow from the stored data: planted data gives every kind of verdict, missing data is named."""

import json
import math
import re
from functools import reduce
from operator import or_
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from claims_data import FORCES, STARTS, dataset, everything, pile_study
from places import ROOT
from scipy.stats import binom

from granular_response.state import SLIDING, STICKING
from granular_response.store import files as store
from granular_response.store import generated
from granular_response_paper.claims import asked, preparations, sentences, table, words
from granular_response_paper.claims import stored as stored_table
from granular_response_paper.claims.bootstrap import over_brackets, over_realizations, part_of
from granular_response_paper.claims.claim import (
    Claim,
    Condition,
    Data,
    Finding,
    NotMeasured,
    Quantity,
    Reading,
    at,
)
from granular_response_paper.claims.verdict import MEANINGS, ROBUSTNESS_MEANINGS, judge, robustness_of, verdict_of
from granular_response_paper.groups import NAMES
from granular_response_paper.groups.frictionless_crossover.claims import size_in_steps
from granular_response_paper.groups.phase_diagram.claims import (
    FOUND,
    RARE,
    Crossover,
    evident_samples,
    order_of,
    trend,
)

CLAIM = {claim.id: claim for claim in table.CLAIMS}
ALGEBRA = {"F11", "K2", "K3", "S1a"}
#: Claims of the paper itself.
PAPERS = sum(not claim.beyond for claim in table.CLAIMS)
BEYOND = len(table.CLAIMS) - PAPERS
FRICTION, SLAB, PHASES = "friction_linear_range", "frictionless_crossover", "phase_diagram"
NAN = float("nan")
DEPENDS = "depends on the interpretation"


@pytest.fixture(scope="module")
def good():
    return everything()


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
        return data.assign({variable: (old.dims, np.broadcast_to(np.array(values), old.shape).copy())})

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


def two_peaks_at_15(variant):
    """A dip at 15 mg in a variant of the study of sensitivity."""

    def change(data):
        dip = 0.9 * np.exp(-((data["x"] / 5.0) ** 2)) * (data["variant"] == variant)
        return data.assign(floor_response=data["floor_response"] - dip)

    return edited("sensitivity", "mu_1", change)


def width_three(factor):
    """Draws at friction 1 and the smoothing w = 3 that are lower by this factor."""

    def change(data):
        lower = (data["width"] == 3.0) & (data["friction"] == 1.0)
        return data.assign(draws=data["draws"] * xr.where(lower, factor, 1.0))

    return edited(PHASES, "crossovers", change)


def sliding(where):
    """Other contacts of the column below the load slide."""
    slides = where(np.arange(8), np.arange(4)[:, None])
    return put(FRICTION, "states_mu_0.2", "contact_status", np.where(slides, SLIDING, STICKING))


def two_hundred_ends(nonlinear_from):
    """Linear ranges of two hundred packings."""
    ends = np.broadcast_to(np.asarray(nonlinear_from), 200)
    study = dataset(
        linear_until=("realization", 0.9 * np.nan_to_num(ends, nan=1.0)), nonlinear_from=("realization", ends)
    )
    return lambda groups: {**groups, "superposition": {**groups["superposition"], "linear_range": study}}


def by_case(columns):
    """Along the cases: the disorders times the frictions, then the literal start."""
    return np.array(columns)[:, None]


def by_solid(rows):
    """Along the solids, whose last dimension is the smoothing."""
    return np.array(rows)[:, None]


#: Every other disk is higher: contacts are no longer horizontal.
TILTED = edited(SLAB, "states", lambda data: data.assign(position=data["position"] + [[0.0, 0.0], [0.0, 1.2]] * 7))
#: The second protocol loses its symmetry at 97 to 98 mg.
LATER_WITH_A_SLOW_RAMP = both(
    put("symmetry_breaking", "brackets", "low", [91.2, 97.0]),
    put("symmetry_breaking", "brackets", "high", [92.0, 98.0]),
)
#: Two peaks at friction 1 and 50 mg in the slab that settled without friction.
TWO_PEAKS_WITHOUT_FRICTION_FIRST = put_at(
    "preparation", "response", {"double_peaked": 1.0}, friction=1.0, gravity="frictionless", force=50.0
)
#: The second case alone differs from its slab.
ONE_TOO_FAR = np.array([1.0, 10.0, 1.0])[:, None, None, None, None]

#: Along preparations, the first of which differs from the second; along margins, one of which turns the trend round.
FIRST_CASE_ALONE = np.array([2.0, 1.0, 1.0, 1.0])[:, None]
ONE_MARGIN = np.array([[1.0, 1.0], [1.0, 1.0], [1.0, 1.0], [1.0, 0.1]])

#: Along polydispersities, of which the first one alone differs.
FIRST_CASE = np.array([1.2, 1.0])[:, None, None, None]

ENDS = ("low", "high")
ROLLING = "rolling_resistance"
TANGENT = "tangent_moduli"
EXPERIMENTS = "experiments"
#: The reversible range of the second case alone ends early.
IRREVERSIBLE = [[[1.0, 1.0]], [[1.0, 0.2]]]


def alternating(one, other):
    """Draws of crossover forces that are far apart, in neighbouring cases the other way round."""
    first = (np.arange(14)[:, None] + np.arange(41)) % 2 == 0
    return np.where(first, one, other)


#: Responses of two lattices that leave the linear range at once, of disordered slabs that never do; and of disordered
#: slabs of which every other one never does.
LONGER = [[[1, 2, 3, 4, 5, 6, 7]]] * 2 + [[[1] * 7]] * 6
SOME = [[[1] * 4 + [2] * 3] * 8] * 2 + [[[1, 2, 3, 4, 5, 6, 7], [1] * 7] * 4] * 6
#: Crossovers of means, and of the median realization where packings collapse.
BY_FORCE = ("crossovers", "medians")
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

#: Two peaks, and visible dips at x = 0, that come the earlier the larger the friction.
TURNED = put(FRICTION, "response", "double_peaked", np.arange(143) > [[20], [10], [5]])
EARLY_DIPS = put(FRICTION, "response", "central_dip", 0.01 * (FORCES - [[11.0], [8.0], [5.0]]))

#: The region of open contacts grows again at the largest friction, at 15 mg and at all forces.
SIZES = ("opened_contacts", "teardrop_depth", "teardrop_width")
LARGER_AGAIN = [
    *(put(FRICTION, "friction_axis", name, [110, 80, 40, 70]) for name in SIZES),
    *(scaled(FRICTION, "response", name, [[1.0], [1.0], [9.0]]) for name in SIZES),
]

#: Anisotropy that grows again with friction, by both measures.
AGAIN = (
    put(FRICTION, "friction_axis", "central_dip", [0.9, 0.5, 0.6, -0.03]),
    scaled(FRICTION, "friction_axis", "floor_response", [[1.0], [1.0], [1.0], [0.8]]),
)

#: For every claim a change of its data, and the verdict that must follow.
PLANTED = [
    ("A1", moved(FRICTION, "first_opening", 1.0, 1.0, 1.1), DEPENDS),
    ("A2", put(FRICTION, "friction_axis", "central_dip", [0.9, 0.5, 0.6, -0.03]), DEPENDS),
    ("A2", scaled(FRICTION, "friction_axis", "floor_response", [[1], [1], [1], [0.8]]), DEPENDS),
    ("A2", both(*AGAIN), "contradicted"),
    ("A3", put("friction_fields", "stress", "distance_to_lattice", [0.1, 0.2, 0.3]), "contradicted"),
    ("A5", put(PHASES, "linear_range", "profile_change", LATER), "contradicted"),
    ("A5", put(PHASES, "linear_range", "profile_change", ANYWHERE), "undecided"),
    ("A4", put("slab_comparison", "slabs", "distance", [0.02, 0.2, 0.03, 0.001]), DEPENDS),
    ("F1", moved(FRICTION, "first_opening", 0.0, 2.0, 2.1), "contradicted"),
    ("F1", moved(FRICTION, "first_opening", 0.0, 50.0, NAN), "contradicted"),
    ("F2", moved(FRICTION, "first_opening", 0.2, 3.9, 4.3), "undecided"),
    ("F3", moved(FRICTION, "first_opening", 1.0, 3.0, 3.1), "contradicted"),
    ("F4a", moved(SLAB, "crossover", 0.0, 50.0, NAN), DEPENDS),
    ("F4a", both(moved(SLAB, "crossover", 0.0, 50.0, NAN), put(SLAB, "response", "central_dip", 0.0)), "undecided"),
    ("F4b", moved(SLAB, "crossover", 0.0, 3.7, 3.8), DEPENDS),
    ("F4b", both(moved(SLAB, "crossover", 0.0, 3.7, 3.8), put(SLAB, "response", "central_dip", 0.0)), "undecided"),
    ("F5a", TILTED, "contradicted"),
    ("F5b", put(SLAB, "response", "teardrop_depth", [5.0, 1.0, 12.0]), "contradicted"),
    ("F6", scaled(SLAB, "regions", "teardrop_depth", [[1.0], [0.4], [1.0], [1.0]]), "contradicted"),
    ("F6", scaled(SLAB, "regions", "teardrop_width", [[1.0], [0.76], [1.0], [0.76]]), "undecided"),
    ("F7", put(SLAB, "widths", "crossover_bracket", [3.0, 3.1]), "undecided"),
    ("F7", put(SLAB, "widths", "crossover_bracket", [[3.0, 3.1], [1.0, 1.1]] * 2), DEPENDS),
    ("F8", scaled(SLAB, "stiffness", "response_at_centre", [[1, 1, 1]] * 4 + [[1.2, 1, 1]]), DEPENDS),
    ("F8", scaled(SLAB, "stiffness", "response_at_centre", [[1.0]] * 4 + [[1.2]]), "contradicted"),
    ("F9", scaled(SLAB, "stiffness", "teardrop_depth", [[1.0]] * 4 + [[2.0]]), "contradicted"),
    ("F10", scaled(SLAB, "stiffness", "crossover_bracket", [[2.0]] + [[2.0]] * 3 + [[1.0]]), "contradicted"),
    ("F11", scaled(FRICTION, "response", "response_at_centre", 1.0 + 0.1 * np.arange(3)[:, None]), "derivation"),
    ("F11", scaled(FRICTION, "response", "response_at_centre", np.geomspace(1.0, 9.0, 143)), "contradicted"),
    ("F12", put(FRICTION, "friction_axis", "opened_contacts", [110, 80, 40, 70]), DEPENDS),
    ("F12", both(*LARGER_AGAIN[:3]), DEPENDS),
    ("F12", both(*LARGER_AGAIN), "contradicted"),
    ("R12", sliding(lambda contact, state: contact < np.array([0, 2, 8, 8])[state]), DEPENDS),
    ("R12", sliding(lambda contact, state: (contact > 3) & (state > 0)), "contradicted"),
    ("R1", moved(FRICTION, "linear_range", 1.0, 2.0, 2.1), DEPENDS),
    ("R1", moved(FRICTION, "linear_range", 0.0, 0.2, 0.9), "undecided"),
    ("R2a", put(FRICTION, "response", "double_peaked", 1), DEPENDS),
    ("R2a", two_peaks_at_15("ramp_80"), DEPENDS),
    ("R2b", put(FRICTION, "response", "half_maximum_width", 28.0), "contradicted"),
    ("R3a", moved(FRICTION, "crossover", 0.2, 12.0, 12.1), DEPENDS),
    ("R3a", put(FRICTION, "response", "central_dip", FORCES / 1e3), DEPENDS),
    ("R3a", both(moved(FRICTION, "crossover", 0.2, 12.0, 12.1), EARLY_DIPS), "contradicted"),
    ("R3b", moved(FRICTION, "reaches_floor", 0.2, 12.0, 12.1), "contradicted"),
    ("R4a", moved(FRICTION, "third_peak", 0.2, 80.0, NAN), "contradicted"),
    ("R4b", scaled(FRICTION, "response", "third_peak_prominence", 5.0), "contradicted"),
    ("R5a", put("symmetry_breaking", "brackets", "high", [92.0, 97.0]), "undecided"),
    ("R5a", LATER_WITH_A_SLOW_RAMP, DEPENDS),
    ("R5b", put(FRICTION, "large_forces", "asymmetry", [0.0, 0.09, 0.3, 0.6]), "contradicted"),
    ("R6a", put(FRICTION, "large_forces", "mobilised_contacts", 10), "contradicted"),
    ("R6b", put(FRICTION, "large_forces", "network_asymmetry", 0.0), "contradicted"),
    ("R7", put(FRICTION, "large_forces", "asymmetry_sign", 1), "contradicted"),
    ("R8a", moved(FRICTION, "reaches_floor", 1.0, 30.0, 31.0), "contradicted"),
    ("R8b", put(FRICTION, "response", "double_peaked", [[0]] * 2 + [[1]]), "contradicted"),
    ("R9", TURNED, DEPENDS),
    ("R9", both(TURNED, EARLY_DIPS), "contradicted"),
    ("R10", scaled(FRICTION, "response", "opened_contacts", [[1.0], [5.0], [1.0]]), "contradicted"),
    ("R11", moved(FRICTION, "reaches_floor", 0.2, 3.0, 3.1), "contradicted"),
    ("K1a", moved("stiffness_ratio_crossover", "two_peaks_end", 10.0, 0.4, 0.41), DEPENDS),
    (
        "K1b",
        scaled("stiffness_ratio_crossover", "response", "floor_response", np.geomspace(0.1, 1, 8)[:, None]),
        "contradicted",
    ),
    ("K2", scaled("theory", "peak_criterion", "root", 1.01), "contradicted"),
    ("K3", put("theory", "moduli", "error", 1e-3), "contradicted"),
    ("K4", moved(FRICTION, "friction_crossover", NAN, 1.0, NAN), "undecided"),
    ("K4", put(FRICTION, "friction_axis", "central_dip", -0.1), "contradicted"),
    ("K5", put("stiffness_ratio_crossover", "response", "sliding_contacts", 1.0), "contradicted"),
    ("K6", scaled("stiffness_ratio_crossover", "elastic", "root", [1.0, 0.5]), DEPENDS),
    ("S1a", put("friction_fields", "stress", "misalignment", 10.0), "contradicted"),
    ("S1b", scaled("friction_fields", "stress", "axis_angle", 9.0), "contradicted"),
    ("S2", put("friction_fields", "stress", "distance_to_lattice", 0.6), "contradicted"),
    ("S3", scaled("friction_fields", "stress", "stress_xz", 10.0), DEPENDS),
    ("S4", put("friction_fields", "profiles", "axis_magnitude", 0.9), "contradicted"),
    ("S4", put("friction_fields", "profiles", "axis_magnitude", [[0.2], [0.9]]), DEPENDS),
    ("P1", put("pile_dip", "stress", "dip", 0.0), DEPENDS),
    ("P2", put("pile_dip", "stress", "dip", 0.05), DEPENDS),
    ("P3", put("pile_dip", "piles", "central_width", 16.0), "contradicted"),
    ("P3", put("pile_dip", "piles", "central_width", [16.0, 16.0, 30.0]), DEPENDS),
    ("T1a", scaled("torque", "reach", "force_change", 0.1), "contradicted"),
    ("T1b", put("torque", "reach", "stress_change", 0.3), DEPENDS),
    ("D1", put(PHASES, "starts", "dip_of_means_interval", [0.0, 0.6]), "undecided"),
    ("D1", start(PHASES, "starts", "dip_of_means_interval", STARTS[1], 0.0), DEPENDS),  # one peak in both slabs
    ("D1", put(PHASES, "starts", "dip_of_means_interval", 0.9), "contradicted"),  # two in both
    ("D1", put(PHASES, "starts", "dip_of_means_interval", 0.3), "contradicted"),  # peaks that are not very distinct
    ("D1", put(PHASES, "starts", "dip", -0.1), "reproduced"),  # of all packings: quoted, not judged
    ("D2", put(PHASES, "linear_range", "response_at_centre", SOME), "undecided"),
    ("D2", put(PHASES, "linear_range", "response_at_centre", LONGER), "contradicted"),
    ("D3a", put(PHASES, "crossovers", "draws", alternating(0.1, 90.0)), "undecided"),
    *(("D3a", scaled(PHASES, name, "draws", by_case([1, 1, 1e-3] * 4 + [1, 1])), DEPENDS) for name in BY_FORCE),
    ("D3a", both(*(scaled(PHASES, n, "draws", by_case([1, 1, 1e-3] * 4 + [1, 1])) for n in BY_FORCE)), "contradicted"),
    ("D3b", both(*(put(PHASES, name, "draws", alternating(0.1, 90.0)) for name in BY_FORCE)), "undecided"),
    ("D3a", put(PHASES, "crossovers", "draws", INFINITE), "undecided"),
    ("D3b", put(PHASES, "crossovers", "kind", [1, 0, 0] * 4 + [0, 0]), "reproduced"),
    ("D4", put(PHASES, "shapes", "largest_step_interval", [0.6, 0.7, 0.8]), DEPENDS),
    ("D5", put(PHASES, "crossovers", "seen_interval", 0.4), "contradicted"),
    ("D5", put(PHASES, "crossovers", "seen_interval", [0.4, 0.6, 0.7]), "undecided"),
    ("D5", start(PHASES, "crossovers", "seen_interval", STARTS[1], 0.4), DEPENDS),
    ("D6", scaled(PHASES, "crossovers", "draws", by_case([1] * 3 + [100] * 11)), DEPENDS),
    ("D6", both(*(scaled(PHASES, n, "draws", by_case([1] * 3 + [100] * 11)) for n in BY_FORCE)), "contradicted"),
    ("D7a", scaled(PHASES, "packings", "coordination_number_bulk", 1.2), DEPENDS),
    ("D7a", start(PHASES, "packings", "coordination_number", STARTS[1], 4.6), DEPENDS),
    ("D7b", start(PHASES, "packings", "horizontal_contacts", STARTS[1], 0.85), DEPENDS),
    ("D8", put(PHASES, "crossovers", "draws", alternating(1.0, 4.0)), "undecided"),
    ("D9", scaled(PHASES, "realizations", "difference", 5.0), "contradicted"),
    ("D10", put(PHASES, "shapes", "spread_interval", [0.001, 0.002, 0.003]), "undecided"),
    ("D11", put(PHASES, "realizations", "shape", -0.05), "contradicted"),
    ("D11", start(PHASES, "realizations", "shape", STARTS[1], -0.05), DEPENDS),
    ("B1", scaled("influence", "saint_venant", "exponent", [[[[1.0]]], [[[0.5]]]]), DEPENDS),
    ("B1", scaled("influence", "saint_venant", "exponent", 0.5), "contradicted"),
    ("B8", put("crossover_scaling", "powers", "exponent", [-0.1, -0.2, -0.05]), "contradicted"),
    ("B8", put("crossover_scaling", "powers", "exponent", [0.1, -0.1, 0.2]), "undecided"),
    ("B9", scaled("crossover_scaling", "powers", "exponent", [[[0.5]], [[1.0]], [[1.0]]]), DEPENDS),
    ("B9", scaled("crossover_scaling", "powers", "exponent", 0.5), "contradicted"),
    ("B6", scaled("peak_width", "inside", "interval", 0.5), "contradicted"),
    ("B10", scaled("contact_law", "responses", "difference", [[1.0], [3.0]]), DEPENDS),
    ("B10", scaled("contact_law", "responses", "difference", 3.0), "contradicted"),
    ("B6", put("peak_width", "inside", "interval", [0.7, 0.8]), "undecided"),
    ("B7", scaled("peak_width", "floors", "interval", 0.5), "contradicted"),
    ("B7", put("peak_width", "floors", "interval", [0.7, 0.8]), "undecided"),
    ("B4", scaled("moduli", "packings", "difference", 10.0), "contradicted"),
    ("B4", scaled("moduli", "packings", "difference", ONE_TOO_FAR), DEPENDS),
    ("B4", scaled("moduli", "packings", "difference", ONE_TOO_FAR[::-1]), DEPENDS),
    ("B4", scaled("moduli", "packings", "difference", by_solid([1.0, 1.0, 1.0, 10.0])), "reproduced"),
    ("B5", scaled("moduli", "packings", "difference", by_solid([1.0, 1.0, 1.0, 10.0])), "contradicted"),
    ("B2", both(*(scaled("hysteresis", "events", end, IRREVERSIBLE) for end in ENDS)), DEPENDS),
    ("B2", scaled("hysteresis", "events", "low", IRREVERSIBLE), "undecided"),
    ("B2", put("hysteresis", "events", "high", NAN), "not measured"),
    ("B3", put("hysteresis", "loops", "slid_again", 0.1), "contradicted"),
    ("B3", scaled("hysteresis", "loops", "floor_repeated", [[[1.0]], [[1e3]]]), DEPENDS),
    ("B11", scaled("network", "statistics", "tail_variation", 0.75), "contradicted"),
    ("B11", scaled("network", "statistics", "tail_variation", 0.84), "undecided"),
    ("B11", scaled("network", "statistics", "tail_variation", [1.0, 0.7]), DEPENDS),
    ("B12", scaled("network", "statistics", "coordination_number", 1.2), "contradicted"),
    ("B12", scaled("network", "statistics", "coordination_number", FIRST_CASE), DEPENDS),
    ("B13", put("network", "statistics", "hyperstaticity", 0.2), "contradicted"),
    ("B18", put("preparation", "mobilized", "force", [[10.0], [9.0], [20.0], [30.0]]), "contradicted"),
    ("B18", put("preparation", "mobilized", "force", [[10.0], [9.0], [2.0], [1.0]]), "reproduced"),
    ("B18", scaled("preparation", "mobilized", "force", FIRST_CASE_ALONE), "contradicted"),
    ("B18", scaled("preparation", "mobilized", "mobilized_part", ONE_MARGIN), DEPENDS),
    ("B13", scaled("network", "statistics", "hyperstaticity", 2.0), "undecided"),
    ("B14", scaled(ROLLING, "thresholds", "low", 0.5), "undecided"),
    ("B14", both(*(scaled(ROLLING, "thresholds", end, 0.5) for end in ENDS)), "contradicted"),
    ("B15", put(ROLLING, "piles", "floor_dip", 0.05), DEPENDS),
    ("B16", put(ROLLING, "slabs", "floor_response", 0.1), "contradicted"),
    ("B17", both(put(ROLLING, "slabs", "length", 0.3), put(ROLLING, "torques", "decay_length", 0.3)), "contradicted"),
    ("B17", put(ROLLING, "torques", "length", 0.3), DEPENDS),
    ("B17", scaled(ROLLING, "slabs", "unexplained", [1.0, 10.0]), DEPENDS),
    ("B27", put(TANGENT, "slabs", "crossover", [10.0, 10.0]), "contradicted"),
    ("B27", put(TANGENT, "slabs", "reach", [[[0.5]], [[1.0]], [[1.0]]]), "undecided"),
    ("B28", put(TANGENT, "slabs", "difference", 0.2), "contradicted"),
    ("B28", scaled(TANGENT, "slabs", "difference", [[1.0], [4.0]]), "undecided"),
    ("B29", put(TANGENT, "slabs", "predicted_two_peaks", 1.0), "contradicted"),
    ("B29", put(TANGENT, "slabs", "predicted_two_peaks", 0.0), DEPENDS),
    ("B19", put(EXPERIMENTS, "packings", "moved", 5.0), "contradicted"),
    ("B20", put(EXPERIMENTS, "means", "chain", 75.0), "contradicted"),
    ("B20", put(EXPERIMENTS, "means", "contrast", [1.4, 1.3, 1.6]), "undecided"),
    ("B21", put(EXPERIMENTS, "means", "vertical", 0.9), "contradicted"),
    ("B22", put(EXPERIMENTS, "means", "contrast", 2.0), "contradicted"),
    ("B23", put(EXPERIMENTS, "means", "power", 0.5), "contradicted"),
    ("B24", put(EXPERIMENTS, "means", "power", 1.0), "contradicted"),
    ("B25", scaled(EXPERIMENTS, "means", "stress", np.r_[np.ones(9), 2.0][:, None, None, None]), "contradicted"),
    ("B26", put(EXPERIMENTS, "means", "strongest", 60.0), "contradicted"),
    ("U1", scaled("superposition", "errors", "floor_error_largest", 10.0), DEPENDS),
    ("U1", put("superposition", "errors", "contact_error_largest", 0.9), DEPENDS),
    ("U2", put("superposition", "linear_range", "nonlinear_from", 3.0), "undecided"),
    ("U2", two_hundred_ends(3.0), "contradicted"),
    ("U2", two_hundred_ends(NAN), "contradicted"),
    ("U2", two_hundred_ends(np.geomspace(0.1, 3.0, 200)), "reproduced"),
    ("U3", scaled("superposition", "errors", "floor_error_largest", 10.0), DEPENDS),
    ("U4", put("superposition", "errors", "row_error", 0.1), "contradicted"),
    ("N1", scaled("numerics", "stop_energy", "loaded_error", 100.0), DEPENDS),
    ("N2", scaled("numerics", "restart", "kinetic_energy", 1e8), "contradicted"),
    ("N3a", put("numerics", "at_rest", "sliding_contacts", 1.0), "contradicted"),
    ("N3b", put("numerics", "swing", "mean_acceleration", 2e-5), "contradicted"),
    ("N3b", put("numerics", "swing", "mean_acceleration", [[2e-5] * 3, [1e-6] * 3]), DEPENDS),
    ("N7", scaled("numerics", "disorder", "stopped", 1.1), "contradicted"),
    ("N7", put("numerics", "disorder", "stopped", [[1.0, 2.0, 1.0], [1.04, 2.05, 1.03]] * 6), "undecided"),
    ("N4", scaled("numerics", "time_step", "difference", 1e4), "contradicted"),
    ("N5", scaled("numerics", "integrators", "difference", 1e5), "contradicted"),
    ("N6", put("numerics", "damping", "relaxation_time", [120.0, 70.0, 40.0, 30.0, 20.0]), DEPENDS),
    ("N6", put("numerics", "damping", "relaxation_time", [12.0, 7.0, 40.0, 30.0, 20.0]), "contradicted"),
]  # fmt: skip


def test_every_row_of_the_list_has_one_entry_with_text():
    assert len(CLAIM) == len(table.CLAIMS)
    texts = (ROOT / "src" / "granular_response_paper" / "groups").glob("*/claims.yaml")
    assert {name for path in texts for name in yaml.safe_load(path.read_text(encoding="utf-8"))} == set(CLAIM)
    order = [claim.id[0] for claim in table.CLAIMS]
    assert order == sorted(order, key="AFRKSPTDUNB".index)
    for claim in table.CLAIMS:
        assert claim.place and claim.measured and claim.paper and claim.group in table.GROUPS
        assert all(1 <= number <= 24 for number in claim.figures)


def test_data_that_agree_with_the_paper_reproduce_every_claim(good):
    entries = table.evaluate(Data(good))
    assert {entry.robustness for entry in entries} == {"robust", "not varied"}
    verdicts = {entry.claim.id: entry.verdict for entry in entries}
    expected = dict.fromkeys(CLAIM, "reproduced")
    expected |= dict.fromkeys(ALGEBRA, "derivation")
    assert verdicts == expected


def test_without_data_nothing_is_measured_and_the_reason_names_what_is_missing():
    for entry in table.evaluate(Data({})):
        assert entry.verdict == "not measured" and entry.finding is None
        assert re.match(r"data/\w+\.nc is missing|needs \w+", entry.reason)


#: Wrong in a variant of the set-up alone, and the robustness that must follow.
VARIED = [
    ("F2", prepared("first_opening", 0.2, 1.0, 1.2), "breaks"),
    ("R1", prepared("linear_range", 0.2, 0.9, 1.0), "breaks"),
    ("R1", prepared("first_opening", 1.0, 2.0, 4.0, "frictionless"), "open"),
    ("R1", prepared("linear_range", 0.2, 0.9, 1.0, "at-once", 0.25), "robust"),  # other dashpots: no reading
    ("A1", prepared("first_opening", 1.0, 1.0, 1.2), "breaks"),
    ("A4", put("slab_comparison", "slabs", "gravity", ["at-once"] * 2 + ["slow"] * 2), "robust"),
    ("R2a", TWO_PEAKS_WITHOUT_FRICTION_FIRST, "breaks"),
    ("R2a", two_peaks_at_15("slow_gravity"), "breaks"),
    ("R3a", prepared("crossover", 0.2, 0.0, 0.1), "breaks"),
    ("R3a", prepared("crossover", 0.2, 24.0, 26.0, "frictionless"), "open"),
    ("R3b", prepared("reaches_floor", 0.2, 9.0, 10.0), "breaks"),
    ("R4a", prepared("third_peak", 0.2, 50.0, NAN), "breaks"),
    ("R5a", prepared("loss_of_symmetry_path", 1.0, 400.0, NAN), "breaks"),
    ("R8a", prepared("reaches_floor", 0.2, 9.0, 10.0), "breaks"),
    ("R9", prepared("crossover", 0.2, 0.0, 0.1), "breaks"),
    ("R11", prepared("reaches_floor", 0.2, 4.0, 4.5), "breaks"),
    ("F6", scaled(SLAB, "regions", "teardrop_depth", [[1.0], [1.0], [1.0], [0.4]]), "breaks"),
    ("F7", put(SLAB, "sizes", "crossover_bracket", [[3.0, 3.1], [6.0, 6.1], [3.0, 3.1], [1.0, 1.1]]), "breaks"),
    ("D1", both(*WIDER), "breaks"),
    ("D3a", width_three(0.001), "breaks"),
    ("B6", scaled("peak_width", "inside", "interval", [[[1.0]], [[1.6]]]), "breaks"),
]


@pytest.mark.parametrize(("id_", "change", "expected"), PLANTED, ids=[f"{p[0]}-{p[2]}" for p in PLANTED])
def test_planted_data_changes_the_verdict(good, id_, change, expected):
    # without other preparations, so that what is planted is all there is
    kept = {CLAIM[id_].group} | (set(good) - {preparations.GROUP})
    entry = judge(CLAIM[id_], Data({k: v for k, v in change(good).items() if k in kept}))
    assert (entry.verdict, bool(entry.reason)) == (expected, True), entry.reason


@pytest.mark.parametrize(("id_", "change", "expected"), VARIED, ids=[f"{p[0]}-{p[2]}" for p in VARIED])
def test_a_variant_changes_the_robustness_alone(good, id_, change, expected):
    entry = judge(CLAIM[id_], Data(change(good)))
    assert (entry.verdict, entry.robustness) == ("reproduced", expected), entry.robustness_reason
    assert entry.robustness_reason.startswith("Holds in ") and ("Breaks first" in entry.robustness_reason) == (
        expected == "breaks"
    )


def test_every_claim_can_fail_and_every_kind_comes_out():
    assert {planted[0] for planted in PLANTED} == set(CLAIM)
    kinds = {planted[2] for planted in PLANTED}
    assert kinds | {"derivation", "not measured"} == set(MEANINGS)


@pytest.mark.parametrize("id_", sorted(set(CLAIM)))
def test_a_missing_variable_means_not_measured(good, id_):
    """Each dataset of a claim's group loses all variables: the claim must not be judged on what is left."""
    group = CLAIM[id_].group
    bare = {name: data.drop_vars(list(data.data_vars)) for name, data in good[group].items()}
    assert judge(CLAIM[id_], Data({**good, group: bare})).verdict == "not measured"


def reading(low, high, name="a", change=""):
    number = Quantity(0.5 * (low + high), low, high, "confidence")
    return Reading(name, Condition("number", number, 1.0, 2.0), change=change)


def test_verdicts_follow_from_readings():
    holds, fails, open_ = reading(1.0, 2.0), reading(2.1, 3.0), reading(1.5, 2.5)
    assert verdict_of([holds, holds]) == "reproduced"
    assert verdict_of([holds], derivation=True) == "derivation"
    assert verdict_of([holds, fails]) == verdict_of([fails, open_, holds]) == DEPENDS
    assert verdict_of([fails, fails]) == verdict_of([fails], derivation=True) == "contradicted"
    assert verdict_of([holds, open_]) == verdict_of([fails, open_]) == verdict_of([open_]) == "undecided"
    for none in ([], [reading(1.0, 2.0, change="walls")]):
        with pytest.raises(ValueError, match="needs an interpretation"):
            verdict_of(none)


def test_robustness_follows_from_variants_alone():
    holds, fails = reading(1.0, 2.0), reading(2.1, 3.0)
    same, broken, open_ = (reading(*ends, change="walls") for ends in ((1.0, 2.0), (2.1, 3.0), (1.5, 2.5)))
    assert robustness_of([holds, fails]) == "not varied" and robustness_of([fails, same]) == "robust"
    assert robustness_of([holds, same, open_]) == "open" and robustness_of([holds, open_, broken]) == "breaks"
    assert verdict_of([holds, broken, open_]) == "reproduced" and verdict_of([fails, same]) == "contradicted"
    assert {robustness_of([holds]), robustness_of([same]), "breaks", "open"} == set(ROBUSTNESS_MEANINGS)
    with pytest.raises(KeyError, match="no change"):
        reading(1.0, 2.0, change="weather")


def test_what_breaks_first_is_said_in_the_order_of_the_changes():
    def measure(data, bounds):
        walls, slow = reading(3.0, 4.0, "rough", "walls"), reading(2.5, 3.0, "slow", "gravity")
        return Finding("", [reading(1.0, 2.0), walls, slow, reading(1.0, 1.5, "stiff", "stiffness")])

    entry = judge(Claim("F1", "", "", "", measure), Data({}))
    assert (entry.verdict, entry.robustness) == ("reproduced", "breaks") and entry.finding.quantity.high == 2.0
    assert entry.robustness_reason == (
        "Holds in 1 of 3; number: 1 to 4. Breaks first with another gravity: slow: number: 2.75 (2.5 to 3) "
        "(asked: 1 to 2)."
    )


def test_the_reason_names_the_readings_on_both_sides():
    def measure(data, bounds):
        return Finding("", [reading(1.0, 2.0, "slow"), reading(3.0, 4.0, "fast")], "A remark")

    entry = judge(Claim("F1", "", "", "", measure), Data({}))
    assert entry.reason == "Holds: slow. Fails: fast: number: 3.5 (3 to 4) (asked: 1 to 2). A remark."


def test_a_condition_needs_a_bound_and_a_number():
    with pytest.raises(ValueError, match="needs a bound"):
        Condition("number", Quantity.exact(1.0))
    with pytest.raises(ValueError, match="needs conditions"):
        Reading("empty")
    with pytest.raises(NotMeasured, match="no number"):
        _ = Condition("number", Quantity.exact(NAN), most=1.0).outcome


def test_strict_bounds_leave_out_their_ends():
    def outcome(low, high, strict):
        return Condition("number", Quantity(low, low, high), 1.0, strict=strict).outcome

    assert outcome(1.0, 2.0, False) == "holds" and outcome(1.0, 2.0, True) == "open"
    assert outcome(1.1, math.inf, True) == "holds" and outcome(0.5, 1.0, True) == "fails"


def test_sampled_events_lie_at_most_a_word_below_the_papers_force():
    def outcome(low, high):
        return asked.sampled("event", Quantity.bracket(low, high), 10.0, words.bounds()).outcome

    assert outcome(7.5, 10.0) == "holds"
    assert outcome(7.4, 7.6) == outcome(9.9, 10.1) == "open"
    assert outcome(7.0, 7.4) == outcome(10.1, 10.2) == outcome(20.0, NAN) == "fails"


def test_orders_use_the_smallest_step():
    up = [Quantity.bracket(1.0, 1.1), Quantity.bracket(2.0, 2.1), Quantity.bracket(3.0, NAN)]
    assert asked.rises("force", up).outcome == "holds" and asked.rises("force", up[:2][::-1]).outcome == "fails"
    assert asked.rises("force", [*up[:2], Quantity.bracket(2.0, 2.2)]).outcome == "open"


def test_a_visible_dip_is_bracketed_from_either_side(good):
    axis = dataset({"friction": [0.0, 0.1, 0.2, 0.5]}, central_dip=("friction", [0.5, 0.02, 0.005, -0.1]))
    falling = asked.dips_from(axis.isel(friction=slice(None, None, -1)), "friction", words.bounds())
    assert (falling.low, falling.high) == (0.1, 0.2)
    response = good[FRICTION]["response"].isel(friction=0)
    grown = asked.dips_from(response, "force", words.bounds())
    assert grown.low <= 3.0 <= grown.high <= 3.2
    assert not asked.dips_from(response.isel(force=slice(0, 10)), "force", words.bounds()).happens
    with pytest.raises(NotMeasured, match="no force"):
        asked.dips_from(response.isel(force=slice(-5, None)), "force", words.bounds())


def test_a_number_says_its_test_and_how_many_packings_it_has(good):
    rows = {row["id"]: row for row in table.document(Data(good), table.evaluate(Data(good)))["table"]}
    assert all(row["tests"] and row["samples"][0] >= 1 for row in rows.values())
    assert rows["F2"]["tests"] == ["both ends of the bracket"] and rows["F2"]["samples"] == [1, 1]
    assert rows["D1"]["tests"] == ["quantile of means of 15, bootstrap"] and rows["D1"]["samples"] == [8, 8]
    assert rows["D3a"]["tests"][0] == "Kendall's tau of the draws"
    assert rows["A5"]["tests"][1] == "Jonckheere's statistic, bootstrap"
    condition = rows["U2"]["readings"][0]["conditions"][0]
    assert (condition["test"], condition["samples"]) == ("exact binomial interval", 8)


def test_the_bootstrap_knows_the_error_of_a_mean():
    values = np.random.default_rng(1).standard_normal(400)
    found = over_realizations(values, np.mean)
    assert found.kind == "confidence" and found.value == pytest.approx(values.mean())
    assert 0.5 * (found.high - found.low) == pytest.approx(1.96 * values.std() / 20.0, rel=0.1)
    assert over_realizations([*values, NAN], np.mean) == found
    with pytest.raises(NotMeasured, match="2 realizations"):
        over_realizations([1.0, NAN, 2.0])


def test_the_interval_of_a_part_is_exact_and_open_at_its_ends():
    none, few = part_of(np.zeros(20)), part_of(np.arange(20) < 5)
    assert none.low == 0.0 and none.high == pytest.approx(1.0 - 0.025 ** (1.0 / 20.0))
    assert (few.value, few.low, few.high) == pytest.approx((0.25, 0.0866, 0.4910), abs=1e-4)
    assert part_of(np.ones(20)).high == 1.0
    with pytest.raises(NotMeasured, match="no realizations"):
        part_of([])


#: How often a trend is seen, as docs/reproduction-notes.md says: of three crossover forces (D3b) and of four (D3a) that
#: are known to so much in their logarithm and grow by such a factor.
TREND_POWER = [
    (3, 0.1, [(1.0, 0.02), (1.25, 0.91), (1.5, 1.0), (2.0, 1.0)]),
    (3, 0.2, [(1.0, 0.02), (1.25, 0.34), (1.5, 0.80), (2.0, 1.0)]),
    (4, 0.1, [(1.0, 0.0), (1.25, 0.94), (1.5, 1.0), (2.0, 1.0)]),
    (4, 0.2, [(1.0, 0.0), (1.25, 0.31), (1.5, 0.93), (2.0, 1.0)]),
]
#: The same of three groups of twenty packings (A5) whose means are so many standard deviations apart.
ORDER_POWER = [(0.0, 0.02), (0.3, 0.46), (0.5, 0.86), (0.7, 0.98)]


@pytest.mark.parametrize(
    ("cases", "scatter", "step", "power"), [(n, s, *one) for n, s, row in TREND_POWER for one in row]
)
def test_the_power_of_the_trend(cases, scatter, step, power):
    """Crossover forces that grow by ``step`` from case to case and are known to ``scatter``, 200 times."""
    rng = np.random.default_rng(0)

    def line():
        for centre in np.arange(cases) * np.log(step) + scatter * rng.standard_normal(cases):
            draws = np.exp(centre + scatter * rng.standard_normal(500))
            yield Crossover(Quantity.exact(np.exp(centre)), FOUND, draws, draws)

    assert np.mean([trend(list(line())).low > 0.0 for _ in range(200)]) == pytest.approx(power, abs=0.07)


@pytest.mark.parametrize(("step", "power"), ORDER_POWER)
def test_the_power_of_the_order_of_realizations(step, power):
    """Three groups of twenty, as in A5, apart by parts of their scatter: how often the order is clear."""
    rng = np.random.default_rng(0)
    groups = rng.standard_normal((100, 3, 20)) - step * np.arange(3.0)[:, None]
    clear = np.mean([order_of(list(one), draws=200).high < 0.0 for one in groups])
    assert clear == pytest.approx(power, abs=0.1)


#: The same of a part of so many packings that is to be above a half (D2), or not rare (U2), if it is in truth so large.
PART_POWER = [
    (10, 0.5, [(0.5, 0.01), (0.7, 0.15), (0.8, 0.38), (0.9, 0.74)]),
    (20, 0.5, [(0.5, 0.02), (0.7, 0.42), (0.8, 0.80), (0.9, 0.99)]),
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
    rows += [f"| 3 x 20 packings | {' | '.join(f'{power:.0%}' for _, power in ORDER_POWER)} |"]
    rows += [f"| {n} packings | {' | '.join(f'{power:.0%}' for _, power in row)} |" for n, _, row in PART_POWER]
    assert [row for row in rows if row.replace("%", " %") not in notes] == []


def test_an_order_counts_pairs_and_ends_that_do_not_come():
    same = order_of([np.array([1.0, np.inf, 2.0])] * 2)
    assert same.value == 0.0
    assert same.low < 0.0 < same.high
    assert order_of([np.array([1.0, 2.0, 3.0]), np.full(3, np.inf)]) == Quantity(1.0, 1.0, 1.0, "confidence")


def test_a_size_in_whole_steps_is_known_in_the_mean():
    """However a size that grows evenly lies between its steps."""
    for start in np.linspace(0.0, 1.0, 7):
        for grown in (2.5, 4.0, 7.3):
            smooth = start + grown * (np.arange(200) + 0.5) / 200
            found = size_in_steps(np.floor(smooth), 1.0)
            assert found.low - 1e-9 <= smooth.mean() <= found.high + 1e-9


def test_samples_of_realizations_that_differ_or_not():
    rng = np.random.default_rng(0)
    apart, alike = rng.normal(3.0, 0.5, 60), rng.normal(0.0, 0.5, 60)
    assert evident_samples(apart, alike, 0.95).low > 0.9
    assert evident_samples(alike, alike, 0.95).high == 0.0


def test_what_is_not_ordered_widens_a_trend():
    one = Crossover(Quantity.exact(1.0), FOUND, np.ones(50), np.ones(50))
    later = Crossover(Quantity.exact(2.0), FOUND, 2.0 * one.low, 2.0 * one.low)
    bound = Crossover(Quantity.bracket(1.5, NAN), FOUND, 1.5 * one.low, np.inf * one.low)
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
    with pytest.raises(NotMeasured, match="2 realizations"):
        over_brackets(few[:2])


def test_every_word_is_used_and_no_other(good):
    used = {
        word
        for entry in table.evaluate(Data(good))
        for r in (entry.finding.readings if entry.finding else ())
        for condition in r.conditions
        for word in condition.words
    }
    assert used == set(words.WORDS)
    assert words.bounds("about", 2.0)["about"] == 2.0 * words.WORDS["about"].bound
    with pytest.raises(KeyError):
        words.bounds("roughly", 2.0)


def test_the_sensitivity_says_which_claims_move(good):
    """With the opening a fifth below the paper's force, half of "about" is too narrow."""
    data = Data(moved(FRICTION, "first_opening", 0.0, 0.6, 0.61)(good))
    entries = table.evaluate(data)
    rows = {(row["word"], row["factor"]): row for row in table.sensitivity(data, entries)}
    assert set(rows) == {(word, factor) for word in words.WORDS for factor in (0.5, 2.0)}
    assert rows["about", 0.5]["changed"]["F1"] == "contradicted" and rows["about", 0.5]["bound"] == 0.125
    assert "F1" not in rows["about", 2.0]["changed"] and "F1" not in rows["slightly", 0.5]["changed"]
    for row in rows.values():
        assert row["counts"]["reproduced"] >= PAPERS - len(ALGEBRA) - len(row["changed"])
        assert sum(row["counts"].values()) == PAPERS


def test_sentences_without_a_claim_are_looked_at_in_the_stored_data(good):
    """What is said follows the data, and what is missing is said in its place."""
    alone = sentences.looked_at(Data({}))
    assert all(re.match(r"data/\w+\.nc is missing|Not simulated", row["found"]) for row in alone)
    assert all(row["place"] and row["paper"] for row in alone)

    runs = dataset({"force": [100.0, 150.0, 500.0]}, asymmetry=("force", [1.9, 0.5, 0.25]))
    assert sentences.far_beyond(Data({FRICTION: {"large_forces": runs}})).endswith("0.50 (150 mg), 0.25 (500 mg)")
    slow = edited("numerics", "stop_energy", lambda data: data.assign(response_error=data["loaded_error"] * 0.0 + 0.02))
    assert "2.00% (1e-13)" in sentences.stopping_energy(Data(slow(good)))
    x = np.linspace(-10.0, 10.0, 21)
    lopsided = np.stack([np.exp(-(x**2)), np.exp(-((x - 1.0) ** 2))])[None, None]
    few = dataset(
        {"width": [6.0], "polydispersity": ("case", [0.1]), "friction": ("case", [0.2])},
        mean_of_few=(("width", "case", "step", "x"), lopsided),
    )
    means = Data({sentences.MEANS: {"averages": few}})
    assert "in 2 means of five, per largest response: 0% to 98%" in sentences.nearly_symmetrical(means)


def test_labels_are_found_exactly():
    data = dataset({"stop": [1e-9, 1e-13], "friction": ("stop", [0.0, 0.1])}, value=("stop", [1.0, 2.0]))
    assert float(at(data, stop=1e-13)["value"]) == 2.0
    with pytest.raises(NotMeasured, match="stop = 1e-11"):
        at(data, stop=1e-11)


def test_stored_table_and_metrics_agree(tmp_path):
    store.write(tmp_path / "data" / "pile_dip.nc", pile_study())
    found = table.write(tmp_path / "claims.json", tmp_path / "data")
    stored = json.loads((tmp_path / "claims.json").read_text())
    assert stored == found == stored_table.read(tmp_path / "claims.json")
    assert [row["id"] for row in stored["table"]] == list(CLAIM)
    others = dict.fromkeys((v.replace(" ", "_") for v in MEANINGS), 0)
    paper = {**others, "reproduced": 3, "not_measured": PAPERS - 3, "total": PAPERS}
    assert stored["counts"] == {**paper, "beyond": BEYOND}
    degrees = dict.fromkeys((kind.replace(" ", "_") for kind in ROBUSTNESS_MEANINGS), 0)
    assert stored["robustness"] == {**degrees, "not_varied": PAPERS}
    row = next(row for row in stored["table"] if row["id"] == "P1")
    assert (row["verdict"], row["robustness"], row["value"]) == ("reproduced", "not varied", 0.07)
    assert (row["interval"], row["interval_kind"]) == ([0.07, 0.08], "range")
    assert [r["outcome"] for r in row["readings"]] == ["holds", "holds"]
    again = (tmp_path / "claims.json").read_bytes()
    table.write(tmp_path / "claims.json", tmp_path / "data")
    assert (tmp_path / "claims.json").read_bytes() == again
    (tmp_path / "claims.json").write_text('{"counts": {}, "table": []}')
    with pytest.raises(stored_table.ClaimsError, match="is not a whole table of claims"):
        stored_table.read(tmp_path / "claims.json")
    for partial in ({**stored, "counts": {}}, {**stored, "table": [{"id": "P1"}]}, {**stored, "table": 3}):
        (tmp_path / "claims.json").write_text(json.dumps(partial))
        with pytest.raises(stored_table.ClaimsError, match="is not a whole table of claims"):
            stored_table.read(tmp_path / "claims.json")


def test_the_counts_in_words(good):
    pile = put("pile_dip", "stress", "dip", 0.0)(good)["pile_dip"]
    data = Data({**{k: v for k, v in good.items() if k != "symmetry_breaking"}, "pile_dip": pile})
    found = table.document(data, table.evaluate(data))
    text = stored_table.sentence(found)
    varied = sum(bool(row["robustness_reason"]) and not row["beyond"] for row in found["table"])
    assert stored_table.robustness(found) == (
        f"Of {varied} that were also measured in variants of it (gravity, walls, stiffness, lattice, smoothing): "
        f"{varied} hold in all, 0 fail in one or more, 0 are open."
    )
    judged = PAPERS - len(ALGEBRA) - 1
    beyond = sum(claim.beyond for claim in CLAIM.values())
    further = f"{beyond} more {'goes' if beyond == 1 else 'go'}"
    assert text == (
        f"Of {judged} claims of the paper that were measured in its own set-up: {judged - 1} reproduced, "
        f"1 depends on the interpretation. {len(ALGEBRA)} more are algebra that no simulation can fail. "
        f"{further} beyond what the paper measured. 1 is not measured."
    )


def test_the_readme_quotes_the_stored_table():
    stored = ROOT / "figures" / "claims.json"
    if not stored.exists():
        pytest.skip("figures/claims.json is not there yet: dvc repro claims")
    text = (ROOT / "README.md").read_text()
    found = json.loads(stored.read_text())
    assert generated.replace(text, stored_table.BLOCK, stored_table.quoted(found)) == text, "make quote"


def test_the_stages_read_every_group_of_the_pipeline():
    stages = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
    declared = {Path(d).stem for d in stages["claims"]["deps"] if d.startswith("data/")}
    assert declared == set(NAMES) & set(table.GROUPS)
    drawn = {Path(d).name for d in stages["report"]["deps"] if d.startswith("figures/")}
    assert drawn == {*NAMES, "claims.json"}


def test_datasets_without_a_group_are_named():
    data = Data({"pile_dip": {"stress": xr.Dataset()}})
    with pytest.raises(NotMeasured, match=r"pile_dip\.nc holds no dataset piles"):
        data.get("pile_dip", "piles")
