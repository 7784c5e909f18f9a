"""Figs. 23 and 24 on small slabs, from parameters through a file to figures."""

import numpy as np
import reduced

from granular_response.scene import Scene
from granular_response.sweeps.rest import rest_of
from granular_response_paper.groups.superposition.simulate import loads as study

PARAMETERS = reduced.parameters("superposition")


def test_paths_agree_with_the_protocol_of_the_paper(datasets) -> None:
    """Dynamics from rest to the force, in place of a path: a different history, nearly the same responses."""
    changes = {"protocol.method": "dynamics", "protocol.ramp_time": 20.0, "loads": []}
    scene = Scene().updated({**PARAMETERS["scene"], **changes})
    pair = study.load_pair(scene, rest_of(scene), 4, (0.2,))
    assert pair.by_motion.all()
    slow = datasets["responses"]["floor_response"].isel(realization=0, distance=1).sel(force=0.2).values
    np.testing.assert_allclose(pair.floor_response[0], slow, atol=0.01 * slow.max())
