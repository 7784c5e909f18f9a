"""Datasets in which every claim of the paper holds, small ones, for tests that then plant wrong data."""

import numpy as np
import xarray as xr

from granular_response.state import OPEN, SLIDING, STICKING

FORCES = np.unique(np.concatenate([0.1 * 1.05 ** np.arange(141), [4.0, 5.0, 15.0, 25.0, 30.0, 40.0, 50.0]]))
X = np.linspace(-60.0, 60.0, 61)
STARTS = ["touching-largest", "2.0"]


def dataset(coords=None, sizes=None, **variables):
    """A dataset that can be stored: every variable has its labels.

    Variables are a number, or their dimensions ("case step") and values, which are broadcast to the sizes of labels and
    to further ``sizes``.
    """
    labels = {name: one if isinstance(one, tuple) else (name, one) for name, one in (coords or {}).items()}
    sizes = {dimension: len(values) for dimension, values in labels.values()} | (sizes or {})
    made = {}
    for name, one in variables.items():
        dims, values = one if isinstance(one, tuple) else ((), one)
        dims, values = dims.split() if isinstance(dims, str) else dims, np.asarray(values)
        own = dict(zip(reversed(dims), reversed(values.shape), strict=False))
        made[name] = (dims, np.broadcast_to(values, [sizes.get(dim, own.get(dim, 1)) for dim in dims]).copy())
    made = xr.Dataset(made, coords=labels)
    for name, one in made.variables.items():
        one.attrs = {"long_name": str(name), "units": "1"}
    return made


def over(dims, **values):
    """Variables along the same dimensions."""
    return {name: (dims, one) for name, one in values.items()}


def by_row(dimension, names, rows):
    """Variables along one dimension from a table."""
    columns = zip(*rows, strict=True)
    return {name: (dimension, np.array(column)) for name, column in zip(names.split(), columns, strict=True)}


def events(*rows):
    return dataset(**by_row("event", "name friction low high", rows))


#: Floor disks away from the side walls.
INSIDE = (np.abs(X) < 55.0).astype(int)

#: An elastic response.
ELASTIC = 0.07 * np.exp(-((X / 20.0) ** 2))


#: Forces of the stored states.
STATES = (0.0, 2.0, 3.0, 5.0, 10.0, 15.0, 20.0, 30.0)

#: Between which forces everything happens, by friction.
COMES = {
    "first_opening": {0.0: (0.67, 0.69), 0.2: (3.9, 3.92), 1.0: (5.6, 5.62)},
    "linear_range": {0.0: (0.88, 0.9), 0.2: (5.4, 5.5), 1.0: (7.2, 7.3)},
    "crossover": {0.0: (3.0, 3.1), 0.2: (20.1, 20.2), 1.0: (90.0, np.nan)},
    "reaches_floor": {0.0: (3.5, 3.6), 0.2: (19.0, 19.1), 1.0: (10.9, 11.0)},
    "third_peak": {0.0: (50.0, np.nan), 0.2: (38.0, 38.1), 1.0: (50.0, np.nan)},
}


