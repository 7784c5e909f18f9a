"""Allowed parameters of each figure group that nobody would take: what is measured is then often nothing.

Three for each group, as changes to its section of ``notebooks/reduced.yaml``: few disks, one value where there are
usually many, forces and places beyond what there is.
"""

from __future__ import annotations

from typing import Any

import reduced


def section(group: str, number: int) -> dict[str, Any]:
    """The section of a group with one of its odd settings; the base scene keeps what is not named."""
    given, change = reduced.parameters(group), SETTINGS[group][number]
    whole = {**given, **change}
    if "scene" in change:
        whole["scene"] = {**_dotted(given.get("scene", {})), **change["scene"]}
    return whole


def _dotted(values: dict[str, Any], above: str = "") -> dict[str, Any]:
    found = {}
    for key, value in values.items():
        found |= _dotted(value, f"{above}{key}.") if isinstance(value, dict) else {f"{above}{key}": value}
    return found


SMALL = {"packing.layers": 2, "packing.disks_per_row": 5}
SHALLOW = {"packing.layers": 3, "packing.disks_per_row": 9}
ONE = {"packing.layers": 1, "packing.disks_per_row": 7}
AT_ONCE = {"friction": 0.2, "forces": [], "ramp_time": 0.0, "time_step": 0.0005}
FEW_CASES = {
    "cases": [{"polydispersities": [0.01], "friction": 0.2, "forces": [1.0]}],
    "individual": {"polydispersity": 0.01, "frictions": [0.2], "force": 1.0, "realizations": 1, "width": 3.0},
    "linear_range": {
        "polydispersities": [0.01],
        "frictions": [0.2],
        "forces": [0.1, 0.5],
        "width": 3.0,
        "tolerance": 0.05,
    },
    "forces_picture": {"polydispersity": 0.01, "friction": 0.2, "force": 1.0, "realization": 0},
}

