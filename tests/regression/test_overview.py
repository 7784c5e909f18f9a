"""The overview at reduced size: the elastic limit, the packings, and the animation beside the pictures."""

import numpy as np
import reduced
from PIL import Image

from granular_response_paper.pipeline import drawing


def test_the_response_to_the_smallest_force_is_the_elastic_one(datasets):
    for k in range(2):
        slab = datasets[f"slab_{k}"]
        assert float(slab["friction"]) == [0.0, 0.5][k]
        elastic, response = slab["elastic_response"].values, slab["floor_response"].values
        np.testing.assert_allclose(elastic.sum(), 1.0, atol=1e-9)  # the walls do not rub
        assert np.abs(response[0] - elastic).max() < np.abs(response[-1] - elastic).max()


def test_the_animation_stands_beside_its_picture(tmp_path, tmp_path_factory):
    paths = drawing.draw("overview", reduced.stored("overview", tmp_path_factory), tmp_path)
    assert tmp_path / "growing_force.gif" in paths and (tmp_path / "growing_force.png").exists()
    with Image.open(tmp_path / "growing_force.gif") as image:
        assert image.n_frames == 3