def friction_linear_range():
    opened = np.round(10.0 * FORCES) * np.array([[1.0], [0.2], [0.1]])
    double = ELASTIC * (1.0 + 0.5 * (FORCES > 20.0) * np.array([[0.0], [1.0], [0.0]]))[:, :, None]
    response = {
        # one per cent off at these forces, five at five times as much
        "response_at_centre": 0.07 * (1.0 - 0.01 * FORCES / np.array([[0.9], [5.5], [7.5]])),
        "half_maximum_width": 28.0 - 0.1 * FORCES * np.array([[0.0], [0.0], [1.0]]),
        "third_peak_prominence": 0.1 * (FORCES > 38.0) * np.array([[0.0], [1.0], [0.0]]),
        "opened_contacts": opened,
        "peak_height": 0.14,
        **dict.fromkeys(("teardrop_width", "teardrop_depth"), opened),
    }
    one_side = np.where(X > 0.0, 0.08, 0.01)
    profiles = np.stack([ELASTIC, ELASTIC, one_side] + [one_side[::-1]] * 3)
    large = {
        "asymmetry": [0.001, 0.001, 1.5, 1.5, 1.2, 1.0],
        "asymmetry_sign": [1, 1, 1, -1, -1, -1],
        "network_asymmetry": [0.0, 0.0] + [0.02] * 4,
    }
    forces = [90.0, 91.0, 93.0, 150.0, 300.0, 500.0]
    away = np.array([0.8, 0.3, 0.1, 0.05, 0.0])[:, None]
    axis = {"central_dip": [0.9, 0.5, -0.01, -0.03, -0.03], "sliding_contacts": [0.0, 300.0, 200.0, 100.0, 50.0]}
    # a column of disks below the loaded one, whose contacts slide one after the other, and three disks beside it
    column = np.stack([np.zeros(14), -2.0 * np.arange(14.0)], axis=1)
    beside = column[3:6] + np.array([2.0, 0.0])
    slides = np.zeros((len(STATES), 16), bool)
    for force, upper, level in zip(STATES, (0, 1, 2, 2, 3, 5, 1, 3), (0, 0, 0, 0, 0, 0, 3, 1), strict=True):
        slides[STATES.index(force), :upper] = slides[STATES.index(force), 13 : 13 + level] = True
    status = np.full((7, 8), STICKING)
    status[1:, 6], status[3:, :6] = OPEN, OPEN
    table = events(
        *((name, mu, *ends) for name, by_friction in COMES.items() for mu, ends in by_friction.items()),
        *(("first_opening_anywhere", mu, low, low + 0.02) for mu, low in ((0.0, 0.66), (0.2, 3.8), (1.0, 5.5))),
        ("friction_crossover", np.nan, 0.15, 0.16),
    )
    return {
        "response": dataset(
            {"friction": [0.0, 0.2, 1.0], "force": FORCES, "interior": ("floor_disk", INSIDE)},
            **over("friction force", **response),
            floor_response=("friction force floor_disk", double),
        ),
        "large_forces": dataset(
            {"force": forces, "margin": [0.01, 0.05]},
            **over("force", **large),
            mobilised_contacts=("force margin", [[10, 20]] * 2 + [[1, 2]] * 4),
            floor_response=("force floor_disk", profiles),
        ),
        "large_force_states": dataset({"force": ("state", [0.0, *forces])}, contact_status=("state contact", status)),
        "friction_axis": dataset(
            {"friction": [0.0, 0.1, 0.2, 1.0, 2.0]},
            **over("friction", **axis),
            force=15.0,
            floor_response=("friction floor_disk", (1.0 - away) * ELASTIC),
        ),
        "states_mu_0.2": dataset(
            {"force": ("state", list(STATES))},
            position=("state disk axis", np.concatenate([column, beside])),
            contact_disk=("contact", [*range(13), 3, 4, 5]),
            contact_partner=("contact", [*range(1, 14), 14, 15, 16]),
            contact_status=("state contact", np.where(slides, SLIDING, STICKING)),
            loaded_disk=0,
        ),
        "events": table,
        "events_equal_rows": table.copy(deep=True),
    }


def symmetry_breaking():
    rows = [("loss_of_symmetry", 91.2, 92.0, 20.0), ("loss_of_symmetry", 91.5, 92.5, 100.0)]
    brackets = dataset(**by_row("event", "name low high ramp_time", rows))
    return {"brackets": brackets, "equal_rows": events(("loss_of_symmetry", 1.0, 91.1, 91.9))}


def preparation():
    """Gravity at once, grown slowly and without friction first; in each, events where the claims want them."""
    ways = [("at-once", 100.0, 0.5), ("slow", 20.0, 0.5), ("frictionless", 100.0, 0.5), ("at-once", 100.0, 0.25)]
    cases = [(0.0, 0.0, ways[0]), *((mu, 0.0, way) for mu in (0.2, 1.0) for way in ways), (1.0, 1.0, ways[0])]
    comes = COMES | {"loss_of_symmetry_path": {0.0: (50.0, np.nan), 0.2: (50.0, np.nan), 1.0: (91.2, 92.0)}}
    rows = [  # beside rough walls everything comes sooner
        (name, *(np.array(by_friction[mu]) * (0.5 if wall else 1.0)), mu, wall, *way)
        for mu, wall, way in cases
        for name, by_friction in comes.items()
    ]
    # four preparations of one slab: the more mobilized contacts, the sooner everything happens
    slab = over("case", polydispersity=[0.0] * 4, friction=[0.2] * 4, wall_friction=[0.0] * 4)
    return {
        "events": dataset(
            **by_row("event", "name low high friction wall_friction gravity ramp_time damping_ratio", rows)
        ),
        "mobilized": dataset(
            {"name": ["linear_range", "first_opening", "crossover"], "margin": [0.01, 0.05]},
            mobilized_part=("case margin", [[0.0], [0.0], [0.3], [0.6]]),
            force=("case name", np.outer([10.0, 9.0, 2.0, 1.0], [1.0, 2.0, 3.0])),
            **slab,
        ),
    }


