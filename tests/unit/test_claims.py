"""The verdicts follow from the stored data: perturbed data flips them, missing data is named, never made up."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

from granular_response.paper import claims
from granular_response.paper.claims.claim import Bracket, Condition, Data, NotMeasured, at, sampled_event, verdict_of
from granular_response.paper.groups import NAMES
from granular_response.paper.groups.theory import simulate as theory
from granular_response.store import files as store
from granular_response.store import generated

ROOT = Path(__file__).parents[2]
IDS = [
    *(f"F{k}" for k in range(1, 10)),
    *(f"R{k}" for k in range(1, 9)),
    *(f"K{k}" for k in range(1, 5)),
    *(f"S{k}" for k in range(1, 5)),
    *(f"P{k}" for k in range(1, 4)),
    "T1",
    *(f"D{k}" for k in range(1, 8)),
    *(f"U{k}" for k in range(1, 4)),
    *(f"N{k}" for k in range(1, 7)),
]
CLAIM = {claim.id: claim for claim in claims.CLAIMS}
FORCES = np.array([0.5, 1.0, 20.0, 50.0])
X = np.linspace(-60.0, 60.0, 61)


def dataset(coords=None, **variables):
    return xr.Dataset(
        {name: value if isinstance(value, tuple) else ((), value) for name, value in variables.items()}, coords=coords
    )


def events(*rows):
    names, frictions, low, high = zip(*rows, strict=True)
    return dataset(
        name=("event", list(names)),
        friction=("event", np.array(frictions, float)),
        low=("event", np.array(low, float)),
        high=("event", np.array(high, float)),
    )


def friction_study():
    frictions = np.array([0.0, 0.2, 1.0])
    shape = ("friction", "force")
    grid = np.ones((3, 4))
    response = dataset(
        {"friction": frictions, "force": FORCES},
        double_peaked=(shape, np.array([[0, 0, 1, 1], [0, 0, 0, 1], [0, 0, 0, 0]])),
        half_maximum_width=(shape, grid * np.array([28.0, 28.0, 25.0, 22.0])),
        peak_height=(shape, grid * 0.07),
        third_peak_prominence=(shape, 0.1 * grid),
    )
    one_side = np.where(X > 0.0, 0.08, 0.01)
    profiles = np.stack([np.exp(-((X / 20.0) ** 2)) * 0.07] * 2 + [one_side, one_side[::-1]])
    large = dataset(
        {"force": [90.0, 91.0, 93.0, 95.0], "x": ("floor_disk", X)},
        asymmetry=("force", [0.001, 0.001, 1.5, 1.5]),
        asymmetry_sign=("force", [1, 1, 1, -1]),
        network_asymmetry=("force", [0.0, 0.0, 0.02, 0.02]),
        mobilised_contacts=(("force", "margin"), np.array([[10, 20], [10, 20], [1, 2], [1, 2]])),
        floor_response=(("force", "floor_disk"), profiles),
    )
    axis = dataset({"friction": [0.0, 0.1, 0.2, 1.0]}, double_peaked=("friction", [1, 1, 0, 0]))
    table = events(
        ("first_opening", 0.0, 0.67, 0.69),
        ("first_opening", 0.2, 3.9, 3.92),
        ("first_opening", 1.0, 5.6, 5.62),
        ("linear_range", 0.0, 0.88, 0.9),
        ("linear_range", 0.2, 9.0, 9.1),
        ("linear_range", 1.0, 7.2, 7.3),
        ("crossover", 0.2, 20.1, 20.2),
        ("reaches_floor", 0.2, 19.0, 19.1),
        ("reaches_floor", 1.0, 10.9, 11.0),
        ("third_peak", 0.2, 38.0, 38.1),
        ("loss_of_symmetry", 1.0, 92.0, 93.0),
        ("friction_crossover", np.nan, 0.15, 0.16),
    )
    return {"response": response, "large_forces": large, "friction_axis": axis, "events": table}


def ratio_study():
    ratio = np.array([0.0, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0])
    return {
        "events": events(("two_peaks_end", 10.0, 0.295, 0.3), ("central_maximum_begins", 10.0, 0.31, 0.315)),
        "response": dataset(
            {"stiffness_ratio": ratio},
            response_at_centre=("stiffness_ratio", [0.01, 0.05, 0.064, 0.07, 0.075, 0.076, 0.074]),
        ),
    }


def fields_study():
    frictions = {"friction": [0.0, 0.2, 1.0]}
    return {
        "stress": dataset(
            frictions,
            misalignment=("friction", [0.1, 20.0, 30.0]),
            axis_angle=("friction", [30.0, 12.0, 3.0]),
            axis_share=("friction", [0.02, 0.09, 0.12]),
            distance_to_lattice=("friction", [0.5, 0.1, 0.04]),
            antisymmetric_near=("friction", [0.0, 0.01, 0.03]),
        ),
        "profiles": dataset(
            {"friction": [0.0, 1.0], "row": [2.5, 9.5]},
            axis_magnitude=(("friction", "row"), np.array([[0.2, 0.2], [1.0, 0.9]])),
            strongest_x=(("friction", "row"), np.array([[2.5, 9.5], [0.5, 0.5]])),
        ),
    }


def pile_study():
    cases = {"case": ["frictionless", "mirrored", "frictional"]}
    return {
        "stress": dataset(cases, dip=("case", [0.07, 0.07, 0.0])),
        "piles": dataset(
            cases,
            central_open_contacts=("case", [49.0, 49.0, 50.0]),
            central_height=("case", [14.0, 14.0, 14.0]),
            central_width=("case", [16.0, 16.0, 18.0]),
        ),
    }


def torque_study():
    dims = ("torque", "ring")
    near_only = np.array([[0.0, 0.0, 0.0], [0.5, 0.4, 0.01]])
    reach = dataset(
        {"torque": [0.0, 5.0], "ring_inner": ("ring", [0.0, 3.0, 9.0]), "ring_outer": ("ring", [3.0, 6.0, 12.0])},
        force_change=(dims, near_only),
        stress_change=(dims, near_only),
        antisymmetric_change=(dims, near_only),
    )
    return {"reach": reach}


def numerics_study():
    grid = {"friction": [0.0, 0.2], "stop_kinetic_energy": [1e-9, 1e-13]}
    errors = np.array([[0.1, 1e-3], [0.1, 1e-4]])
    dims = ("friction", "stop_kinetic_energy")
    return {
        "stop_energy": dataset(
            grid, rest_error=(dims, errors), loaded_error=(dims, errors), response_error=(dims, errors)
        ),
        "restart": dataset({"load": [0.0, 4.0]}, kinetic_energy=(("load", "reading"), np.full((2, 3), 1e-28))),
        "at_rest": dataset(network_fixed_steps=6000.0, sliding_contacts=0.0, mean_acceleration=5e-6, loose_disks=0.0),
        "time_step": dataset({"time_step": [5e-4, 2.5e-4]}, difference=("time_step", [0.0, 1e-5])),
        "integrators": dataset({"integrator": ["beeman", "gear"]}, difference=("integrator", [0.0, 1e-6])),
        "damping": dataset(
            {"damping_ratio": [0.1, 0.2, 0.5, 0.8, 1.0]},
            relaxation_time=("damping_ratio", [120.0, 70.0, 40.0, 45.0, 50.0]),
            settled=("damping_ratio", [1, 1, 1, 1, 1]),
        ),
    }


def frictionless_study():
    forces = np.array([1.0, 2.0, 4.0])
    dims = ("slab", "force")
    # a lattice of one open column: two disks in each row, one row above the other
    rows = [8, 7, 7, 6, 6, 6, 5]
    first = 2 * np.arange(len(rows))
    position = np.array(
        [p for k, row in enumerate(rows) for p in ([4.0 * k, row * 3**0.5], [4.0 * k + 2.0, row * 3**0.5])]
    )
    return {
        "events": events(("crossover", 0.0, 3.0, 3.1), ("teardrop_reaches_floor", 0.0, 3.5, 3.6)),
        "response": dataset(
            {"force": forces}, teardrop_depth=("force", [1.0, 5.0, 12.0]), reaches_floor=("force", [0, 0, 0])
        ),
        "states": dataset(
            {"force": forces},
            teardrop=(("force", "contact"), np.ones((3, len(rows)), int)),
            position=(("force", "disk", "axis"), np.stack([position] * 3)),
            contact_disk=("contact", first),
            contact_partner=("contact", first + 1),
        ),
        "sizes": dataset(
            {
                "force": forces,
                "layers": ("slab", [15, 30, 15, 30]),
                "normal_stiffness": ("slab", [3000.0, 3000.0, 1e5, 1e5]),
            },
            teardrop_depth=(dims, np.array([[5.0, 9.0, 14.0], [5.0, 8.5, 13.0]] * 2)),
            teardrop_width=(dims, np.array([[4.0, 8.0, 12.0], [4.0, 8.0, 12.0]] * 2)),
            reaches_floor=(dims, np.array([[0, 0, 1], [0, 0, 0]] * 2)),
            double_peaked=(dims, np.array([[0, 0, 1], [0, 0, 0]] * 2)),
        ),
        "stiffness": dataset(
            {"force": forces, "normal_stiffness": [500.0, 2000.0, 3000.0, 1e5]},
            response_change=("force", [0.02, 0.02, 0.025]),
            compared_stiffness=("compared", [1e3, 1e5]),
            teardrop_depth=(
                ("normal_stiffness", "force"),
                np.array([[2.0, 3.0, 5.0], [4.0, 6.0, 9.0], [4.0, 6.0, 9.0], [4.0, 6.0, 9.5]]),
            ),
            teardrop_width=(("normal_stiffness", "force"), np.full((4, 3), 4.0)),
            reaches_floor=(("normal_stiffness", "force"), np.zeros((4, 3), int)),
        ),
    }


def profile(dip):
    """A smooth response with a dip at x = 0 of about this part of its largest value; below 0 a single peak."""
    x = np.linspace(-40.0, 40.0, 81)
    narrow = np.exp(-((x / 6.0) ** 2))
    return np.exp(-((x / 20.0) ** 2)) - dip * narrow


def averages_study():
    cases = {
        "polydispersity": ("case", [0.0, 0.01, 0.01, 0.01]),
        "friction": ("case", [0.0, 0.0, 0.2, 1.0]),
        "width": [3.0, 6.0],
        "x": np.linspace(-40.0, 40.0, 81),
    }
    dims = ("width", "case", "step", "x")
    mean = np.stack(
        [[[profile(d) for d in dips] for dips in ([0, 0, 0], [-0.1, 0.6, 0.8], [-0.1, -0.1, 0.2], [-0.1, 0.1, 0.3])]]
        * 2
    )
    averages = dataset(
        cases,
        mean=(dims, mean),
        mean_of_few=(dims, mean.copy()),
        standard_error=(dims, np.full_like(mean, 1e-3)),
        count_at_rest=(("case", "step"), np.full((4, 3), 20)),
        force=(("case", "step"), np.array([[1.0, 15.0, 30.0]] * 4)),
    )
    place = np.linspace(-40.0, 40.0, 41)
    dims = ("case", "realization", "step", "slot")
    ensembles = xr.Dataset(
        {
            "x": (("case", "realization", "slot"), np.broadcast_to(place, (4, 2, 41)).copy()),
            "floor_response": (dims, np.repeat(mean[0][:, None, :, ::2], 2, axis=1)),
        }
    )
    paths = {"polydispersity": ("path", [0.01] * 3), "friction": ("path", [0.0, 0.2, 1.0])}
    packings = {"polydispersity": ("case", [0.0, 0.01]), "friction": ("case", [0.0, 0.0])}
    return {
        "averages": averages,
        "ensembles": ensembles,
        "linear_range": dataset(
            paths, linear_until=("path", [0.1, 0.5, 1.0]), nonlinear_from=("path", [0.2, 0.6, 1.1])
        ),
        "packings": dataset(
            packings,
            coordination_number=(("case", "realization"), np.array([[5.8, 5.8], [4.1, 4.1]])),
            coordination_number_bulk=(("case", "realization"), np.array([[6.0, np.nan], [4.2, 4.3]])),
        ),
    }


def phases_study():
    disorders, frictions = np.meshgrid([0.0, 0.01, 0.1, 0.25], [0.0, 0.2, 1.0], indexing="ij")
    force = np.array([[3.0, 20.0, 90.0], [2.0, 8.0, 30.0], [1.0, 5.0, 9.0], [0.5, 2.0, 4.0]]).ravel()
    interval = np.stack([0.95 * force, force, 1.05 * force], axis=-1)
    return {
        "crossovers": dataset(
            {
                "polydispersity": ("case", disorders.ravel()),
                "friction": ("case", frictions.ravel()),
                "width": [6.0],
                "level": [0.025, 0.5, 0.975],
            },
            force=(("width", "case"), force[None]),
            kind=(("width", "case"), np.where(force == 30.0, 2, 0)[None]),
            interval=(("width", "case", "level"), interval[None]),
        ),
        "shapes": dataset(
            {"polydispersity": ("case", disorders.ravel()), "width": [6.0]},
            applied_force=(("case", "step"), force[:, None] * np.array([0.25, 1.0, 4.0])),
            few_agree=(("width", "case", "step"), np.broadcast_to([1.0, 0.4, 1.0], (1, 12, 3)).copy()),
        ),
    }


def superposition_study():
    return {
        "errors": dataset(
            {"force": [0.2, 1.0], "distance": [4.0, 8.0]},
            floor_error_largest=(("realization", "distance", "force"), np.array([[[0.01, 0.05], [0.02, 0.1]]])),
        ),
        "linear_range": dataset(linear_until=("realization", [0.4, 0.3]), nonlinear_from=("realization", [0.5, 0.4])),
    }


def everything():
    """Datasets in which every claim of the paper holds."""
    return {
        "frictionless_crossover": frictionless_study(),
        "friction_linear_range": friction_study(),
        "stiffness_ratio_crossover": ratio_study(),
        "theory": theory.simulate(theory.Parameters(**yaml.safe_load((ROOT / "params.yaml").read_text())["theory"])),
        "friction_fields": fields_study(),
        "pile_dip": pile_study(),
        "torque": torque_study(),
        "polydisperse_averages": averages_study(),
        "phase_diagram": phases_study(),
        "superposition": superposition_study(),
        "numerics": numerics_study(),
    }


def verdict(id_, groups):
    return claims.judge(CLAIM[id_], Data(groups)).verdict


def test_every_row_of_the_list_has_one_entry_with_text():
    assert [claim.id for claim in claims.CLAIMS] == IDS
    for claim in claims.CLAIMS:
        assert claim.place and claim.measured and claim.paper and claim.group in claims.GROUPS
        assert all(1 <= number <= 24 for number in claim.figures)


def test_data_that_agree_with_the_paper_reproduce_every_claim():
    data = Data(everything())
    assert {e.claim.id: (e.verdict, e.reason) for e in claims.evaluate(data)} == dict.fromkeys(IDS, ("reproduced", ""))


def test_without_data_nothing_is_measured_and_the_reason_names_what_is_missing():
    for entry in claims.evaluate(Data({})):
        assert entry.verdict == "not measured" and entry.finding is None
        assert re.match(r"data/\w+\.nc is missing", entry.reason)


def scaled(group, name, variable, factor):
    def change(groups):
        data = groups[group][name].copy(deep=True)
        data[variable] = data[variable] * factor
        groups[group][name] = data

    return change


def moved(group, event, friction, low, high):
    def change(groups):
        data = groups[group]["events"].copy(deep=True)
        match = (data["name"].values == event) & (
            np.isnan(friction) | (np.abs(data["friction"].values - friction) < 1e-9)
        )
        data["low"].values[match], data["high"].values[match] = low, high
        groups[group]["events"] = data

    return change


def put(group, name, variable, values):
    def change(groups):
        data = groups[group][name].copy(deep=True)
        data[variable] = (data[variable].dims, np.broadcast_to(np.array(values), data[variable].shape).copy())
        groups[group][name] = data

    return change


def overlapping(groups):
    """A phase diagram whose intervals are all alike: nothing contradicts the order, nothing shows it."""
    put("phase_diagram", "crossovers", "kind", 0)(groups)
    put("phase_diagram", "crossovers", "interval", [0.0, 0.05, 0.1])(groups)


def tilted(groups):
    """Contacts that are no longer horizontal."""
    data = groups[SLAB]["states"].copy(deep=True)
    data["position"].values[:, 1::2, 1] += 1.2
    groups[SLAB]["states"] = data


def tilted_on_the_floor(groups):
    """The same under the largest force alone, where the region has reached the lowest row."""
    data = groups[SLAB]["states"].copy(deep=True)
    data["position"].values[-1, :, 1] -= 4.0 * 3**0.5
    data["position"].values[-1, 1::2, 1] += 1.2
    groups[SLAB]["states"] = data


FRICTION, SLAB, NAN = "friction_linear_range", "frictionless_crossover", float("nan")

#: For every claim a change of its data, and the verdict that must follow.
PERTURBED = [
    ("F1", moved(FRICTION, "first_opening", 0.0, 2.0, 2.1), "differs"),
    ("F1", moved(FRICTION, "first_opening", 0.0, 50.0, NAN), "not reproduced"),
    ("F2", moved(FRICTION, "first_opening", 0.2, 4.2, 4.3), "differs"),
    ("F3", moved(FRICTION, "first_opening", 1.0, 3.0, 3.1), "differs"),
    ("F4", moved(SLAB, "crossover", 0.0, 3.7, 3.8), "differs"),
    ("F4", moved(SLAB, "crossover", 0.0, 50.0, NAN), "not reproduced"),
    ("F5", put(SLAB, "response", "teardrop_depth", [5.0, 1.0, 12.0]), "differs"),
    ("F5", tilted, "not reproduced"),
    ("F5", tilted_on_the_floor, "differs"),
    ("F6", scaled(SLAB, "sizes", "teardrop_depth", [[1.0], [0.4], [1.0], [1.0]]), "differs"),
    ("F6", scaled(SLAB, "sizes", "teardrop_width", [[1.0], [0.1], [1.0], [0.1]]), "not reproduced"),
    ("F7", put(SLAB, "sizes", "double_peaked", 1), "not reproduced"),
    ("F8", put(SLAB, "stiffness", "response_change", [0.02, 0.02, 0.2]), "differs"),
    ("F8", put(SLAB, "stiffness", "response_change", 0.2), "not reproduced"),
    ("F9", scaled(SLAB, "stiffness", "teardrop_depth", [[1.0], [1.0], [1.0], [2.0]]), "differs"),
    ("R1", moved(FRICTION, "linear_range", 0.0, 5.0, 5.1), "not reproduced"),
    ("R1", moved(FRICTION, "linear_range", 1.0, 2.0, 2.1), "differs"),
    ("R2", put(FRICTION, "response", "double_peaked", 1), "not reproduced"),
    ("R2", put(FRICTION, "response", "half_maximum_width", 28.0), "differs"),
    ("R3", moved(FRICTION, "reaches_floor", 0.2, 12.0, 12.1), "differs"),
    ("R4", moved(FRICTION, "third_peak", 0.2, 80.0, NAN), "not reproduced"),
    ("R4", scaled(FRICTION, "response", "third_peak_prominence", 5.0), "differs"),
    ("R5", moved(FRICTION, "loss_of_symmetry", 1.0, 70.0, 71.0), "differs"),
    ("R6", put(FRICTION, "large_forces", "mobilised_contacts", 10), "differs"),
    ("R7", put(FRICTION, "large_forces", "asymmetry_sign", 1), "not reproduced"),
    ("R8", moved(FRICTION, "reaches_floor", 1.0, 30.0, 31.0), "not reproduced"),
    ("K1", moved("stiffness_ratio_crossover", "two_peaks_end", 10.0, 0.4, 0.41), "differs"),
    ("K2", scaled("theory", "peak_criterion", "root", 1.01), "not reproduced"),
    ("K3", put("theory", "moduli", "error", 1e-3), "not reproduced"),
    ("K4", put(FRICTION, "friction_axis", "double_peaked", 1), "not reproduced"),
    ("K4", put(FRICTION, "friction_axis", "double_peaked", [1, 0, 1, 0]), "differs"),
    ("S1", scaled("friction_fields", "stress", "axis_angle", 9.0), "differs"),
    ("S2", put("friction_fields", "stress", "distance_to_lattice", 0.5), "not reproduced"),
    ("S3", scaled("friction_fields", "stress", "antisymmetric_near", 10.0), "differs"),
    ("S4", put("friction_fields", "profiles", "axis_magnitude", 0.9), "differs"),
    ("P1", put("pile_dip", "stress", "dip", 0.0), "not reproduced"),
    ("P2", put("pile_dip", "stress", "dip", 0.05), "not reproduced"),
    ("P3", put("pile_dip", "piles", "central_width", [16.0, 16.0, 30.0]), "differs"),
    ("T1", put("torque", "reach", "stress_change", 0.3), "differs"),
    ("T1", scaled("torque", "reach", "force_change", 0.1), "not reproduced"),
    ("D1", put("polydisperse_averages", "averages", "mean", profile(0.5)), "differs"),
    ("D1", put("polydisperse_averages", "averages", "count_at_rest", 5), "differs"),
    ("D2", put("polydisperse_averages", "linear_range", "nonlinear_from", [0.2, 0.6, 20.0]), "differs"),
    ("D2", put("polydisperse_averages", "linear_range", "nonlinear_from", NAN), "not reproduced"),
    (
        "D4",
        scaled("polydisperse_averages", "averages", "mean", np.where(np.arange(81) < 41, 1.0, [[0], [1], [1]])),
        "differs",
    ),
    (
        "D4",
        scaled(
            "polydisperse_averages", "ensembles", "floor_response", np.where(np.arange(41) < 21, 1, [[0], [1], [1]])
        ),
        "differs",
    ),
    ("D5", put("polydisperse_averages", "averages", "mean_of_few", profile(-0.1)), "differs"),
    ("D5", put("phase_diagram", "shapes", "few_agree", 0.5), "differs"),
    ("D7", scaled("polydisperse_averages", "packings", "coordination_number_bulk", 1.2), "not reproduced"),
    ("D3", overlapping, "differs"),
    ("D3", scaled("phase_diagram", "crossovers", "interval", np.geomspace(1.0, 1e-6, 12)[:, None]), "differs"),
    ("D6", put("phase_diagram", "crossovers", "interval", NAN), "differs"),
    ("D6", put("phase_diagram", "crossovers", "kind", 2), "not reproduced"),
    ("U1", scaled("superposition", "errors", "floor_error_largest", 10.0), "not reproduced"),
    ("U2", put("superposition", "linear_range", "nonlinear_from", 3.0), "differs"),
    ("U2", put("superposition", "linear_range", "nonlinear_from", NAN), "not reproduced"),
    ("U3", scaled("superposition", "errors", "floor_error_largest", 10.0), "not reproduced"),
    ("N1", scaled("numerics", "stop_energy", "loaded_error", 100.0), "not reproduced"),
    ("N2", scaled("numerics", "restart", "kinetic_energy", 1e8), "not reproduced"),
    ("N3", scaled("numerics", "at_rest", "mean_acceleration", 10.0), "differs"),
    ("N4", scaled("numerics", "time_step", "difference", 1e3), "not reproduced"),
    ("N5", scaled("numerics", "integrators", "difference", 1e4), "not reproduced"),
    ("N6", put("numerics", "damping", "relaxation_time", [120.0, 70.0, 40.0, 30.0, 20.0]), "not reproduced"),
]


@pytest.mark.parametrize(("id_", "change", "expected"), PERTURBED, ids=[f"{p[0]}-{p[2]}" for p in PERTURBED])
def test_perturbed_data_flips_the_verdict(id_, change, expected):
    groups = everything()
    change(groups)
    entry = claims.judge(CLAIM[id_], Data(groups))
    assert (entry.verdict, bool(entry.reason)) == (expected, True)


def test_every_claim_is_perturbed():
    assert {perturbed[0] for perturbed in PERTURBED} == set(IDS)


@pytest.mark.parametrize("id_", IDS)
def test_a_missing_variable_means_not_measured(id_):
    """Each dataset of a claim's group loses all variables: the claim must not be judged on what is left."""
    groups = everything()
    group = CLAIM[id_].group
    groups[group] = {name: data.drop_vars(list(data.data_vars)) for name, data in groups[group].items()}
    assert verdict(id_, groups) == "not measured"


