"""The survey's parameters, that its runs go on where they were, and packings that it makes for figure groups."""

import numpy as np
import pytest
import reduced
import yaml
from places import ROOT

from granular_response.scene import SceneError
from granular_response.store import files as store
from granular_response.sweeps.resources import using
from granular_response_paper.datasets import labelled
from granular_response_paper.ensembles import AT_REST
from granular_response_paper.pipeline import group_member
from granular_response_paper.records import column, record
from granular_response_paper.survey import packings
from granular_response_paper.survey import simulate as survey

SMALL = {
    "method": "auto",
    "scene": {
        "packing": {"layers": 4, "disks_per_row": 9, "lattice_constant": "touching-largest"},
        "protocol": {"integrator": "verlet", "stop_kinetic_energy": 1e-9, "maximum_steps": 200_000},
    },
    "time_step_part": 0.9,
    "longest_time_step": 1e-3,
    "collapse_depth": 2.0,
    "realizations": 3,
    "blocks": {
        "small": [
            {"polydispersities": [0.01], "frictions": [0.0, 0.2], "forces": [0.5, 5.0], "wall_friction": 0.0},
            {"polydispersities": [0.0], "frictions": [0.0], "forces": [0.5], "lattice_constants": [2.0]},
        ],
    },
}


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "params.yaml"
    path.write_text(yaml.safe_dump(SMALL))
    return path


def test_the_cases_of_a_block_are_all_combinations():
    parameters = survey.Parameters(**SMALL)
    cases = parameters.cases("small")
    assert [(c.polydispersity, c.friction, c.lattice_constant, c.realizations, c.wall_friction) for c in cases] == [
        (0.01, 0.0, "touching-largest", 3, 0.0),
        (0.01, 0.2, "touching-largest", 3, 0.0),
        (0.0, 0.0, 2.0, 1, None),  # a lattice has one
    ]


def test_a_run_goes_on_where_it_was_and_stores_what_was_found(file):
    begun = []
    survey.run(survey.ensemble("small", file, 2), file.parent, workers=1, progress=lambda *call: begun.append(call))
    assert begun[0][:2] == (0, 5)
    begun.clear()
    block = survey.ensemble("small", file)
    path = survey.run(block, file.parent, workers=1, progress=lambda *call: begun.append(call))
    assert begun[0][:2] == (5, 7)  # the third ones alone

    found = store.read(path)
    one = found["ensembles"].isel(case=1, realization=2)
    again = block.tasks[1, 2]()
    assert (one["outcome"].values[:2] == AT_REST).all()
    np.testing.assert_allclose(one["floor_response"].values[:2], again.floor_response, atol=2.0**-18, rtol=1e-7)
    np.testing.assert_allclose(one["x"].values, again.x, atol=2.0**-13, rtol=1e-7)
    assert one["wall_friction"] == 0.0
    packing = found["packings"].isel(case=1, realization=2)
    for name in survey.PACKINGS:
        np.testing.assert_equal(packing[name].values, np.float32(getattr(again.packing, name)))
    marks = store.read_attributes(path)
    assert marks["block"] == "small" and marks["seed"] == "0" and "collapse_depth" in marks["parameters"]
    assert survey.sources(*survey.SOURCES) in marks["sources"]


def test_mistakes_are_one_line_each(file, tmp_path):
    with pytest.raises(survey.SurveyError, match=r"^block large: there is none of this name, must be one of small$"):
        survey.ensemble("large", file)
    with pytest.raises(survey.SurveyError, match=r"none\.yaml: cannot be read"):
        survey.read_parameters(tmp_path / "none.yaml")
    file.write_text(yaml.safe_dump({**SMALL, "realizations": 0}))
    with pytest.raises(SceneError, match=r"params\.yaml: realizations = 0"):
        survey.read_parameters(file)


def test_the_survey_extends_the_ensembles_of_the_pipeline():
    """Scene, protocol and seeds are those of polydisperse_averages."""
    pipeline = yaml.safe_load((ROOT / "params.yaml").read_text())["polydisperse_averages"]
    own = yaml.safe_load((ROOT / "survey" / "params.yaml").read_text())
    for key in ("scene", "time_step_part", "longest_time_step", "collapse_depth"):
        assert own[key] == pipeline[key]


def test_its_pipeline_names_a_stage_and_the_sources_of_every_block():
    stage = yaml.safe_load((ROOT / "survey" / "dvc.yaml").read_text())["stages"]["simulate"]
    declared = {path.removeprefix("../src/").removeprefix("granular_response/") for path in stage["do"]["deps"]}
    assert {*survey.SOURCES, "granular_response_paper/survey"} <= declared
    assert stage["foreach"] == "${blocks}"
    stage = yaml.safe_load((ROOT / "survey" / "dvc.yaml").read_text())["stages"]["packings"]
    declared = {path.removeprefix("../src/").removeprefix("granular_response/") for path in stage["do"]["deps"]}
    assert {*survey.sources_of("${item}"), "granular_response_paper/survey"} <= declared
    assert stage["foreach"] == list(survey.GROUPS)