def stiffness_ratio_crossover():
    ratio = np.array([0.0, 0.2, 0.3, 0.35, 0.4, 0.6, 0.8, 1.0])
    centre = np.array([0.01, 0.05, 0.064, 0.068, 0.073, 0.075, 0.076, 0.074])
    return {
        "events": events(("two_peaks_end", 10.0, 0.295, 0.3), ("central_maximum_begins", 10.0, 0.31, 0.315)),
        "response": dataset(
            {"stiffness_ratio": ratio, "interior": ("floor_disk", INSIDE)},
            floor_response=("stiffness_ratio floor_disk", centre[:, None] * np.exp(-((X / 20.0) ** 2))),
            sliding_contacts=("stiffness_ratio", np.zeros(8)),
        ),
        "elastic": dataset({"rotations": ["suppressed", "free"]}, root=("rotations", [0.2915, 3.0 / 11.0])),
    }


def friction_fields():
    x, z = np.arange(-40.0, 41.0, 2.0), np.arange(0.0, 21.0, 2.0)
    dipped = profile(np.array([0.5, -0.1, -0.1])[:, None], x)[:, None]
    by_friction = {
        "misalignment": [0.1, 20.0, 30.0],
        "axis_angle": [30.0, 12.0, 3.0],
        "axis_share": [0.02, 0.09, 0.12],
        "distance_to_lattice": [0.5, 0.1, 0.04],
        "antisymmetric_near": [0.0, 0.01, 0.03],
        "antisymmetric_near_mean": [0.0, 0.01, 0.02],
    }
    return {
        "stress": dataset(
            {"friction": [0.0, 0.2, 1.0], "x": x, "z": z},
            **over("friction", **by_friction),
            **over("friction z x", stress_xx=1.0, stress_zz=dipped, stress_xz=0.03, stress_zx=-0.03),
            stress_zz_lattice=("z x", dipped[1]),
            load_height=20.0,
        ),
        "profiles": dataset(
            {"friction": [0.0, 1.0]}, axis_magnitude=("friction row", np.array([[0.2, 0.2], [1.0, 0.995]]))
        ),
    }


#: Attributes of a file with the study of the paper's pile.
PILE = {
    "parameters": "scene: {packing: {layers: 11}, contact: {friction: 0.94, stiffness_ratio: 0.5}, "
    "wall: {friction: 0.35}, preparation: {gravity: at-once}}"
}


def pile_dip():
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


def torque():
    turned = {"torque": [0.0, 5.0]}
    near_only = [[0.0, 0.0, 0.0], [0.9, 0.7, 0.01]]
    rings = over("ring", ring_inner=[0.0, 3.0, 9.0], ring_outer=[3.0, 6.0, 12.0])
    changes = dict.fromkeys(("force_change", "stress_change", "antisymmetric_change"), near_only)
    x, z = np.arange(0.0, 41.0, 2.0), np.arange(0.0, 21.0, 2.0)
    away = np.hypot(*np.meshgrid(x - 20.0, z - 20.0))
    change = np.stack([np.zeros_like(away), np.exp(-((away / 4.0) ** 2))])
    stress = {"stress_xx": change, "stress_xz": change, "stress_zx": -change, "stress_zz": change}
    return {
        "reach": dataset({**turned, **rings}, **over("torque ring", **changes)),
        "stress": dataset({**turned, "x": x, "z": z}, **over("torque z x", **stress)),
        "torques": dataset(turned, {"disk": 1, "axis": 2}, position=("torque disk axis", 20.0), loaded_disk=0),
    }


def slab_comparison():
    names = "distance layers friction floor gravity disks_per_layer"
    rows = [(0.02, 5, 0.0, "smooth"), (0.002, 40, 0.0, "smooth"), (0.03, 5, 1.0, "rough"), (0.001, 20, 1.0, "rough")]
    return {"slabs": dataset(**by_row("slab", names, [(*row, "at-once", 8) for row in rows]))}


