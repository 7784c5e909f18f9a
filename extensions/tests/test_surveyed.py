"""Packings that figure groups leave to the survey: stored, read back, and a few simulated again."""

from dataclasses import astuple

import numpy as np
import pytest
import reduced
import yaml
from places import ROOT

from granular_response.store import files as store
from granular_response.sweeps.keys import sources
from granular_response.sweeps.resources import using
from granular_response_extensions import surveyed
from granular_response_extensions.crossover_scaling.simulate import SlabEvents
from granular_response_extensions.hysteresis.simulate import PackingLoops
from granular_response_extensions.moduli.simulate.response import PackingModuli
from granular_response_paper.pipeline import simulation
from granular_response_paper.records import columns
from granular_response_paper.registry import group_member
from granular_response_paper.survey import simulate as survey

FOLDER = ROOT / "data" / "survey"
PARAMETERS = ROOT / "extensions" / "params.yaml"
GROUPS = surveyed.surveyed_groups()
OF_GROUPS = {group: simulation.parameters(group, PARAMETERS)[1] for group in GROUPS}

#: Largest difference that other sources or another machine may make, per largest value: a rearrangement a little
#: earlier or later.
SAME = 0.02

#: What a task of each group hands back.
OUTCOMES = {"moduli": PackingModuli, "crossover_scaling": SlabEvents, "hysteresis": PackingLoops}

#: The same case or series without and with a part left to the survey.
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
PARTS = {"moduli": ("cases", MODULI), "crossover_scaling": ("series", SCALING), "hysteresis": ("cases", LOOPS)}


def simulate(group, section):
    parameters = group_member(group, "parameters", "Parameters")(**section)
    with using(workers=1):
        return group_member(group, "simulate", "simulate")(parameters)


@pytest.mark.parametrize("group", GROUPS)
def test_packings_of_the_survey_are_those_that_the_group_would_make(group, tmp_path):
    """The same datasets, within single precision, whoever simulates the last surveyed."""
    section = reduced.parameters(group)
    key, own = PARTS[group]
    direct = simulate(group, section | {key: [own[0]]})
    file = tmp_path / "params.yaml"
    given = section | {key: [own[1]], "survey_file": str(tmp_path / f"{group}.nc")}
    file.write_text(yaml.safe_dump({"common": {"method": "auto"}, group: given}))
    path = survey.run(surveyed.block(group, file), tmp_path, workers=1)
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
    assert marks["block"] == group and marks["seed"] == "0" and sources(*surveyed.sources_of(group)) in marks["sources"]


def of_survey(group):
    """The tasks that a group leaves to the survey, and what is stored of them, by what tells packings apart."""
    tasks = surveyed.tasks_of(group, OF_GROUPS[group])
    return tasks, surveyed.read(FOLDER / f"{group}.nc", type(next(iter(tasks))), OUTCOMES[group])


@pytest.mark.parametrize(
    ("group", "key"),
    [
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
    for name, said in columns(type(again)).items():
        values = getattr(again, name)
        if sampled and surveyed.RAGGED in said.dims:
            continue  # at other forces
        before, near = getattr(kept, name), SAME * np.nanmax(np.abs(values))
        if name == "brackets":  # some wider than others: they overlap
            assert np.array_equal(np.isnan(before), np.isnan(values))
            low, high = np.maximum(before, values)[:, 0], np.minimum(before, values)[:, 1]
            assert not (low > high + near).any()
        else:
            np.testing.assert_allclose(before, values, atol=near, err_msg=name)


@pytest.mark.parametrize("group", GROUPS)
def test_the_packings_of_a_figure_group_are_those_that_its_parameters_leave_to_the_survey(group):
    path = FOLDER / f"{group}.nc"
    tasks, stored = of_survey(group)
    assert (PARAMETERS.parent / OF_GROUPS[group].survey_file).resolve() == path
    assert set(stored) == set(tasks)
    marks = store.read_attributes(path)
    assert marks["block"] == group
    given = simulation.parameters(group, PARAMETERS)[0]
    assert yaml.safe_load(marks["parameters"]).get("scene") == given.get("scene")
    assert path.stat().st_size < 1e6
