"""The stored survey: a few of its realizations simulated again, and that it holds what its parameters and notes say."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from places import ROOT

from granular_response.observe.floor import smoothed_response
from granular_response.store import files as store
from granular_response_paper.ensembles import AT_REST, NOT_REACHED
from granular_response_paper.survey import simulate as survey

FOLDER = ROOT / "data" / "survey"
PARAMETERS = survey.read_parameters(FOLDER / "params.yaml")
BLOCKS = list(PARAMETERS.blocks)

#: Largest difference of a response, smoothed with w = 3, that other sources or another machine may make, per largest
#: response: a rearrangement a little earlier or later.
SAME = 0.02


@pytest.fixture(scope="module")
def stored():
    return {block: store.read(FOLDER / f"{block}.nc") for block in BLOCKS}


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
    marks = store.read_attributes(FOLDER / f"{block}.nc")
    assert marks["block"] == block
    assert yaml.safe_load(marks["parameters"])["collapse_depth"] == PARAMETERS.collapse_depth