def numerics():
    error = [[0.1, 0.02, 1e-3], [0.1, 0.02, 1e-4]]
    damping = by_row(
        "damping_ratio",
        "relaxation_time settled beeman_limit",
        [(120.0, 1, 2e-3), (70.0, 1, 1e-3), (40.0, 1, 5.1e-4), (45.0, 1, 3e-4), (50.0, 1, 2e-4)],
    )
    means = over("realization x", stopped=[1.001, 2.002, 1.0], finished=[1.0, 2.0, 1.0])
    return {
        "stop_energy": dataset(
            {"friction": [0.0, 0.2], "stop_kinetic_energy": [1e-9, 1e-11, 1e-13]},
            **over("friction stop_kinetic_energy", rest_error=error, loaded_error=error, response_error=error),
        ),
        "at_rest": dataset(network_fixed_steps=6000.0, sliding_contacts=0.0, loose_disks=0.0),
        "swing": dataset(
            {"stop_rule": ["instantaneous", "envelope"]}, {"reading": 3}, mean_acceleration=("stop_rule reading", 1e-6)
        ),
        "disorder": dataset(sizes={"realization": 15}, **means),
        "time_step": dataset({"time_step": [5e-4, 2.5e-4]}, difference=("time_step", [0.0, 1e-5])),
        "integrators": dataset({"integrator": ["beeman", "gear"]}, difference=("integrator", [0.0, 1e-6])),
        "damping": dataset({"damping_ratio": [0.1, 0.2, 0.5, 0.8, 1.0]}, **damping),
    }


def frictionless_crossover():
    # a lattice of one open column: two disks in each row, one row above the other
    rows = [8, 7, 7, 6, 6, 6, 5]
    first = 2 * np.arange(len(rows))
    position = [p for k, row in enumerate(rows) for p in ([4.0 * k, row * 3**0.5], [4.0 * k + 2.0, row * 3**0.5])]
    slabs = over("slab", layers=[15, 20, 15, 20], normal_stiffness=[3000.0, 3000.0, 1e5, 1e5])
    wide = [[30.0, 40.0, 50.0], [29.0, 39.0, 49.0]] * 2
    crossing = over("slab bracket", crossover_bracket=[[3.0, 3.1], [6.0, 6.1]] * 2) | over("slab", open_at_rest=0)
    labels = {"force": [1.0, 2.9, 15.0], "normal_stiffness": [500.0, 1000.0, 2000.0, 3000.0, 1e5], "dip": [0.0, 0.01]}
    size, along = [[20.0, 30.0, 50.0]] + [[40.0, 60.0, 90.0]] * 4, "normal_stiffness force"
    return {
        "events": events(("crossover", 0.0, 3.0, 3.1), ("teardrop_reaches_floor", 0.0, 3.5, 3.6)),
        "response": dataset(**over("force", teardrop_depth=[1.0, 5.0, 12.0], reaches_floor=[0, 0, 0])),
        "states": dataset(
            sizes={"force": 3, "contact": len(rows)},
            teardrop=("force contact", 1),
            teardrop_horizontal=("force", 1.0),
            position=("force disk axis", position),
            **over("contact", contact_disk=first, contact_partner=first + 1),
        ),
        "sizes": dataset(slabs, disks_per_row=("slab", [61, 82, 61, 82]), **crossing),
        "regions": dataset(
            slabs, {"force": 3}, **over("slab force", teardrop_depth=wide, teardrop_width=wide, reaches_floor=0)
        ),
        "widths": dataset(slabs, disks_per_row=("slab", [61, 62, 61, 62]), **crossing),
        "stiffness": dataset(
            labels,
            **over(along, teardrop_depth=size, teardrop_width=size, reaches_floor=0),
            response_at_centre=(along, [[0.05], [0.0693], [0.07], [0.07], [0.07]]),
            crossover_bracket=("normal_stiffness bracket", [3.0, 3.03]),
            crossovers=("normal_stiffness dip bracket", [3.0, 3.03]),
        ),
    }