@record
class Slab:
    """What tells a packing from others."""

    friction: float = column("coefficient of friction")
    layers: int = column("number of rows")


@record
class Measured:
    """What a group might measure on a packing."""

    height: float = column("height")
    depth: np.ndarray = column("depth", "line")
    profile: np.ndarray = column("profile", "line", "t")


@record
class More(Measured):
    single: float = column("another")


@record
class Later(Measured):
    single: float = column("another", later=True)


def measured(lines):
    return Measured(10.0 + lines, np.arange(float(lines)), np.linspace(0.0, 1.0, 3 * lines).reshape(lines, 3))


def test_packings_are_read_as_they_were_stored(tmp_path):
    """With different numbers of lines, in single precision; what filled them up is gone."""
    given = {Slab(0.2, 20): measured(4), Slab(0.2, 40): measured(6)}
    path = tmp_path / "group.nc"
    store.write(path, labelled({packings.DATASET: packings.dataset(given)}))
    found = packings.read(path, Slab, Measured)
    assert list(found) == list(given)
    for key, one in given.items():
        assert found[key].height == one.height
        np.testing.assert_allclose(found[key].depth, one.depth, rtol=1e-7)
        np.testing.assert_allclose(found[key].profile, one.profile, rtol=1e-7)
    (found,) = packings.chosen(str(path), Measured, {"deep": Slab(0.2, 40)}).items()
    assert found[0] == "deep" and found[1].depth.size == 6
    assert packings.chosen(None, Measured, {}) == {}
    with pytest.raises(store.StoreError, match=r"has no packing of friction 0\.5, layers 20; make survey"):
        packings.chosen(str(path), Measured, {"one": Slab(0.2, 20), "other": Slab(0.5, 20)})
    with pytest.raises(store.StoreError, match=r"is no file of packings of the survey, lacks single"):
        packings.read(path, Slab, More)


def test_a_number_that_files_of_earlier_versions_lack_is_not_recorded(tmp_path):
    path = tmp_path / "group.nc"
    given = packings.dataset({Slab(0.2, 20): measured(4)})
    store.write(path, labelled({packings.DATASET: given}))
    (found,) = packings.read(path, Slab, Later).values()
    assert np.isnan(found.single) and found.depth.size == 4


#: The same case or series without and with a part left to the survey.
WIDTHS = (
    {"polydispersity": 0.0, "friction": 0.0, "layers": [4, 5, 6]},
    {"polydispersity": 0.0, "friction": 0.0, "layers": [4, 5], "surveyed": [6]},
)
MODULI = (
    {"polydispersity": 0.1, "friction": 0.2, "layers": [5], "realizations": [3]},
    {"polydispersity": 0.1, "friction": 0.2, "layers": [5], "realizations": [2], "surveyed": [1]},
)
SCALING = (
    {"name": "one", "friction": 0.2, "confined": "as weight", "layers": [5, 7]},
    {"name": "one", "friction": 0.2, "confined": "as weight", "layers": [5], "surveyed": [7]},
)
LOOPS = (
    {"polydispersity": 0.1, "friction": 0.2, "forces": [0.3, 1.0], "increments": 2, "realizations": 2},
    {"polydispersity": 0.1, "friction": 0.2, "forces": [0.3, 1.0], "increments": 2, "surveyed": 1},
)
PARTS = {
    "peak_width": ("cases", WIDTHS),
    "moduli": ("cases", MODULI),
    "crossover_scaling": ("series", SCALING),
    "hysteresis": ("cases", LOOPS),
}


def simulate(group, section):
    parameters = group_member(group, "parameters", "Parameters")(**section)
    with using(workers=1):
        return group_member(group, "simulate", "simulate")(parameters)


@pytest.mark.parametrize("group", survey.GROUPS)
def test_packings_of_the_survey_are_those_that_the_group_would_make(group, tmp_path):
    """The same datasets, within single precision, whoever simulates the last packings."""
    section = reduced.parameters(group)
    key, own = PARTS[group]
    direct = simulate(group, section | {key: [own[0]]})
    file = tmp_path / "params.yaml"
    given = section | {key: [own[1]], "survey_file": str(tmp_path / "data" / f"{group}.nc")}
    file.write_text(yaml.safe_dump({"common": {"method": "auto"}, group: given}))
    path = survey.run(survey.packings_of(group, file), tmp_path, workers=1)
    assert str(path) == given["survey_file"]
    stored = simulate(group, given)
    for name, data in direct.items():
        for key, values in data.data_vars.items():
            if key == "surveyed":
                assert not values.any() and stored[name][key].any()
            elif values.dtype.kind == "U":
                np.testing.assert_array_equal(stored[name][key], values)
            else:
                np.testing.assert_allclose(stored[name][key], values, rtol=1e-4, atol=1e-5, err_msg=key)
    marks = store.read_attributes(path)
    assert (
        marks["block"] == group
        and marks["seed"] == "0"
        and survey.sources(*survey.sources_of(group)) in marks["sources"]
    )
