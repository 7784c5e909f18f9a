"""Any valid scene survives YAML; any other input is a SceneError of one line."""

import re

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene, SceneError

MANY = settings(suppress_health_check=[HealthCheck.too_slow])


def numbers(low=0.0, high=1e6, *, open_low=False):
    return st.floats(low, high, exclude_min=open_low, allow_subnormal=True)


def options(**fields):
    return st.fixed_dictionaries({}, optional=fields)


index = st.integers(0, 2**63 - 1)
finite = st.floats(allow_nan=False, allow_infinity=False)
disorder = {
    "polydispersity": st.floats(0.0, 1.0, exclude_max=True),
    "lattice_constant": st.just("touching-largest") | st.floats(0.0, 1000.0, exclude_min=True),
    "seed": index,
    "realization": index,
}
names = st.text(min_size=1).filter(lambda text: text.isprintable() and text.strip())


def carried(data):
    """A scene without torques that nothing could balance."""
    contact, wall = data.get("contact", {}), data.get("wall", {})
    ratio = contact.get("stiffness_ratio", 0.8)
    wall_ratio = wall.get("stiffness_ratio")
    rubs = (
        contact.get("friction", 0.2) * ratio > 0.0
        or wall.get("friction", 0.0) * (ratio if wall_ratio is None else wall_ratio) > 0.0
    )
    if "loads" in data and not rubs:
        data["loads"] = [{key: value for key, value in load.items() if key != "torque"} for load in data["loads"]]
    return data


slabs = st.fixed_dictionaries(
    {"kind": st.just("slab")},
    optional={**disorder, "layers": st.integers(10, 40), "disks_per_row": st.integers(20, 60)},
)
piles = st.fixed_dictionaries({"kind": st.just("pile")}, optional={**disorder, "layers": st.integers(10, 20)})
files = st.fixed_dictionaries({"kind": st.just("file"), "path": names, "width": st.floats(0.0, 1e9, exclude_min=True)})
stiffness = st.floats(0.0, 5e11, exclude_min=True)
pushes = {"force": st.lists(finite, min_size=2, max_size=2)}
moves = {"displacement": st.tuples(finite, st.none() | finite).map(list)}
disk = st.just("top-centre") | st.integers(0, 100)
loads = st.lists(
    st.one_of(st.fixed_dictionaries({"disk": disk, **by}, optional={"torque": finite}) for by in (pushes, moves)),
    max_size=3,
)
scenes = options(
    packing=slabs | piles | files,
    contact=options(normal_stiffness=stiffness, stiffness_ratio=numbers(), friction=numbers(), damping_ratio=numbers()),
    wall=options(
        normal_stiffness=st.none() | st.floats(0.0, 1e12, exclude_min=True),
        stiffness_ratio=st.none() | numbers(),
        friction=numbers(),
        damping_ratio=st.none() | numbers(),
    ),
    loads=loads,
    preparation=options(gravity=st.sampled_from(["at-once", "slow", "frictionless"]), ramp_time=numbers(open_low=True)),
    protocol=options(
        method=st.sampled_from(["auto", "dynamics", "path", "minimise"]),
        integrator=st.sampled_from([*INTEGRATORS]),
        time_step=st.just("auto") | numbers(open_low=True),
        ramp_time=numbers(),
        stop_kinetic_energy=numbers(open_low=True),
        stop_rule=st.sampled_from(["instantaneous", "envelope"]),
        static_finish=st.booleans(),
        friction_law=st.sampled_from(["cut", "literal", "unloading"]),
        tensile_dashpot=st.booleans(),
        maximum_steps=st.integers(1),
    ),
).map(carried)

#: Keys of a scene and some of their values.
words = st.sampled_from(
    sorted({*re.findall(r"[a-z][\w-]+", Scene().to_yaml()), "pile", "file", "path", "width", "row", "offset", "top"})
)
anything = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.just(10**400)
    | st.floats()
    | st.text()
    | words
    | st.binary(max_size=3)
    | st.just(object),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.tuples(inner, inner)
        | st.frozensets(words, max_size=2)
        | st.dictionaries(words | st.text(max_size=3) | st.integers() | st.none(), inner, max_size=5)
    ),
    max_leaves=30,
)


def scene_or_error(make, *arguments):
    try:
        assert isinstance(make(*arguments), Scene)
    except SceneError as error:
        assert str(error).strip() and len(str(error).splitlines()) == 1


@MANY
@given(scenes)
def test_valid_scenes_survive_yaml(data):
    scene = Scene.from_dict(data)
    text = scene.to_yaml()
    again = Scene.from_text(text)
    assert again == scene
    assert again.to_yaml() == text
    assert again.resolved_wall == scene.resolved_wall


@MANY
@given(scenes, st.lists(st.tuples(st.integers(0, 10**6), anything), min_size=1, max_size=2))
def test_valid_scenes_with_a_value_replaced(data, changes):
    """Reaches the validators of nested fields, which random data seldom do."""
    complete = Scene.from_dict(data).to_dict()
    for number, value in changes:
        paths = list(leaves(complete))
        *way, last = paths[number % len(paths)]
        target = complete
        for part in way:
            target = target[part]
        target[last] = value
    scene_or_error(Scene.from_dict, complete)


def leaves(data, path=()):
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from leaves(value, (*path, key))