def profile(dip, x=None):
    """A smooth response with a dip at x = 0 of about this part of its largest value; below 0 a single peak."""
    x = np.linspace(-40.0, 40.0, 81) if x is None else x
    return np.exp(-((x / 20.0) ** 2)) - dip * np.exp(-((x / 6.0) ** 2))


def disordered_cases():
    """Coordinates of the cases: the lattice, three frictions at three disorders, the literal start, and a ramp."""
    cases = [((delta, mu, STARTS[0]), "") for delta in (0.0, 0.01, 0.1, 0.25) for mu in (0.0, 0.2, 1.0)]
    cases += [((0.01, mu, STARTS[1]), "") for mu in (0.0, 0.2)]
    cases += [((delta, 0.2, STARTS[0]), "20") for delta in (0.0, 0.01, 0.1)]
    names = "polydispersity friction lattice_constant gravity_ramp realizations"
    return by_row("case", names, [(*case, ramp, FEW) for case, ramp in cases])


#: Packings of each case.
FEW = 8

#: Draws of the planted bootstrap, the same part of the crossover in every case.
DRAWS = np.linspace(0.95, 1.05, 41)


def phase_diagram():
    cases = disordered_cases()
    rng = np.random.default_rng(0)
    grid = [[3.0, 20.0, 90.0], [2.0, 8.0, 30.0], [1.0, 5.0, 14.0], [0.5, 2.0, 8.0], [2.5, 12.0], [18.0, 8.0, 5.0]]
    force = np.array([f for row in grid for f in row])
    mu, delta = cases["friction"][1], cases["polydispersity"][1]
    n, few = len(mu), FEW
    dip = np.where(mu == 0.0, 0.8, -0.05)
    labels = {**cases, "width": [3.0, 6.0], "level": [0.025, 0.5, 0.975]}
    dips = dip[:, None] + np.array([-0.02, 0.0, 0.02])
    scatter = np.where(mu == 0.0, 0.005, 0.001)[:, None]
    each = 0.05 * rng.standard_normal((n, few, 3)) + dip[:, None, None]
    ideal = delta[:, None] == 0.0
    contacts = np.where(ideal, 6.0, 4.25 + 0.01 * rng.standard_normal((n, few)))
    crossovers = {
        "force": ("width case", force),
        "kind": ("width case", 0),
        "interval": ("width case level", force[:, None] * [0.95, 1.0, 1.05]),
        "draws": ("width case draw", force[:, None] * DRAWS),
        "limits": ("width case end", [0.01, 400.0]),
    }
    # by each of two further tolerances the same
    by_tolerance = {
        name: (dims.replace("case", "case tolerance"), np.asarray(values)[:, None] if np.ndim(values) else values)
        for name, (dims, values) in crossovers.items()
        if name != "limits"
    }
    ends = np.array([4.0, 1.0, 0.5, 0.25])
    linear = [(d, m, STARTS[0], "") for d in (0.0, 0.01, 0.1, 0.25) for m in (0.0, 0.2)]
    small = np.array([0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0])
    # packings differ by a few per cent in where they leave the linear range
    apart = 1.0 + 0.05 * rng.standard_normal((len(linear), few, 1))
    away = np.maximum(0.0, small / (apart * np.repeat(ends, 2)[:, None, None]) - 1.0)
    return {
        "crossovers": dataset(
            labels, **crossovers, seen=("width case", 0.9), seen_interval=("width case level", [0.8, 0.9, 0.95])
        ).assign_attrs(tolerance=0.01),
        "medians": dataset(labels, **crossovers),
        "definitions": dataset(labels | {"tolerance": [0.005, 0.02]}, **by_tolerance, limits=crossovers["limits"]),
        "shapes": dataset(
            labels,
            {"step": 3},
            applied_force=("case step", [0.1, 15.0, 300.0]),
            **over("width case step", shape=dip[:, None], spread=scatter),
            **over(
                "width case step level",
                shape_interval=dips[:, None],
                spread_interval=scatter[..., None] * [0.9, 1.0, 1.1],
            ),
            largest_step=("width case", 0.1),
            largest_step_interval=("width case level", [0.08, 0.1, 0.12]),
        ),
        "realizations": dataset(
            labels,
            {"realization": few, "step": 3},
            collapse_force=("case realization", np.where(np.arange(few) < 4, 20.0, np.nan)),
            **over("width case realization step", shape=each, asymmetry=0.1, difference=0.2),
        ),
        "starts": dataset(
            labels,
            dip_of_means=("width case level", dips),
            dip_of_means_interval=("width case level end", dips[..., None] + [-0.01, 0.01]),
        ),
        "packings": dataset(
            cases,
            **over(
                "case realization",
                **dict.fromkeys([f"coordination_number{kind}" for kind in ("", "_with_walls", "_bulk")], contacts),
                horizontal_contacts=np.where(ideal, 0.9, 0.3 * contacts / 4.25),
                oblique_contacts=np.where(ideal, 1.85, 1.7 * contacts / 4.25),
            ),
        ),
        "linear_range": dataset(
            by_row("case", "polydispersity friction lattice_constant gravity_ramp", linear),
            **over("case realization step", response_at_centre=0.07 * (1.0 - 0.1 * away), profile_change=0.1 * away),
            applied_force=("case step", small),
        ),
    }