def test_verdicts_follow_from_conditions():
    yes, no = Condition("", True, ""), Condition("", False, "")
    assert verdict_of([yes, yes]) == "reproduced"
    assert verdict_of([yes, no]) == "differs"
    assert verdict_of([no, no]) == "not reproduced"
    assert verdict_of([yes, Condition("", False, "", essential=True)]) == "not reproduced"
    with pytest.raises(ValueError, match="needs conditions"):
        verdict_of([])


def test_sampled_events_have_the_tolerance_they_state():
    def held(low, high):
        return [condition.holds for condition in sampled_event("event", Bracket(low, high), 10.0)]

    assert held(8.0, 10.0) == [True, True]
    assert held(7.99, 8.1) == held(9.9, 10.01) == [True, False]
    assert held(20.0, float("nan")) == [False, False]


def test_labels_are_found_exactly():
    data = dataset({"stop": [1e-9, 1e-13], "friction": ("stop", [0.0, 0.1])}, value=("stop", [1.0, 2.0]))
    assert float(at(data, stop=1e-13)["value"]) == 2.0
    with pytest.raises(NotMeasured, match="stop = 1e-11"):
        at(data, stop=1e-11)


def test_stored_table_and_metrics_agree(tmp_path):
    labels = {"long_name": "test", "units": "1"}
    pile = {}
    for name, data in pile_study().items():
        pile[name] = data.copy()
        for variable in pile[name].variables.values():
            variable.attrs.update(labels)
    store.write(tmp_path / "data" / "pile_dip.nc", pile)
    found = claims.write(tmp_path / "claims.json", tmp_path / "data")
    stored = json.loads((tmp_path / "claims.json").read_text())
    assert stored == found
    assert [row["id"] for row in stored["table"]] == IDS == list(stored["verdicts"])
    assert all(stored["verdicts"][row["id"]]["verdict"] == row["verdict"] for row in stored["table"])
    assert stored["counts"] == {
        "reproduced": 3, "differs": 0, "not_reproduced": 0, "not_measured": len(IDS) - 3, "total": len(IDS)
    }  # fmt: skip
    assert stored["verdicts"]["P1"] == {"verdict": "reproduced", "value": 0.07}
    again = (tmp_path / "claims.json").read_bytes()
    claims.write(tmp_path / "claims.json", tmp_path / "data")
    assert (tmp_path / "claims.json").read_bytes() == again


def test_the_counts_in_words():
    found = claims.document(claims.evaluate(Data({"pile_dip": pile_study()})))
    assert claims.sentence(found) == f"Of {len(IDS)} claims of the paper: 3 reproduced, {len(IDS) - 3} not measured."


def test_the_readme_quotes_the_stored_table():
    stored = ROOT / "figures" / "claims.json"
    if not stored.exists():
        pytest.skip("figures/claims.json is not there yet: dvc repro claims")
    text = (ROOT / "README.md").read_text()
    counts = claims.sentence(json.loads(stored.read_text()))
    assert generated.replace(text, claims.BLOCK, counts) == text, "granular-response claims --readme README.md"


def test_the_stages_read_every_group_of_the_pipeline():
    stages = yaml.safe_load((ROOT / "dvc.yaml").read_text())["stages"]
    declared = {Path(d).stem for d in stages["claims"]["deps"] if d.startswith("data/")}
    assert declared == set(NAMES) & set(claims.GROUPS)
    drawn = {Path(d).name for d in stages["report"]["deps"] if d.startswith("figures/")}
    assert drawn == {*NAMES, "claims.json"}
