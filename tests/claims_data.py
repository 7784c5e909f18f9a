"""Datasets in which every claim of the paper holds, small ones, for tests that then plant wrong data."""

import numpy as np
import xarray as xr
import yaml
from places import ROOT

from granular_response.state import OPEN, SLIDING, STICKING
from granular_response_paper.groups.theory import simulate as theory

FORCES = np.unique(np.concatenate([0.1 * 1.05 ** np.arange(141), [4.0, 5.0, 15.0, 25.0, 40.0, 50.0]]))
X = np.linspace(-60.0, 60.0, 61)
STARTS = ["touching-largest", "2.0"]


def dataset(coords=None, **variables):
    """A dataset that can be stored: every variable has its labels."""
    made = xr.Dataset(
        {name: value if isinstance(value, tuple) else ((), value) for name, value in variables.items()}, coords=coords
    )
    for name, one in made.variables.items():
        one.attrs = {"long_name": str(name), "units": "1"}
    return made


def by_row(dimension, names, rows):
    """Variables along one dimension from a table."""
    columns = zip(*rows, strict=True)
    return {name: (dimension, np.array(column)) for name, column in zip(names.split(), columns, strict=True)}


def events(*rows):
    return dataset(**by_row("event", "name friction low high", rows))


def by_friction(*rows):
    return ("friction", "force"), np.stack([np.broadcast_to(row, FORCES.shape) for row in rows]).astype(float)


#: An elastic response.
ELASTIC = 0.07 * np.exp(-((X / 20.0) ** 2))


#: Forces of the stored states, and names of the sizes of the open region.
STATES = (0.0, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 30.0)
SIZES = ("opened_contacts", "teardrop_depth", "teardrop_width")


def friction_study():
    floor = [3.5, 19.0, 10.9]
    depth = [np.minimum(24.0, 24.0 * FORCES / f) for f in (3.5, 19.0, 19.0)]
    opened = np.round(10.0 * FORCES)
    response = dataset(
        {"friction": [0.0, 0.2, 1.0], "force": FORCES, "x": ("floor_disk", X)},
        # one per cent off at these forces, five at five times as much
        response_at_centre=by_friction(*(0.07 * (1.0 - 0.01 * FORCES / end) for end in (0.9, 5.5, 7.5))),
        double_peaked=by_friction(FORCES > 3.0, FORCES > 20.1, 0.0),
        central_dip=by_friction(0.01 * (FORCES - 2.0), 0.01 * (FORCES - 19.2), -0.05),
        half_maximum_width=by_friction(28.0, 28.0, 28.0 - 0.1 * FORCES),
        peak_height=by_friction(0.07, 0.07, 0.07),
        third_peak_prominence=by_friction(0.0, 0.1 * (FORCES > 38.0), 0.0),
        teardrop_depth=by_friction(*depth),
        teardrop_width=by_friction(*depth),
        reaches_floor=by_friction(*(f < FORCES for f in floor)),
        opened_contacts=by_friction(opened, 0.2 * opened, 0.2 * opened),
        floor_response=(
            ("friction", "force", "floor_disk"),
            ELASTIC * (1.0 + 0.5 * (FORCES > 20.0) * np.array([[0.0], [1.0], [0.0]]))[:, :, None],
        ),
    )
    one_side = np.where(X > 0.0, 0.08, 0.01)
    profiles = np.stack([np.exp(-((X / 20.0) ** 2)) * 0.07] * 2 + [one_side, one_side[::-1]])
    profiles = np.concatenate([profiles, profiles[-1:], profiles[-1:]])
    large = dataset(
        {"force": [90.0, 91.0, 93.0, 95.0, 150.0, 500.0], "x": ("floor_disk", X), "margin": [0.01, 0.05]},
        asymmetry=("force", [0.001, 0.001, 1.5, 1.5, 1.2, 1.0]),
        asymmetry_sign=("force", [1, 1, 1, -1, -1, -1]),
        network_asymmetry=("force", [0.0, 0.0] + [0.02] * 4),
        mobilised_contacts=(("force", "margin"), np.array([[10, 20]] * 2 + [[1, 2]] * 4)),
        floor_response=(("force", "floor_disk"), profiles),
    )
    away = np.array([0.8, 0.3, 0.1, 0.05, 0.0])[:, None]
    axis = dataset(
        {"friction": [0.0, 0.1, 0.2, 1.0, 2.0]},
        central_dip=("friction", [0.9, 0.5, -0.01, -0.03, -0.03]),
        sliding_contacts=("friction", [0.0, 300.0, 200.0, 100.0, 50.0]),
        floor_response=(("friction", "floor_disk"), (1.0 - away) * ELASTIC),
        **{n: ("friction", [110.0, 80.0, 40.0, 20.0, 0.0]) for n in SIZES},
    )
    # a column of disks below the loaded one, whose contacts slide one after the other, and three disks beside it
    column = np.stack([np.zeros(14), -2.0 * np.arange(14.0)], axis=1)
    beside = column[3:6] + np.array([2.0, 0.0])
    slides = np.zeros((len(STATES), 16), bool)
    for force, upper, level in zip(STATES, (0, 1, 2, 2, 3, 5, 1, 3), (0, 0, 0, 0, 0, 0, 3, 1), strict=True):
        slides[STATES.index(force), :upper] = slides[STATES.index(force), 13 : 13 + level] = True
    states = dataset(
        {"force": ("state", list(STATES))},
        position=(("state", "disk", "axis"), np.stack([np.concatenate([column, beside])] * len(STATES))),
        contact_disk=("contact", [*range(13), 3, 4, 5]),
        contact_partner=("contact", [*range(1, 14), 14, 15, 16]),
        contact_status=(("state", "contact"), np.where(slides, SLIDING, STICKING)),
        loaded_disk=((), 0),
    )
    few = np.full((2, 8), STICKING)
    few[1, 0], few[1, 1:5] = OPEN, SLIDING
    status = np.full((7, 8), STICKING)
    status[3:, :6] = OPEN
    table = events(
        ("first_opening", 0.0, 0.67, 0.69),
        ("first_opening", 0.2, 3.9, 3.92),
        ("first_opening", 1.0, 5.6, 5.62),
        ("linear_range", 0.0, 0.88, 0.9),
        ("linear_range", 0.2, 5.4, 5.5),
        ("linear_range", 1.0, 7.2, 7.3),
        ("first_opening_anywhere", 0.0, 0.66, 0.68),
        ("first_opening_anywhere", 0.2, 3.8, 3.82),
        ("first_opening_anywhere", 1.0, 5.5, 5.52),
        ("crossover", 0.0, 3.0, 3.1),
        ("crossover", 0.2, 20.1, 20.2),
        ("crossover", 1.0, 90.0, np.nan),
        ("reaches_floor", 0.0, 3.5, 3.6),
        ("reaches_floor", 0.2, 19.0, 19.1),
        ("reaches_floor", 1.0, 10.9, 11.0),
        ("third_peak", 0.2, 38.0, 38.1),
        ("friction_crossover", np.nan, 0.15, 0.16),
    )
    return {
        "response": response,
        "large_forces": large,
        "large_force_states": dataset(
            {"force": ("state", [0.0, *large["force"].values])}, contact_status=(("state", "contact"), status)
        ),
        "friction_axis": axis,
        "states_mu_0.2": states,
        "states_mu_1": dataset({"force": ("state", [0.0, 90.0])}, contact_status=(("state", "contact"), few)),
        "events": table,
        "events_equal_rows": table.copy(deep=True),
    }