def superposition():
    rng = np.random.default_rng(0)
    error = np.array([0.01, 0.1]) * rng.uniform(0.8, 1.2, (8, 2, 1))
    rows = np.array([0.1, 0.05, 0.02]) * rng.uniform(0.9, 1.1, (8, 2, 2, 1))
    ends = over("realization", linear_until=np.linspace(0.35, 0.4, 8), nonlinear_from=np.linspace(0.4, 0.45, 8))
    return {
        "errors": dataset(
            {"force": [0.2, 1.0], "distance": [2.0, 8.0], "gap": [1.0, 3.0, 5.0]},
            **over("realization distance force", floor_error_largest=error, contact_error_largest=error),
            row_error=("realization distance force gap", rows),
        ),
        "linear_range": dataset(**ends),
    }


def sensitivity():
    """Responses by the power 3/2, a tenth of the largest from those by the linear law, and with other dashpots."""
    one = dataset(
        {"variant": ["reference", "hertz", "damping_halved"]},
        floor_response=("variant floor_disk", np.stack([ELASTIC, 1.1 * ELASTIC, 1.001 * ELASTIC])),
    )
    return {"mu_0.2": one, "mu_1": one}


def hysteresis():
    """Loops that are reversible as far as the response is linear, and lose nothing a second time."""
    low = np.full((3, 3, 2), np.nan)
    low[[0, 2], 0] = [4.0, 4.1]
    low[1] = [[0.5, 0.5], [0.6, 0.58], [0.55, 0.6]]
    materials = over("case", polydispersity=[0.0, 0.1, 0.0], friction=[0.2, 0.2, 0.0])
    nothing = np.where(np.isfinite(low), 1e-4, np.nan)
    return {
        "events": dataset(
            materials | {"event": ["linear_range", "reversible_range"]},
            **over("case realization event", low=low, high=1.02 * low),
        ),
        "loops": dataset(
            materials,
            force=("case turn", [[1.0, 15.0], [3.0, np.nan], [1.0, 15.0]]),
            **over("case realization turn", work=1e4 * nothing, slid_again=nothing, floor_repeated=nothing),
            crossed_again=("case realization turn", 0.0 * nothing),
        ),
    }


def influence():
    power = np.full((6, 4, 1, 3), np.nan)
    power[:2, 0] = [1.98, 1.97, 1.99]  # a lattice: one realization, and the range over the fits
    power[2:] = np.array([1.86, 1.9, 1.92, 1.94])[:, None, None]
    cases = over("case", polydispersity=[0.0, 0.0, 0.01, 0.1, 0.25, 0.1], friction=[0.0, 0.2, 0.2, 0.2, 0.2, 0.0])
    return {"saint_venant": dataset(cases, exponent=("case realization separation fit", power))}


def crossover_scaling():
    """Powers 2 of the layers in every series."""
    series = ["constant confinement", "confined as weight", "walls", "friction 0.05", "friction 0.1", "friction 0.2"]
    labels = {"series": [*series, "constant confinement with friction 0.2"], "event": ["crossover", "reaches_floor"]}
    return {"powers": dataset(labels, exponent=("series event end", [2.0, 1.95, 2.05]))}


