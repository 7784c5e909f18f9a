"""Figs. 2 and 19 to 21 on slabs of 5 layers, from parameters through a file to figures."""

import numpy as np
import reduced

from granular_response_paper.ensembles import AT_REST, COLLAPSED, FAILED, NOT_REACHED, realizations
from granular_response_paper.groups.polydisperse_averages import draw
from granular_response_paper.groups.polydisperse_averages import simulate as study

PARAMETERS = reduced.parameters("polydisperse_averages")


def test_collapse_and_failure_are_reported() -> None:
    parameters = study.Parameters(**PARAMETERS)
    case = study.Case(0.25, 0.2, "touching-largest", (5.0, 60.0, 80.0), 1)
    # so shallow that every load collapses the packing, but the one that moves nothing
    scene = realizations.ensemble_scene(parameters, case, 0)
    found = realizations.realize(scene, (0.01, 5.0, 10.0), 1e-3)
    assert found.outcome.tolist() == [AT_REST, COLLAPSED, NOT_REACHED]
    assert np.isfinite(found.floor_response[0]).all()
    assert np.isnan(found.floor_response[1:]).all()

    failed = realizations.realize(scene.updated({"protocol.maximum_steps": 100}), (1.0, 2.0), 1e-3)
    assert failed.outcome.tolist() == [FAILED, NOT_REACHED]
    assert failed.message.startswith("gravity: ")


def test_the_caption_counts_the_frictions_at_which_disorder_shortens_the_linear_range(datasets) -> None:
    data = datasets["linear_range"]
    lattice = data["polydispersity"] == 0.0
    for until, times in ((1.0, data["friction"].to_index().nunique()), (9.0, 0)):
        other = data.assign(linear_until=lattice * 5.0 + ~lattice * until)
        parameters = study.Parameters(**PARAMETERS)
        caption = draw.captions({**datasets, "linear_range": other}, parameters)["fig20_disordered_linear_range"]
        assert f"shorter than that of the lattice at {times} of" in str(caption)