def breaking_study():
    brackets = dataset(
        low=("event", [91.2, 91.5]),
        high=("event", [92.0, 92.5]),
        ramp_time=("event", [20.0, 100.0]),
        time_step=("event", [5e-4, 5e-4]),
    )
    return {"brackets": brackets, "equal_rows": events(("loss_of_symmetry", 1.0, 91.1, 91.9))}


def preparation_study():
    """Gravity at once, grown slowly and without friction first; in each, events where the claims want them."""
    ways = [("at-once", 100.0, 0.5), ("slow", 20.0, 0.5), ("frictionless", 100.0, 0.5), ("at-once", 100.0, 0.25)]
    cases = [(0.0, 0.0, ways[0]), *((mu, 0.0, way) for mu in (0.2, 1.0) for way in ways), (1.0, 1.0, ways[0])]
    comes = {
        "first_opening": {0.0: (0.67, 0.69), 0.2: (3.9, 3.92), 1.0: (5.6, 5.62)},
        "linear_range": {0.0: (0.88, 0.9), 0.2: (5.4, 5.5), 1.0: (7.2, 7.3)},
        "crossover": {0.0: (3.0, 3.1), 0.2: (20.1, 20.2), 1.0: (90.0, np.nan)},
        "reaches_floor": {0.0: (3.5, 3.6), 0.2: (19.0, 19.1), 1.0: (10.9, 11.0)},
        "third_peak": {0.0: (50.0, np.nan), 0.2: (38.0, 38.1), 1.0: (50.0, np.nan)},
        "loss_of_symmetry_path": {0.0: (50.0, np.nan), 0.2: (50.0, np.nan), 1.0: (91.2, 92.0)},
    }

    def labels(dimension, rows):
        names = "friction wall_friction gravity ramp_time damping_ratio"
        return by_row(dimension, names, [(friction, wall, *way) for friction, wall, way in rows])

    rows = [(case, name) for case in cases for name in comes]
    rough = np.array([0.5 if case[1] else 1.0 for case, _ in rows])  # beside rough walls everything comes sooner
    table = dataset(
        name=("event", [name for _, name in rows]),
        low=("event", rough * [comes[name][case[0]][0] for case, name in rows]),
        high=("event", rough * [comes[name][case[0]][1] for case, name in rows]),
        **labels("event", [case for case, _ in rows]),
    )
    # four preparations of one slab: the more mobilized contacts, the sooner everything happens
    part = np.array([0.0, 0.0, 0.3, 0.6])
    mobilized = dataset(
        {"name": ["linear_range", "first_opening", "crossover"], "margin": [0.01, 0.05]},
        mobilized_part=(("case", "margin"), np.stack([part, part], axis=1)),
        force=(("case", "name"), np.outer([10.0, 9.0, 2.0, 1.0], [1.0, 2.0, 3.0])),
        **{name: ("case", np.full(4, value)) for name, value in {
            "polydispersity": 0.0, "friction": 0.2, "wall_friction": 0.0}.items()},
    )  # fmt: skip
    return {"events": table, "mobilized": mobilized}


