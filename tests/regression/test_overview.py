"""The overview at reduced size: the elastic limit, the packings, and the animation beside the pictures."""

import reduced
from PIL import Image

from granular_response_paper.pipeline import drawing


def test_the_animation_stands_beside_its_picture(tmp_path, tmp_path_factory):
    paths = drawing.draw("overview", reduced.stored("overview", tmp_path_factory), tmp_path)
    assert tmp_path / "growing_force.gif" in paths and (tmp_path / "growing_force.png").exists()
    with Image.open(tmp_path / "growing_force.gif") as image:
        assert image.n_frames == 3
