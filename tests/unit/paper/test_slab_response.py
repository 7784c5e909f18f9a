"""What is measured on loaded slabs, put together."""

from dataclasses import replace

from granular_response.scene import Scene
from granular_response.studies import LoadPath, Measures
from granular_response_paper import slab_response


def test_measurements_fit_together_where_few_states_have_disks_that_nothing_determines():
    described = Scene().updated({"packing": {"layers": 4, "disks_per_row": 11}, "loads.0.force": [0.0, -1.0]})
    path = LoadPath.of(described)
    state, measures = path.at(0.1), Measures(path)
    loose = replace(state, reached=replace(state.reached, certificate=replace(state.certificate, undetermined=(2,))))
    found = [slab_response.measured(measures, [one]) for one in (state, loose, state)]
    assert slab_response.measured_along("force", found).sizes["force"] == 3
    assert slab_response.measured_along("force", found[1:]).sizes["force"] == 2
