"""Numbers of figure groups at reduced size are those stored beside this file, and claims can be measured on them.

``pytest --force-regen`` stores new ones.
"""

from importlib import import_module

import numpy as np
import pytest
import reduced

from granular_response_paper.claims.claim import Data
from granular_response_paper.claims.verdict import judge


def of(dataset, *names, **places):
    """Variables of a dataset at the given places."""
    return dataset[list(names)].isel(places).data_vars


def averages(data):
    """Means with the second smoothing, for each case and force."""
    force = data["force"].values
    return {f"case{c}_force{force[c, s]:g}": data["mean"][1, c, s] for c, s in np.argwhere(np.isfinite(force))}


#: For each table its group, relative and absolute tolerance, and its columns from the datasets of the group.
VALUES = {
    "crossover_scaling": (
        "crossover_scaling", 1e-6, 1e-9,
        lambda d: {
            "crossover": d["slabs"]["crossover_bracket"],
            "first_opening": d["slabs"]["first_opening_bracket"],
            "linear_opening": d["slabs"]["linear_opening"],
            "exponent": d["powers"]["exponent"].sel(event="crossover"),
        },
    ),
    "experiments": (
        "experiments", 1e-5, 1e-8,
        lambda d: of(d["means"].sel(estimate="mean"), "direction", "contrast", "power", "slope"),
    ),
    "friction_fields": (
        "friction_fields", 1e-5, 1e-8,
        lambda d: of(d["stress"], "misalignment", "axis_angle", "axis_share", "distance_to_lattice",
                     "antisymmetric_near"),
    ),
    "frictionless_crossover_profiles": (
        "frictionless_crossover", 1e-8, 1e-10,
        lambda d: {
            "x": d["response"]["x"],
            **{f"F = {float(one['force']):g}": one for one in d["response"]["floor_response"]},
        },
    ),
    "frictionless_crossover_measurements": (
        "frictionless_crossover", 1e-8, 1e-10,
        lambda d: {
            **{
                f"response {name}": d["response"][name]
                for name in ("response_at_centre", "central_dip", "peak_count", "teardrop_depth", "teardrop_width",
                             "opened_contacts")
            },
            "sizes depth": d["sizes"]["teardrop_depth"],
            "sizes width": d["sizes"]["teardrop_width"],
            "widths depth": d["widths"]["teardrop_depth"],
            "stiffness response": d["stiffness"]["response_at_centre"],
            "stiffness change": d["stiffness"]["response_change"],
        },
    ),
    "frictionless_crossover_events": (
        "frictionless_crossover", 1e-8, 1e-10, lambda d: of(d["events"], "low", "high"),
    ),
    "hysteresis": (
        "hysteresis", 1e-5, 1e-9,
        lambda d: of(d["loops"], "work", "lost", "slid", "slid_again", "floor_left", "displacement_left", case=1,
                     realization=0),
    ),
    "influence": (
        "influence", 1e-6, 1e-9,
        lambda d: {
            "lattice": d["saint_venant"]["difference"].isel(case=0, realization=0, separation=0),
            "disordered": d["saint_venant"]["difference"].isel(case=1, realization=2, separation=1),
            "exponents": d["saint_venant"]["exponent"].isel(separation=0, fit=0),
        },
    ),
    "moduli": (
        "moduli", 1e-6, 1e-9,
        lambda d: {
            **of(d["packings"], "moduli", "difference", case=0, size=1, realization=2),
            "turns": [*d["lattice"]["turn"].values.ravel(), *d["lattice"]["turn_response"].values],
        },
    ),
    "network": (
        "network", 1e-6, 1e-9,
        lambda d: {
            f"{name}_{state}": d["statistics"][name].sel(state=state)
            for name in ("tail_excess", "coordination_number", "mobilized", "hyperstaticity")
            for state in ("rest", "loaded")
        },
    ),
    "peak_width": (
        "peak_width", 1e-6, 1e-9,
        lambda d: {
            "inside": d["inside"]["length"].isel(definition=slice(0, 2)),
            "floors": d["floors"]["length"].isel(definition=slice(0, 2)),
            "powers": d["floors"]["power"].isel(definition=slice(0, 2)),
            "intervals": d["floors"]["interval"].isel(definition=slice(0, 2)),
        },
    ),
    "pile_dip": (
        "pile_dip", 1e-6, 1e-8,
        lambda d: {
            **of(d["piles"], "floor_dip", "central_open_contacts", "central_height", "central_width"),
            "dip": d["stress"]["dip"],
        },
    ),
    "polydisperse_averages": ("polydisperse_averages", 1e-4, 1e-6, lambda d: averages(d["averages"])),
    "rolling_resistance": (
        "rolling_resistance", 1e-5, 1e-8,
        lambda d: {
            **of(d["slabs"].sel(friction=0.2), "floor_response", "opening", "couple_stress"),
            "couple": d["torques"]["couple"].isel(torque=1),
        },
    ),
    "slab_comparison": (
        "slab_comparison", 1e-4, 1e-9, lambda d: of(d["slabs"], "distance", "distance_other_floor", "open_at_rest"),
    ),
    "stiffness_ratio_crossover": (
        "stiffness_ratio_crossover", 1e-6, 1e-9,
        lambda d: of(d["response"], "response_at_centre", "central_dip", "opened_contacts"),
    ),
    "superposition": (
        "superposition", 1e-4, 1e-7,
        lambda d: of(d["errors"], "floor_error", "floor_error_largest", "contact_error", "contact_error_largest",
                     force=slice(1, None)),
    ),
    "tangent_moduli": (
        "tangent_moduli", 1e-4, 1e-6,
        lambda d: of(d["slabs"], "force", "predicted", "difference", "reach", "unexplained", width=0),
    ),
    "torque": (
        "torque", 1e-5, 1e-8, lambda d: of(d["reach"], "force_change", "stress_change", "antisymmetric_change"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", VALUES)
def test_values_are_the_stored_ones(name, num_regression, tmp_path_factory):
    group, relative, absolute, columns = VALUES[name]
    found = columns(reduced.datasets(group, tmp_path_factory))
    num_regression.check(
        {column: np.ravel(values) for column, values in found.items()},
        basename=name,
        default_tolerance={"rtol": relative, "atol": absolute},
    )


@pytest.mark.parametrize("group", ["crossover_scaling", "hysteresis", "moduli"])
def test_claims_are_measured_on_small_slabs_too(group, tmp_path_factory):
    data = Data({group: reduced.datasets(group, tmp_path_factory)})
    for claim in import_module(f"granular_response_paper.groups.{group}.claims").CLAIMS:
        assert judge(claim, data).verdict != "not measured", claim.id