def moduli():
    """Two cases with friction and one without."""
    difference = np.full((2, 4, 1, 1), 0.3)
    difference[1] = 0.03 + np.array([-0.004, 0.0, 0.002, 0.004])[:, None, None]
    cases = over("case", polydispersity=[0.1, 0.01], friction=[0.2, 0.2])
    return {
        "packings": dataset(
            {**cases, "solid": ["affine", "suppressed", "free", "isotropic"]},
            {"smoothing": 2},
            layers=("case size", [8.0, 16.0]),
            difference=("case size realization solid smoothing", difference),
        ),
        "slabs": loaded_slabs(),
    }


def network():
    """Isostatic packings with exponential forces."""
    spread = np.array([-0.02, 0.0, 0.01, 0.02])[:, None]
    frictions = [0.0, 0.05, 0.2, 0.5, 1.0]
    labels = {"polydispersity": [0.01, 0.1, 0.25], "friction": frictions, "state": ["rest", "loaded"]}
    means = {
        "tail_variation": [1.0, 1.0, 1.0, 1.0, 0.95],
        "coordination_number": [4.0, 3.8, 3.5, 3.2, 3.1],
        "hyperstaticity": [0.0, 0.05, 0.05, 0.04, 0.03],
    }
    each = {name: np.array(values)[:, None, None] + spread for name, values in means.items()}
    return {"statistics": dataset(labels, **over("polydispersity friction realization state", **each))}


def rolling_resistance():
    """Piles that rolling resistance alone holds, and a Cosserat slab."""
    piles = {"layers": [5, 11], "rolling_friction": [0.0, 0.3], "ramp": [0.0, 30.0]}
    slabs = {"friction": [0.2, 1.0], "rolling_friction": [0.0, 0.5], "load": [0.5, 10.0]}
    ends, response = np.array([[0.95], [0.1]]), np.array([0.1, 0.2, 0.1]) * np.array([1.0, 1.2])[:, None, None]
    turns = slabs | {"torque": [0.001, 0.15]}
    fits, along = {"unexplained": 0.05, "length": 3.0}, "friction rolling_friction"
    turned = fits | {f"decay_{name}": value for name, value in fits.items()}
    return {
        "thresholds": dataset(
            piles, **over(" ".join(piles), low=ends, high=ends + 0.02, floor_dip=-0.01, loose_disks=2.0)
        ),
        "piles": dataset(
            {"layers": [5, 11], "case": ["supported", "free", "resisting"]}, floor_dip=("layers case", -0.01)
        ),
        "slabs": dataset(slabs, floor_response=(f"{along} load floor_disk", response), **over(f"{along} load", **fits)),
        "torques": dataset(turns, **over(f"{along} torque", **turned)),
    }


def loaded_slabs():
    """A region of r < 0 that reaches the floor at the crossover, in an incrementally elastic slab."""
    peaks = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    reach = np.array([[0.5, 0.8, 1.0], [0.0, 0.1, 0.2], [0.5, 0.8, 1.0]])
    return dataset(
        {"friction": ("slab", [0.2, 1.0, 0.0]), "width": [1.0, 2.0]},
        {"loads": 2, "step": 3},
        **over("slab step", force=[10.0, 19.0, 21.0], two_peaks=peaks),
        crossover=("slab end", [[20.0, 20.0], [21.0, np.nan], [20.0, 20.0]]),
        **over(
            "slab step width loads",
            reach=reach[..., None, None],
            difference=0.05,
            predicted_two_peaks=peaks[..., None, None],
        ),
    )


def experiments():
    """Chains of nearly equal disks that fade with disorder; widths as the root of the depth in shallow slabs alone."""
    loads = [("nearly equal", force, 90.0) for force in (150.0, 15.0, 3.0)]
    loads += [("nearly equal", 150.0, angle) for angle in (45.0, 30.0)]
    loads += [("bidisperse", force, 90.0) for force in (150.0, 15.0, 3.0)]
    loads += [("deep", force, 90.0) for force in (3.0, 1.5)]
    coordinates = by_row("case", "packing force_applied angle_applied", loads)
    near, deep = (coordinates["packing"][1] == name for name in ("nearly equal", "deep"))
    estimates = {
        "chain": 60.0,
        "contrast": np.where(near, 2.0, 1.1),
        "vertical": 1.5,
        "strongest": coordinates["angle_applied"][1],
        "dip": 0.01,
    }
    each = {name: np.asarray(value)[..., None] * [1.0, 0.99, 1.01] for name, value in estimates.items()}
    packings = dataset(coordinates, {"realization": 20}, moved=("case realization", 0.1))
    labels = {"definition": ["half_maximum", "half_force"], "estimate": ["mean", "low", "high"], "depth": [5.0, 10.0]}
    return {
        "packings": packings.assign_attrs(largest_move=2.0),
        "means": dataset(
            coordinates | labels,
            {"x": 3},
            **over("case estimate", **each),
            power=("case definition fit estimate", np.where(deep, 1.0, 0.5)[:, None, None, None]),
            stress=("case depth x estimate", 1.0),
        ),
    }