def ratio_study():
    ratio = np.array([0.0, 0.2, 0.3, 0.35, 0.4, 0.6, 0.8, 1.0])
    centre = np.array([0.01, 0.05, 0.064, 0.068, 0.073, 0.075, 0.076, 0.074])
    return {
        "events": events(("two_peaks_end", 10.0, 0.295, 0.3), ("central_maximum_begins", 10.0, 0.31, 0.315)),
        "response": dataset(
            {"stiffness_ratio": ratio},
            double_peaked=("stiffness_ratio", [1, 1, 1, 0, 0, 0, 0, 0]),
            response_at_centre=("stiffness_ratio", centre),
            floor_response=(("stiffness_ratio", "floor_disk"), centre[:, None] * np.exp(-((X / 20.0) ** 2))),
            sliding_contacts=("stiffness_ratio", np.zeros(8)),
        ),
        "elastic": dataset({"rotations": ["suppressed", "free"]}, root=("rotations", [0.2915, 3.0 / 11.0])),
    }


def fields_study():
    x, z = np.arange(-40.0, 41.0, 2.0), np.arange(0.0, 21.0, 2.0)
    grid = ("friction", "z", "x")
    ones = np.ones((3, z.size, x.size))
    dipped = profile(np.array([0.5, -0.1, -0.1])[:, None], x)[:, None] + 0.0 * ones
    return {
        "stress": dataset(
            {"friction": [0.0, 0.2, 1.0], "x": x, "z": z},
            misalignment=("friction", [0.1, 20.0, 30.0]),
            axis_angle=("friction", [30.0, 12.0, 3.0]),
            axis_share=("friction", [0.02, 0.09, 0.12]),
            distance_to_lattice=("friction", [0.5, 0.1, 0.04]),
            antisymmetric_near=("friction", [0.0, 0.01, 0.03]),
            antisymmetric_near_mean=("friction", [0.0, 0.01, 0.02]),
            stress_xx=(grid, ones),
            stress_zz=(grid, dipped),
            stress_zz_lattice=(("z", "x"), dipped[1]),
            stress_xz=(grid, 0.03 * ones),
            stress_zx=(grid, -0.03 * ones),
            load_height=20.0,
        ),
        "profiles": dataset(
            {"friction": [0.0, 1.0], "row": [2.5, 9.5]},
            axis_magnitude=(("friction", "row"), np.array([[0.2, 0.2], [1.0, 0.995]])),
        ),
    }


def pile_study():
    cases = {"case": ["frictionless", "mirrored", "frictional"]}
    return {
        "stress": dataset(cases, dip=("case", [0.07, 0.07, 0.0])),
        "glued": dataset(floor_dip=-0.02),
        "piles": dataset(
            cases,
            floor_dip=("case", [0.08, 0.08, -0.01]),
            central_open_contacts=("case", [49.0, 49.0, 50.0]),
            central_height=("case", [14.0, 14.0, 14.0]),
            central_width=("case", [16.0, 16.0, 20.0]),
        ),
    }


def torque_study():
    dims = ("torque", "ring")
    near_only = np.array([[0.0, 0.0, 0.0], [0.9, 0.7, 0.01]])
    reach = dataset(
        {"torque": [0.0, 5.0], "ring_inner": ("ring", [0.0, 3.0, 9.0]), "ring_outer": ("ring", [3.0, 6.0, 12.0])},
        force_change=(dims, near_only),
        stress_change=(dims, near_only),
        antisymmetric_change=(dims, near_only),
    )
    x, z = np.arange(0.0, 41.0, 2.0), np.arange(0.0, 21.0, 2.0)
    away = np.hypot(*np.meshgrid(x - 20.0, z - 20.0))
    change = np.stack([np.zeros_like(away), np.exp(-((away / 4.0) ** 2))])
    grid = ("torque", "z", "x")
    stress = dataset(
        {"torque": [0.0, 5.0], "x": x, "z": z},
        stress_xx=(grid, change),
        stress_xz=(grid, change),
        stress_zx=(grid, -change),
        stress_zz=(grid, change),
    )
    disks = dataset(
        {"torque": [0.0, 5.0]},
        position=(("torque", "disk", "axis"), np.full((2, 1, 2), 20.0)),
        loaded_disk=0,
    )
    return {"reach": reach, "stress": stress, "torques": disks}


