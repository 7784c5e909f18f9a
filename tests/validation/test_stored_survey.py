"""The stored survey: a few of its realizations simulated again, and that it holds what its parameters and notes say."""

from dataclasses import astuple, replace
from importlib.util import module_from_spec, spec_from_file_location

import numpy as np
import pytest
import yaml
from places import ROOT

from granular_response.observe.floor import smoothed_response
from granular_response.store import files as store
from granular_response_paper.ensembles import AT_REST, NOT_REACHED
from granular_response_paper.pipeline import group_member, simulation
from granular_response_paper.records import columns
from granular_response_paper.survey import packings
from granular_response_paper.survey import simulate as survey

FOLDER = ROOT / "survey"
PARAMETERS = survey.read_parameters(FOLDER / "params.yaml")
BLOCKS = list(PARAMETERS.blocks)
OF_GROUPS = {group: simulation.parameters(group, ROOT / "params.yaml")[1] for group in survey.GROUPS}

#: Largest difference of a response, smoothed with w = 3, that other sources or another machine may make, per largest
#: response: a rearrangement a little earlier or later.
SAME = 0.02


@pytest.fixture(scope="module")
def stored():
    return {block: store.read(FOLDER / "data" / f"{block}.nc") for block in BLOCKS}


@pytest.mark.parametrize(
    ("block", "polydispersity", "friction", "start", "realization"),
    [
        ("delta_1", 0.01, 0.0, "touching-largest", 3),
        ("delta_1", 0.01, 0.2, "touching-largest", 7),
        ("starts_1", 0.01, 0.2, 2.0025, 1),
        ("starts_1_friction", 0.01, 0.2, 2.0, 1),
        ("delta_10", 0.1, 0.2, "touching-largest", 5),
    ],
)
def test_a_realization_is_found_again(stored, block, polydispersity, friction, start, realization):
    cases = PARAMETERS.cases(block)
    at = [(c.polydispersity, c.friction, c.lattice_constant) for c in cases].index((polydispersity, friction, start))
    case = replace(cases[at], forces=cases[at].forces[:3])
    again = survey.ensemble_task(PARAMETERS, case, realization)()
    one = {name: data.isel(case=at, realization=realization) for name, data in stored[block].items()}
    assert (again.outcome == AT_REST).all() and (one["ensembles"]["outcome"].values[:3] == AT_REST).all()
    np.testing.assert_allclose(one["ensembles"]["x"].values[: again.x.size], again.x, atol=5e-3)
    assert one["packings"]["coordination_number"] == pytest.approx(again.packing.coordination_number, abs=0.01)
    x = np.arange(-30.0, 30.5, 1.0)
    kept_on = np.cumsum(again.loaded.lost) == 0  # where an equilibrium is lost a last digit may lead elsewhere
    assert kept_on[0]
    for k in np.flatnonzero(kept_on):
        response = one["ensembles"]["floor_response"].values[k, : again.x.size]
        kept, new = (smoothed_response(x, again.x, values, 3.0) for values in (response, again.floor_response[k]))
        np.testing.assert_allclose(kept, new, atol=SAME * np.abs(new).max())


@pytest.mark.parametrize("block", BLOCKS)
def test_what_is_stored_is_what_the_parameters_name(stored, block):
    data, cases = stored[block]["ensembles"], PARAMETERS.cases(block)
    for name, key in (("polydispersity", "polydispersity"), ("friction", "friction")):
        assert data[name].values.tolist() == [getattr(case, key) for case in cases]
    assert data["lattice_constant"].values.astype(str).tolist() == [str(case.lattice_constant) for case in cases]
    for c, case in enumerate(cases):
        force = data["force"].values[c]
        assert force[np.isfinite(force)].tolist() == list(case.forces)
        count = int(data["realizations"].values[c])
        assert 1 <= count <= case.realizations  # a run may be told to make fewer
        outcome = data["outcome"].values[c]
        assert (outcome[:count, 0] != NOT_REACHED).all()
        assert (outcome[count:] == NOT_REACHED).all()
    marks = store.read_attributes(FOLDER / "data" / f"{block}.nc")
    assert marks["block"] == block
    assert yaml.safe_load(marks["parameters"])["collapse_depth"] == PARAMETERS.collapse_depth


def of_survey(group):
    """The tasks that a group leaves to the survey, and what is stored of them, by what tells packings apart."""
    tasks = survey.tasks_of(group, OF_GROUPS[group])
    outcome = group_member(group, "simulate", "Outcome")
    return tasks, packings.read(FOLDER / "data" / f"{group}.nc", type(next(iter(tasks))), outcome)


@pytest.mark.parametrize(
    ("group", "key"),
    [
        ("peak_width", (0.0, 1.0, "frictionless", 0.0, 60, 0)),
        ("moduli", (0.1, 1.0, 16, 6)),
        ("moduli", (0.25, 1.0, 16, 9)),
        ("crossover_scaling", (21, 63, 0.0)),
        ("hysteresis", (0.1, 0.0, 6)),
    ],
)
def test_a_packing_of_a_figure_group_is_found_again(group, key):
    """``key`` may be the beginning of one."""
    tasks, stored = of_survey(group)
    key = next(one for one in tasks if astuple(one)[: len(key)] == key)
    kept, again = stored[key], tasks[key]()
    sampled = hasattr(again, "force") and len(kept.force) != len(again.force)
    for name, column in columns(type(again)).items():
        values = getattr(again, name)
        if column.later and np.isnan(getattr(kept, name)):
            continue  # not recorded
        if sampled and packings.RAGGED in column.dims:
            continue  # at other forces
        before, near = getattr(kept, name), SAME * np.nanmax(np.abs(values))
        if name == "brackets":  # some wider than others: they overlap
            assert np.array_equal(np.isnan(before), np.isnan(values))
            low, high = np.maximum(before, values)[:, 0], np.minimum(before, values)[:, 1]
            assert not (low > high + near).any()
        else:
            np.testing.assert_allclose(before, values, atol=near, err_msg=name)


@pytest.mark.parametrize("group", survey.GROUPS)
def test_the_packings_of_a_figure_group_are_those_that_its_parameters_leave_to_the_survey(group):
    path = FOLDER / "data" / f"{group}.nc"
    tasks, stored = of_survey(group)
    assert (ROOT / OF_GROUPS[group].survey_file) == path
    assert set(stored) == set(tasks)
    marks = store.read_attributes(path)
    assert marks["block"] == group
    given = simulation.parameters(group, ROOT / "params.yaml")[0]
    assert yaml.safe_load(marks["parameters"]).get("scene") == given.get("scene")
    assert path.stat().st_size < 1e6


def test_it_is_small(stored):
    assert sum(path.stat().st_size for path in (FOLDER / "data").glob("*.nc")) < 10e6


def test_the_notes_hold_its_tables():
    # by its path: the benchmarks have a module of the same name
    found = spec_from_file_location("survey_document", FOLDER / "document.py")
    document = module_from_spec(found)
    found.loader.exec_module(document)
    notes = document.NOTES.read_text(encoding="utf-8")
    fresh = document.generated.replace(notes, document.BLOCK, document.text(document.measured()))
    assert fresh == notes, "python survey/document.py"