SETTINGS: dict[str, tuple[dict[str, Any], ...]] = {
    "theory": (
        {"points": 3, "depths": [0.1]},
        {"ray_angle": 0.0, "half_width": 1e-6},
        {"stiffness_ratio": 0.0, "ray_angle": 89.9, "diffusion_length": 1e-9, "points": 5},
    ),
    "slab_comparison": (
        {"cases": [{"friction": 0.0, "floor": "smooth", "gravity": "at-once", "disks_per_layer": 6, "layers": [2]}]},
        {"cases": [{"friction": 1.0, "floor": "rough", "gravity": "slow", "disks_per_layer": 2, "layers": [4]}]},
        {"force": 50.0, "cases": [{"friction": 1.0, "floor": "smooth", "gravity": "at-once", "disks_per_layer": 6,
                                   "layers": [3]}]},
    ),
    "frictionless_crossover": (
        {"scene": SMALL, "sizes": [[2, 7]], "widths": [[2, 7]], "forces": [0.01], "size_forces": [0.01],
         "stiffness_forces": [0.01]},
        {"scene": ONE, "sizes": [[2, 7]], "widths": [[2, 7]], "forces": [0.25, 15.0]},
        {"scene": SMALL, "sizes": [[2, 7], [3, 7]], "widths": [[2, 9]], "stiffnesses": [10.0, 100.0],
         "compared_stiffnesses": [10.0, 100.0], "forces": [400.0]},
    ),
    "friction_linear_range": (
        {"scene": SMALL, "forces": [0.1], "dynamics": AT_ONCE},
        {"scene": ONE, "extra_forces": [], "ends": [], "dynamics": AT_ONCE},
        {"frictions": [0.2], "forces": [8.0], "extra_forces": [], "ends": [], "states_of": [0.2],
         "friction_axis": {"frictions": [0.2], "force": 0.1, "tolerance": 0.05},
         "dynamics": AT_ONCE},
    ),
    "symmetry_breaking": (
        {"scene": SMALL},
        {"scene": SHALLOW, "asymmetry": 100.0},
        {"held": {"forces": [0.01], "displacement": 1e-6}, "copies": {"force": 0.01, "displacement": 1e-6, "seeds": []},
         "protocols": [{"ramp_time": 0.0, "time_steps": [0.0005], "between": [0.0, 0.1]}], "tolerance": 0.1},
    ),
    "stiffness_ratio_crossover": (
        {"scene": ONE},
        {"scene": SHALLOW, "ratios": [0.8, 0.9], "force": 0.01},
        {"scene": {**SHALLOW, "contact.friction": 0.0}, "ratios": [0.0, 1.0]},
    ),
    "friction_fields": (
        {"scene": ONE},
        {"frictions": [0.2], "profiles": {"frictions": [], "force": 12.0, "rows": [1.5]}},
        {"scene": SHALLOW, "profiles": {"frictions": [0.0], "force": 1.0, "rows": [50.0]}, "stress_half_width": 0.1},
    ),
    "pile_dip": (
        {"scene": {"packing.layers": 1}},
        {"scene": {"packing.layers": 2}, "dip_height": 100.0},
        {"stress_spacing": 50.0},
    ),
    "torque": (
        {"torques": [0.0]},
        {"scene": {"packing.disks_per_row": 9}, "distances": [100.0, 200.0]},
        {"scene": SHALLOW, "force": 0.5, "torques": [0.0, 0.01], "distances": [0.0, 1e-6]},
    ),
    "polydisperse_averages": (
        {**FEW_CASES, "realizations": 1, "few": 50, "widths": [1e-3]},
        {**FEW_CASES, "reach": 1e-3, "spacing": 1.0},
        {**FEW_CASES, "linear_range": {**FEW_CASES["linear_range"], "forces": [0.5], "tolerance": 1e-9}},
    ),
    "superposition": (
        {"realizations": 1, "pair_realizations": 1, "offsets": [1], "forces": [0.2, 1.0],
         "single_forces": [0.01, 0.02]},
        {"realizations": 2, "pair_realizations": 1, "offsets": [4], "tolerance": 1e-9},
        {"scene": SHALLOW, "realizations": 1, "pair_realizations": 1, "offsets": [1],
         "forces": [0.2, 1.0, 20.0], "single_forces": [10.0, 40.0], "tolerance": 10.0},
    ),
    "influence": (
        {"cases": [{"polydispersity": 0.0, "friction": 0.0}], "margin": 100.0},
        {"scene": SMALL, "margin": 1.0},
        {"fitted": [100.0, 200.0], "separations": [40]},
    ),
    "network": (
        {"polydispersities": [0.1], "frictions": [0.0], "realizations": 1, "force": 50.0},
        {"scene": {"packing.layers": 5}, "polydispersities": [0.25], "frictions": [0.2], "band": 100.0},
        {"polydispersities": [0.1], "frictions": [0.2], "realizations": 1, "band": 1e-6, "margin": 0.9},
    ),
    "rolling_resistance": (
        {"layers": [1], "rolling_frictions": [0.0], "slab_rolling_frictions": [0.0], "ramps": [0.0]},
        {"most_friction": 0.1, "tolerance": 1.0, "scene": SMALL},
        {"moved": 1e-9, "slabs": [{"friction": 0.2, "forces": [0.01]}], "shown_forces": [0.01, 0.02], "heights": 1},
    ),
    "tangent_moduli": (
        {"scene": SMALL, "slabs": [{"friction": 0.0, "forces": [0.1], "shown": 5.0}], "waves": [1, 1]},
        {"scene": {"packing.layers": 1}, "widths": [0.01]},
        {"widths": [50.0], "smoothing": 0.01, "slabs": [{"friction": 0.2, "forces": [50.0], "shown": 1.0}]},
    ),
    "experiments": (
        {"cases": [{"packing": "nearly equal", "force": 1.0, "realizations": 1}], "pictures": [], "depths": 1},
        {"cases": [{"packing": "bidisperse", "force": 500.0, "realizations": 3}], "pictures": [0]},
        {"largest_move": 1e-9, "fitted": [100.0, 0.5], "ring": [50.0, 60.0], "reach": 1, "draws": 1, "pictures": []},
    ),
    "crossover_scaling": (
        {"series": [{"name": "width", "friction": 0.0, "layers": [5], "disks_per_layer": [3.0, 4.0]}]},
        {"most_forces": 5, "first_force": 0.01, "series": [{"name": "low", "friction": 0.0, "layers": [5, 7]}]},
        {"visible": 100.0, "series": [{"name": "none", "friction": 0.0, "layers": [5, 6]}]},
    ),
    "peak_width": (
        {"cases": [{"polydispersity": 0.0, "friction": 0.0, "layers": [4]}]},
        {"cases": [{"polydispersity": 0.1, "friction": 0.2, "layers": [4], "realizations": 3}], "loads": 1, "lines": 1},
        {"cases": [{"polydispersity": 0.0, "friction": 0.0, "layers": [4, 6]}], "fitted": [500.0, 0.8], "reach": 0.01,
         "spacing": 0.0005},
    ),
    "moduli": (
        {"cases": [{"polydispersity": 0.1, "friction": 0.0, "layers": [5], "realizations": [3]}], "draws": 1},
        {"margin": 0.39, "tolerances": [1e-9]},
        {"cases": [{"polydispersity": 0.1, "friction": 0.2, "layers": [5], "realizations": [3]}], "wide": 1.0,
         "disks_per_layer": 1},
    ),
    "hysteresis": (
        {"cases": [{"polydispersity": 0.0, "friction": 0.0, "forces": [0.01], "increments": 1}]},
        {"cases": [{"polydispersity": 0.1, "friction": 0.2, "realizations": 1, "forces": [0.3], "increments": 2}]},
        {"left": 1.0, "cases": [{"polydispersity": 0.0, "friction": 0.2, "forces": [0.1, 15.0], "increments": 2}]},
    ),
    "preparation": (
        {"scene": SMALL, "parts": [{"friction": 0.2, "to": 0.05}]},
        {
            "ways": [{"name": "at once", "changes": {}}],
            "parts": [
                {"friction": 0.0, "to": 0.05},
                {"friction": 0.2, "taps": {"number": 1, "amplitudes": [1.0], "durations": [1e-9]}, "to": 0.05},
            ],
            "forces": [0.05],
        },
        {"asymmetry": 1e-12, "forces": [200.0], "parts": [{"friction": 0.2, "to": 200.0}]},
    ),
    "contact_law": (
        {"friction": [0.0], "forces": [1e-3]},
        {"scene": ONE},
        {"scene": SMALL, "forces": [300.0]},
    ),
    "numerics": (
        {"frictions": [0.0], "friction": 0.0},
        {"scene": SMALL, "stop_energies": [1e-9], "swing": {"steps": 10, "read_every": 10}},
        {"time_steps": [1e-4, 1e-4], "damping": {"ratios": [0.5], "time_step": 2.5e-4, "stop_kinetic_energy": 1e-9}},
    ),
    "sensitivity": (
        {"scene": SMALL, "literal_steps": 1},
        {"force": 1e-3, "friction": [0.0]},
        {"scene": ONE, "force": 50.0},
    ),
    "explorer": (
        {"forces": [0.5], "disordered": [{"polydispersity": 0.01, "friction": 0.2, "largest_force": 0.5}]},
        {"scene": SMALL},
        {"scene": SHALLOW, "width": 1e-6, "forces": [1e-3, 1e5],
         "disordered": [{"polydispersity": 0.9, "friction": 0.0, "largest_force": 1e5}]},
    ),
    "overview": (
        {"scene": SMALL},
        {"frictions": [0.2], "forces": [1e-3]},
        {"scene": SHALLOW, "experiment": {"polydispersities": [0.0], "friction": 0.0, "force": 1e3,
                                          "stop_kinetic_energy": 1e-9}},
    ),
    "stability": (
        {"random_scenes": {"number": 1, "chunk": 5, "maximum_steps": 1}},
        {"rolling": {"friction": 0.2, "time_step": 0.0001, "starts": [[0.0, 0.0]]}},
        {"random_scenes": {"number": 2, "chunk": 1, "maximum_steps": 100},
         "collisions": {"frictions": [5.0], "damping_ratios": [0.0], "angles": [0.1], "spins": [0.0],
                        "time_step": 0.0001}},
    ),
}  # fmt: skip