def comparison_study():
    return {
        "slabs": dataset(
            distance=("slab", [0.02, 0.002, 0.03, 0.001]),
            layers=("slab", [5, 40, 5, 20]),
            friction=("slab", [0.0, 0.0, 1.0, 1.0]),
            floor=("slab", ["smooth", "smooth", "rough", "rough"]),
            gravity=("slab", ["at-once"] * 4),
            disks_per_layer=("slab", [8, 8, 8, 8]),
        )
    }


def numerics_study():
    grid = {"friction": [0.0, 0.2], "stop_kinetic_energy": [1e-9, 1e-13]}
    errors = np.array([[0.1, 1e-3], [0.1, 1e-4]])
    dims = ("friction", "stop_kinetic_energy")
    return {
        "stop_energy": dataset(grid, rest_error=(dims, errors), loaded_error=(dims, errors)),
        "restart": dataset({"load": [0.0, 4.0]}, kinetic_energy=(("load", "reading"), np.full((2, 3), 1e-28))),
        "at_rest": dataset(network_fixed_steps=6000.0, sliding_contacts=0.0, loose_disks=0.0),
        "swing": dataset(
            {"stop_rule": ["instantaneous", "envelope"]},
            mean_acceleration=(("stop_rule", "reading"), np.full((2, 3), 1e-6)),
            kinetic_energy=(("stop_rule", "reading"), np.full((2, 3), 1e-13)),
        ),
        "disorder": dataset(
            {"x": [-1.0, 0.0, 1.0]},
            stopped=(("realization", "x"), np.tile([1.001, 2.002, 1.0], (12, 1))),
            finished=(("realization", "x"), np.tile([1.0, 2.0, 1.0], (12, 1))),
        ),
        "time_step": dataset({"time_step": [5e-4, 2.5e-4]}, difference=("time_step", [0.0, 1e-5])),
        "integrators": dataset({"integrator": ["beeman", "gear"]}, difference=("integrator", [0.0, 1e-6])),
        "damping": dataset(
            {"damping_ratio": [0.1, 0.2, 0.5, 0.8, 1.0]},
            relaxation_time=("damping_ratio", [120.0, 70.0, 40.0, 45.0, 50.0]),
            settled=("damping_ratio", [1, 1, 1, 1, 1]),
            beeman_limit=("damping_ratio", [2e-3, 1e-3, 5.1e-4, 3e-4, 2e-4]),
        ),
    }


def frictionless_study():
    forces = np.array([1.0, 2.9, 3.3])
    # a lattice of one open column: two disks in each row, one row above the other
    rows = [8, 7, 7, 6, 6, 6, 5]
    first = 2 * np.arange(len(rows))
    position = np.array(
        [p for k, row in enumerate(rows) for p in ([4.0 * k, row * 3**0.5], [4.0 * k + 2.0, row * 3**0.5])]
    )
    depths = {"layers": ("slab", [15, 30, 15, 30]), "normal_stiffness": ("slab", [3000.0, 3000.0, 1e5, 1e5])}
    wide = np.array([[30.0, 40.0, 50.0], [29.0, 39.0, 49.0]] * 2)
    crossover = (("slab", "bracket"), np.array([[3.0, 3.1], [6.0, 6.1]] * 2))
    stiffness = [500.0, 1000.0, 2000.0, 3000.0, 1e5]
    axes = ("normal_stiffness", "force")
    size = np.array([[20.0, 30.0, 50.0]] + [[40.0, 60.0, 90.0]] * 4)
    return {
        "events": events(("crossover", 0.0, 3.0, 3.1), ("teardrop_reaches_floor", 0.0, 3.5, 3.6)),
        "response": dataset(
            {"force": forces},
            central_dip=("force", [-0.1, -0.05, 0.1]),
            teardrop_depth=("force", [1.0, 5.0, 12.0]),
            reaches_floor=("force", [0, 0, 0]),
        ),
        "states": dataset(
            {"force": forces},
            teardrop=(("force", "contact"), np.ones((3, len(rows)), int)),
            position=(("force", "disk", "axis"), np.stack([position] * 3)),
            contact_disk=("contact", first),
            contact_partner=("contact", first + 1),
        ),
        "sizes": dataset(
            {"force": forces, **depths},
            disks_per_row=("slab", [61, 122, 61, 122]),
            crossover_bracket=crossover,
            open_at_rest=("slab", [0] * 4),
        ),
        "regions": dataset(
            {"force": forces, **depths},
            teardrop_depth=(("slab", "force"), wide),
            teardrop_width=(("slab", "force"), wide),
            reaches_floor=(("slab", "force"), np.zeros((4, 3), int)),
        ),
        "widths": dataset(
            depths,
            disks_per_row=("slab", [61, 62, 61, 62]),
            crossover_bracket=crossover,
            open_at_rest=("slab", [0] * 4),
        ),
        "stiffness": dataset(
            {"force": forces, "normal_stiffness": stiffness, "dip": [0.0, 0.01]},
            response_at_centre=(axes, np.array([[0.05] * 3, [0.0693] * 3, [0.07] * 3, [0.07] * 3, [0.07] * 3])),
            teardrop_depth=(axes, size),
            teardrop_width=(axes, size),
            reaches_floor=(axes, np.zeros((5, 3), int)),
            crossover_bracket=(("normal_stiffness", "bracket"), np.tile([3.0, 3.03], (5, 1))),
            crossovers=(("normal_stiffness", "dip", "bracket"), np.tile([3.0, 3.03], (5, 2, 1))),
        ),
    }


