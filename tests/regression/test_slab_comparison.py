"""Small forces on small slabs beside the elastic slab, from parameters through a file to the figure."""

import numpy as np


def test_deeper_slabs_are_nearer_to_the_elastic_one(datasets) -> None:
    slabs = datasets["slabs"]
    distance = slabs["distance"].values
    for first, last in ((0, 2), (3, 4), (5, 6)):
        assert distance[last] < 0.5 * distance[first] < 0.03
    # the right floor is told from the wrong one
    assert (distance < 0.4 * slabs["distance_other_floor"].values).all()


def test_the_floor_bears_the_whole_force_where_walls_are_smooth(datasets) -> None:
    slabs = datasets["slabs"]
    smooth = slabs["floor"].values == "smooth"
    np.testing.assert_allclose(slabs["floor_response"].sum("floor_disk").values[smooth], 1.0, atol=1e-8)