def robustness():
    """Events that hardly move with the protocol, width and stiffness; copies that lean to both sides, and a control."""
    changes = [("reference", "as in the paper"), ("protocol", "dashpots halved"), ("protocol", "dashpots doubled")]
    changes += [("protocol", "displaced copy 1"), ("width", "121 disks a row"), ("stiffness", "k_N = 10000 mg/R")]
    comes = {
        name: {**by, 0.05: mean(by[0.0], by[0.2], 0.3), 0.1: mean(by[0.0], by[0.2], 0.6)} for name, by in COMES.items()
    }
    comes["loss_of_symmetry_path"] = {1.0: (91.2, 92.0)}
    comes["first_opening_anywhere"] = {0.0: (0.66, 0.68), 0.2: (3.8, 3.82), 1.0: (5.5, 5.52)}
    rows = [
        (name, mu, *ends, *change)
        for change in changes
        for name, by_friction in comes.items()
        for mu, ends in by_friction.items()
        if not (mu == 0.0 and change[1].startswith("displaced"))
    ]
    rest = [
        ("loss_of_symmetry", 1.0, 91.2, 92.0),
        ("loss_of_symmetry", 1.0, 92.0, 93.0),
        ("crossover", 0.2, 19.8, 20.0),
    ]
    rest += [("first_opening", 0.2, 3.8, 4.0), ("first_opening", 1.0, 5.5, 5.7), ("third_peak", 0.2, 37.0, 38.0)]
    rest = [(*row, "protocol", "load ramp of 10 sqrt(R/g)") for row in rest]
    lost = ("loss_of_symmetry", 1.0, 91.2, 92.0)
    rest += [(*lost, "protocol", "displaced copy 1"), (*lost, "width", "121 disks a row")]
    columns = "name friction low high kind variant"
    lean = np.where(X > 0.0, 0.08, 0.01)
    sides = np.array([1.0, -1.0, -1.0])
    control = {"friction": [1.0, 1.0, 10.0, 10.0] * 3, "force": np.repeat([95.0, 150.0, 300.0], 4)}
    return {
        "events": dataset(**by_row("event", columns, rows)),
        "events_from_rest": dataset(**by_row("event", columns, rest)),
        "copies": dataset(
            **over("run", force=[95.0, 95.0, 96.0], asymmetry=[1.8] * 3, asymmetry_sign=sides),
            floor_response=("run floor_disk", [lean, lean[::-1], 1.01 * lean[::-1]]),
        ),
        "control": dataset(
            **over("run", **control, asymmetry=[1.5, 1.6, 0.0, 0.01] * 3, sliding_contacts=np.zeros(12)),
            opened_contacts=("run", [100.0, 101.0, 120.0, 121.0] * 3),
        ),
    }


def mean(first, second, part):
    """Between two brackets on a logarithmic scale."""
    return tuple(float(one ** (1.0 - part) * other**part) for one, other in zip(first, second, strict=True))


def parameters(claims):
    """Those that sentences are about, by group: the parameters of data in which every claim can be judged."""
    found = {}
    for claim in claims:
        found.setdefault(claim.group, {}).update(claim.requires)
    return found


#: Of every group, which each is named after.
STUDIES = (
    frictionless_crossover, friction_linear_range, symmetry_breaking, preparation, slab_comparison,
    stiffness_ratio_crossover, friction_fields, pile_dip, torque, phase_diagram, superposition, numerics,
    sensitivity, hysteresis, influence, crossover_scaling, moduli, network, rolling_resistance, experiments,
    robustness,
)  # fmt: skip


def everything():
    """Datasets in which every claim holds, in every interpretation and every variant."""
    return {study.__name__: study() for study in STUDIES}