def profile(dip, x=None):
    """A smooth response with a dip at x = 0 of about this part of its largest value; below 0 a single peak."""
    x = np.linspace(-40.0, 40.0, 81) if x is None else x
    return np.exp(-((x / 20.0) ** 2)) - dip * np.exp(-((x / 6.0) ** 2))


def disordered_cases():
    """Coordinates of the cases: the lattice, three frictions at three disorders, and the literal start."""
    cases = [(delta, mu, STARTS[0]) for delta in (0.0, 0.01, 0.1, 0.25) for mu in (0.0, 0.2, 1.0)]
    cases += [(0.01, mu, STARTS[1]) for mu in (0.0, 0.2)]
    return by_row("case", "polydispersity friction lattice_constant", cases)


#: Draws of the planted bootstrap, the same part of the crossover in every case.
DRAWS = np.linspace(0.95, 1.05, 41)


def phases_study():
    cases = disordered_cases()
    rng = np.random.default_rng(0)
    grid = [[3.0, 20.0, 90.0], [2.0, 8.0, 30.0], [1.0, 5.0, 9.0], [0.5, 2.0, 4.0], [2.5, 12.0]]
    force = np.array([f for row in grid for f in row])
    interval = np.stack([0.95 * force, force, 1.05 * force], axis=-1)
    draws = force[:, None] * DRAWS
    mu, delta = cases["friction"][1], cases["polydispersity"][1]
    n, few = len(mu), 8
    dip = np.where(mu == 0.0, 0.8, -0.05)
    levels = {"width": [3.0, 6.0], "level": [0.025, 0.5, 0.975]}
    spread = dip[:, None, None] + np.array([-0.02, 0.0, 0.02]) + np.zeros((1, 3, 1))
    steps = np.array([0.1, 15.0, 300.0])
    scatter = np.where(mu == 0.0, 0.005, 0.001)[:, None] + np.zeros((1, 3))
    each = 0.05 * rng.standard_normal((n, few, 3)) + dip[:, None, None]
    contacts = np.where(delta[:, None] == 0.0, 6.0, 4.25 + 0.01 * rng.standard_normal((n, few)))
    crossovers = {
        "force": (("width", "case"), np.stack([force] * 2)),
        "kind": (("width", "case"), np.zeros((2, force.size), int)),
        "interval": (("width", "case", "level"), np.stack([interval] * 2)),
        "draws": (("width", "case", "draw"), np.stack([draws] * 2)),
        "limits": (("width", "case", "end"), np.tile([0.01, 400.0], (2, n, 1))),
    }
    seen = {"seen": (("width", "case"), np.full((2, n), 0.9))}
    seen["seen_interval"] = (("width", "case", "level"), np.tile([0.8, 0.9, 0.95], (2, n, 1)))
    tolerances = [0.005, 0.02]
    definitions = {
        name: ((*dims[:2], "tolerance", *dims[2:]), np.repeat(values[:, :, None], 2, axis=2))
        for name, (dims, values) in crossovers.items()
        if name != "limits"
    }
    ends = np.array([4.0, 1.0, 0.5, 0.25])
    linear = np.array([[d, m] for d in (0.0, 0.01, 0.1, 0.25) for m in (0.0, 0.2)])
    small = np.array([0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0])
    # packings differ by a few per cent in where they leave the linear range
    apart = 1.0 + 0.05 * rng.standard_normal((len(linear), few, 1))
    away = np.maximum(0.0, small / (apart * np.repeat(ends, 2)[:, None, None]) - 1.0)
    return {
        "crossovers": dataset(
            {**cases, **levels, "realizations": ("case", [few] * n)}, **crossovers, **seen
        ).assign_attrs(tolerance=0.01),
        "medians": dataset({**cases, **levels}, **crossovers, collapsed=("case", np.where(delta == 0.25, 3, 0))),
        "definitions": dataset(
            {**cases, **levels, "tolerance": tolerances}, **definitions, limits=crossovers["limits"]
        ),
        "shapes": dataset(
            {**cases, **levels, "number": [5, 15]},
            applied_force=(("case", "step"), np.tile(steps, (force.size, 1))),
            shape=(("width", "case", "step"), np.stack([dip[:, None] + np.zeros((1, 3))] * 2)),
            shape_interval=(("width", "case", "step", "level"), np.stack([spread] * 2)),
            two_peaked_means=(
                ("width", "case", "step", "number"),
                np.tile(np.where(dip > 0.01, 0.99, 0.01)[:, None, None], (2, 1, 3, 2)),
            ),
            spread=(("width", "case", "step"), np.stack([scatter] * 2)),
            spread_interval=(
                ("width", "case", "step", "level"), np.stack([scatter[..., None] * np.array([0.9, 1.0, 1.1])] * 2)
            ),
            largest_step=(("width", "case"), np.full((2, n), 0.1)),
            largest_step_interval=(("width", "case", "level"), np.tile([0.08, 0.1, 0.12], (2, n, 1))),
        ),
        "realizations": dataset(
            {**cases, **levels, "realizations": ("case", [few] * n)},
            collapse_force=(("case", "realization"), np.tile(np.where(np.arange(few) < 4, 20.0, np.nan), (n, 1))),
            shape=(("width", "case", "realization", "step"), np.stack([each] * 2)),
            asymmetry=(("width", "case", "realization", "step"), np.full((2, n, few, 3), 0.1)),
            difference=(("width", "case", "realization", "step"), np.full((2, n, few, 3), 0.2)),
        ),
        "starts": dataset(
            {**cases, **levels, "realizations": ("case", [few] * n)},
            dip=(("width", "case"), np.stack([dip] * 2)),
            dip_interval=(("width", "case", "level"), np.stack([spread[:, 0]] * 2)),
            dip_of_means=(("width", "case", "level"), np.stack([spread[:, 0]] * 2)),
            dip_of_means_interval=(
                ("width", "case", "level", "end"), np.stack([spread[:, 0, :, None] + [-0.01, 0.01]] * 2)
            ),
        ),
        "packings": dataset(
            cases,
            coordination_number=(("case", "realization"), contacts),
            coordination_number_with_walls=(("case", "realization"), contacts),
            coordination_number_bulk=(("case", "realization"), contacts),
            horizontal_contacts=(("case", "realization"), np.where(delta[:, None] == 0.0, 0.9, 0.3 * contacts / 4.25)),
            oblique_contacts=(("case", "realization"), np.where(delta[:, None] == 0.0, 1.85, 1.7 * contacts / 4.25)),
        ),
        "linear_range": dataset(
            {
                "polydispersity": ("case", linear[:, 0]),
                "friction": ("case", linear[:, 1]),
                "lattice_constant": ("case", [STARTS[0]] * len(linear)),
            },
            response_at_centre=(("case", "realization", "step"), 0.07 * (1.0 - 0.1 * away)),
            profile_change=(("case", "realization", "step"), 0.1 * away),
            applied_force=(("case", "step"), np.tile(small, (len(linear), 1))),
        ),
    }  # fmt: skip


def means_study():
    """Symmetrical means of five, and contacts along the directions of the lattice."""
    angle = np.radians(np.arange(2.5, 180.0, 5.0))
    density = 1.0 + np.cos(6.0 * angle)
    cases = {"polydispersity": ("case", [0.1, 0.25]), "friction": ("case", [0.0, 0.0])}
    x = np.linspace(-10.0, 10.0, 21)
    return {
        "averages": dataset(
            {"width": [6.0], **cases},
            mean_of_few=(("width", "case", "step", "x"), np.broadcast_to(np.exp(-(x**2)), (1, 2, 3, 21))),
        ),
        "packings": dataset(
            {**cases, "angle": angle},
            contact_angle_density=(("case", "realization", "angle"), np.broadcast_to(density, (2, 4, angle.size))),
        ),
    }


def superposition_study():
    rng = np.random.default_rng(0)
    error = np.array([0.01, 0.1]) * rng.uniform(0.8, 1.2, (8, 2, 1))
    rows = np.array([0.1, 0.05, 0.02]) * rng.uniform(0.9, 1.1, (8, 2, 2, 1))
    dims = ("realization", "distance", "force")
    return {
        "errors": dataset(
            {"force": [0.2, 1.0], "distance": [4.0, 8.0], "gap": [1.0, 3.0, 5.0]},
            floor_error_largest=(dims, error),
            contact_error_largest=(dims, error),
            row_error=((*dims, "gap"), rows),
        ),
        "linear_range": dataset(
            linear_until=("realization", np.linspace(0.35, 0.4, 8)),
            nonlinear_from=("realization", np.linspace(0.4, 0.45, 8)),
        ),
    }


def sensitivity_study():
    """Responses by the linear law and by the power 3/2, a tenth of the largest apart."""
    one = dataset(
        {"variant": ["reference", "hertz"]},
        floor_response=(("variant", "floor_disk"), np.stack([ELASTIC, 1.1 * ELASTIC])),
        largest_difference=("variant", np.array([0.0, 0.1 * ELASTIC.max()])),
    )
    return {"mu_0.2": one, "mu_1": one}


def hysteresis_study():
    """Loops that are reversible as far as the response is linear, and lose nothing a second time."""
    low = np.full((2, 3, 2), np.nan)
    low[0, 0] = [4.0, 4.1]
    low[1] = [[0.5, 0.5], [0.6, 0.58], [0.55, 0.6]]
    materials = {"polydispersity": ("case", [0.0, 0.1]), "friction": ("case", [0.2, 0.2])}
    along = ("case", "realization", "turn")
    nothing = np.where(np.isfinite(low), 1e-4, np.nan)
    return {
        "events": dataset(
            materials | {"event": ["linear_range", "reversible_range"]},
            low=(("case", "realization", "event"), low),
            high=(("case", "realization", "event"), 1.02 * low),
        ),
        "loops": dataset(
            materials,
            force=(("case", "turn"), [[1.0, 15.0], [3.0, np.nan]]),
            work=(along, np.where(np.isfinite(low), 1.0, np.nan)),
            slid_again=(along, nothing),
            crossed_again=(along, 0.0 * nothing),
            floor_repeated=(along, nothing),
        ),
    }


def influence_study():
    power = np.full((2, 4, 1, 3), np.nan)
    power[0, 0] = [1.98, 1.97, 1.99]  # a lattice: one realization, and the range over the fits
    power[1] = np.array([1.86, 1.9, 1.92, 1.94])[:, None, None]
    return {
        "saint_venant": dataset(
            {"polydispersity": ("case", [0.0, 0.1]), "friction": ("case", [0.0, 0.2])},
            exponent=(("case", "realization", "separation", "fit"), power),
        )
    }


def scaling_study():
    """Powers 2 of the layers with and without friction, and a series of widths that no claim reads."""
    ends = np.array([2.0, 1.95, 2.05])
    exponent = np.broadcast_to(ends, (3, 3, 3)).copy()
    return {
        "powers": dataset(
            {
                "series": ["walls", "friction", "width"],
                "friction": ("series", [0.0, 0.2, 0.0]),
                "varied": ("series", ["layers", "layers", "disks_per_layer"]),
                "confined": ("series", ["walls", "as weight", "constant"]),
                "event": ["first_opening", "crossover", "reaches_floor"],
                "end": ["value", "least", "largest"],
            },
            exponent=(("series", "event", "end"), exponent),
            extrapolated=(("series", "event", "end"), 1e4 * exponent),
        ).assign_attrs(layers=1000.0)
    }


def moduli_study():
    """Two cases with friction and one without."""
    difference = np.full((3, 2, 4, 4, 2), np.nan)
    spread = np.array([-0.004, 0.0, 0.002, 0.004])[:, None, None]
    difference[:, 0] = 0.3
    difference[:, 1] = 0.03 + spread
    return {
        "packings": dataset(
            {
                "polydispersity": ("case", [0.1, 0.25, 0.1]),
                "friction": ("case", [0.2, 0.2, 0.0]),
                "solid": ["affine", "suppressed", "free", "isotropic"],
            },
            layers=(("case", "size"), np.array([[8.0, 16.0]] * 3)),
            difference=(("case", "size", "realization", "solid", "smoothing"), difference),
        )
    }


def network_study():
    """Isostatic packings with exponential forces."""
    spread = np.array([-0.02, 0.0, 0.01, 0.02])

    def along(values):
        return ("polydispersity", "friction", "realization", "state"), (
            np.array(values, float)[None, :, None, None] + spread[:, None] + np.zeros((2, 1, 1, 2))
        )

    labels = {"polydispersity": [0.1, 0.25], "friction": [0.0, 0.2, 1.0], "state": ["rest", "loaded"]}
    return {
        "statistics": dataset(
            labels,
            tail_variation=along([1.0, 1.0, 0.95]),
            coordination_number=along([4.0, 3.5, 3.1]),
            hyperstaticity=along([0.0, 0.05, 0.03]),
        )
    }


def rolling_study():
    """Piles that rolling resistance alone holds, and a Cosserat slab."""
    piles = {"layers": [5, 11], "rolling_friction": [0.0, 0.3], "ramp": [0.0, 30.0]}
    dims, ends = tuple(piles), np.array([[0.95], [0.1]])
    slabs = {"friction": [0.2, 1.0], "rolling_friction": [0.0, 0.5], "load": [0.5, 10.0]}
    torques = {**slabs, "torque": slabs["load"]}
    del torques["load"]
    fits = {"unexplained": 0.05, "length": 3.0, "decay_unexplained": 0.05, "decay_length": 3.0}
    response = np.array([0.1, 0.2, 0.1]) * np.array([1.0, 1.2])[:, None, None]
    return {
        "thresholds": dataset(
            piles,
            low=(dims, np.broadcast_to(ends, (2, 2, 2))),
            high=(dims, np.broadcast_to(ends + 0.02, (2, 2, 2))),
            floor_dip=(dims, np.full((2, 2, 2), -0.01)),
            loose_disks=(dims, np.full((2, 2, 2), 2.0)),
        ),
        "piles": dataset(
            {"layers": [5, 11], "case": ["supported", "free", "resisting"]},
            floor_dip=(("layers", "case"), np.full((2, 3), -0.01)),
        ),
        "slabs": dataset(
            slabs,
            floor_response=((*slabs, "floor_disk"), np.broadcast_to(response, (2, 2, 2, 3))),
            unexplained=(tuple(slabs), np.full((2, 2, 2), 0.05)),
            length=(tuple(slabs), np.full((2, 2, 2), 3.0)),
        ),
        "torques": dataset(torques, **{fit: (tuple(torques), np.full((2, 2, 2), of)) for fit, of in fits.items()}),
    }


def loaded_study():
    """A region of r < 0 that reaches the floor at the crossover, in an incrementally elastic slab."""
    peaks = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    fits = ("slab", "step", "width", "loads")

    def each(values):
        return fits, np.broadcast_to(np.array(values, float)[..., None, None], (2, 3, 2, 2)).copy()

    return {
        "slabs": dataset(
            {"friction": ("slab", [0.2, 1.0]), "width": [1.0, 2.0], "loads": ["body", "surface"]},
            force=(("slab", "step"), np.array([[10.0, 19.0, 21.0]] * 2)),
            crossover=(("slab", "end"), np.array([[20.0, 20.0], [21.0, np.nan]])),
            reach=each([[0.5, 0.8, 1.0], [0.0, 0.1, 0.2]]),
            difference=each(np.full((2, 3), 0.05)),
            two_peaks=(("slab", "step"), peaks),
            predicted_two_peaks=each(peaks),
        )
    }


def experiments_study():
    """Chains of nearly equal disks that fade with disorder; widths as the root of the depth in shallow slabs alone."""
    loads = [("nearly equal", force, 90.0) for force in (150.0, 15.0, 3.0)]
    loads += [("nearly equal", 150.0, angle) for angle in (45.0, 30.0)]
    loads += [("bidisperse", force, 90.0) for force in (150.0, 15.0, 3.0)]
    loads += [("deep", force, 90.0) for force in (3.0, 1.5)]
    coordinates = by_row("case", "packing force_applied angle_applied", loads)
    near, deep = (coordinates["packing"][1] == name for name in ("nearly equal", "deep"))

    def estimates(values):
        return ("case", "estimate"), np.multiply.outer(np.broadcast_to(values, len(loads)), [1.0, 0.99, 1.01])

    power = np.where(deep, 1.0, 0.5)[:, None, None, None] * np.ones((2, 1, 3))
    packings = dataset(coordinates, moved=(("case", "realization"), np.full((len(loads), 20), 0.1)))
    packings.attrs["largest_move"] = 2.0
    return {
        "packings": packings,
        "means": dataset(
            coordinates | {"definition": ["half_maximum", "half_force"], "estimate": ["mean", "low", "high"],
                           "depth": [5.0, 10.0]},
            chain=estimates(60.0), contrast=estimates(np.where(near, 2.0, 1.1)), vertical=estimates(1.5),
            strongest=estimates(coordinates["angle_applied"][1]), dip=estimates(0.01),
            power=(("case", "definition", "fit", "estimate"), power),
            slope=(("case", "definition", "estimate"), power[:, :, 0]),
            stress=(("case", "depth", "x", "estimate"), np.ones((len(loads), 2, 3, 3))),
        ),
    }  # fmt: skip


def everything():
    """Datasets in which every claim holds, in every interpretation and every variant."""
    return {
        "frictionless_crossover": frictionless_study(),
        "friction_linear_range": friction_study(),
        "symmetry_breaking": breaking_study(),
        "preparation": preparation_study(),
        "slab_comparison": comparison_study(),
        "stiffness_ratio_crossover": ratio_study(),
        "theory": theory.simulate(theory.Parameters(**yaml.safe_load((ROOT / "params.yaml").read_text())["theory"])),
        "friction_fields": fields_study(),
        "pile_dip": pile_study(),
        "torque": torque_study(),
        "phase_diagram": phases_study(),
        "polydisperse_averages": means_study(),
        "superposition": superposition_study(),
        "numerics": numerics_study(),
        "sensitivity": sensitivity_study(),
        "hysteresis": hysteresis_study(),
        "influence": influence_study(),
        "crossover_scaling": scaling_study(),
        "moduli": moduli_study() | loaded_study(),
        "network": network_study(),
        "rolling_resistance": rolling_study(),
        "experiments": experiments_study(),
    }
