"""What a motion is asked for: keys, columns, times, and the film of it."""

import numpy as np
import pytest
from refusals import refusals, refuses

import granular_response as gr

BALL = gr.Scene.from_arrays(x=[5.0], z=[3.0], radius=1.0, width=10.0, vx=0.5, scene={"loads": []})
TABLE = "x,z,radius,vx,spin\n2,1,1,0.5,1\n5,1,1,,2\n"


test_times_are_numbers_in_order = refusals(
    gr.SceneError,
    (lambda: gr.motion(BALL, [1.0, 0.5]), r"^times\[1\] = 0.5: must be 0 or more, and more than the one before"),
    (lambda: gr.motion(BALL, [-1.0, 2.0]), r"^times\[0\] = -1: must be 0 or more"),
    (lambda: gr.motion(BALL, ["soon"]), r"^times = \['soon'\]: must be a list of one or more finite numbers"),
    (lambda: gr.motion(BALL, {0.0, 1.0}), r"^times = \{0.0, 1.0\}: must be a list"),
    (
        lambda: gr.motion(BALL, [1e9]),
        r"^times: 1e\+09 is 1.48e\+13 steps of 6.75963e-05, must be at most protocol.maximum_steps = 5000000",
    ),
)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"motion.vx": "fast"}, r"motion.vx = 'fast': must be a finite number, a list of one for each disk, or column"),
        ({"motion.vz": [0.0, 1.0]}, r"motion.vz = \[0.0, 1.0\]: must have one number for each of the 1 disks, has 2"),
        ({"motion.vz": "column"}, r"motion.vz = 'column': must be numbers, the packing is not from a file"),
        ({"motion.spin": 1.0, "contact.friction": 0.0}, r"motion.spin = 1.0: must be 0 without friction"),
    ],
)
def test_a_motion_that_is_none_is_refused_by_its_key(changes, said):
    refuses(gr.SceneError, f"^{said}", BALL.updated, changes)


@pytest.mark.parametrize("method", ["auto", "dynamics", "path", "minimise"])
def test_statics_refuses_a_motion(method):
    with pytest.raises(gr.SceneError, match=r"^motion.vx: must be left out, .*gr.motion follows it$"):
        gr.solve(BALL.updated({"protocol.method": method}))
    if method in ("path", "minimise"):
        with pytest.raises(gr.SceneError, match=rf"^protocol.method = '{method}': must be auto or dynamics"):
            gr.motion(BALL.updated({"protocol.method": method}), [1.0])


def test_a_scene_without_loads_moves_whatever_its_load_factors():
    """So that of any result does, without its loads: ``gr.motion(result.scene.updated({"loads": []}), ...)``."""
    twice = {"protocol.load_factors": [1.0, 2.0]}
    assert gr.motion(BALL.updated(twice), [0.0, 1.0])["position"].equals(gr.motion(BALL, [0.0, 1.0])["position"])
    with pytest.raises(gr.SceneError, match=r"^protocol.load_factors = \[1.0, 2.0\]: must be left out for a motion"):
        gr.motion(BALL.updated({**twice, "loads": [gr.Load(disk=0, force=(0.0, -1.0))]}), [0.0, 1.0])


def test_a_scene_without_a_motion_is_written_as_ever():
    still = {"motion.spin": [0.0], "contact.friction": 0.0}  # where no contact turns a disk, it may stand still
    assert BALL.updated(still).motion.spin == (0.0,)
    assert "motion" not in gr.Scene().to_dict()
    assert gr.Scene.from_text(BALL.to_yaml()) == BALL and BALL.to_dict()["motion"] == {"vx": 0.5}


def test_columns_of_a_table_are_taken_where_the_scene_asks_for_them(tmp_path):
    (tmp_path / "disks.csv").write_text(TABLE)
    packing = {"kind": "file", "path": "disks.csv", "width": 10.0}
    base = gr.Scene.from_dict({"packing": packing, "loads": []}, folder=tmp_path)
    turning = gr.motion(base.updated({"motion.spin": "column", "motion.vx": 0.1}), [0.0], progress=False)
    assert turning["angular_velocity"].values.tolist() == [[1.0, 2.0]]
    assert turning["velocity"].values[0].tolist() == [[0.1, 0.0], [0.1, 0.0]]
    assert not gr.motion(base, [0.0], progress=False)["velocity"].any()  # as before: further columns are ignored
    with pytest.raises(gr.SceneError, match=r"^motion.vx = 'column': column vx: must be a finite number .* disk 1 "):
        gr.motion(base.updated({"motion.vx": "column"}), [0.0])
    with pytest.raises(gr.SceneError, match=r"^motion.vz = 'column': must be .* with a column vz in reduced units$"):
        gr.motion(base.updated({"motion.vz": "column"}), [0.0])


def test_a_film_of_a_motion(tmp_path):
    moved = gr.motion(BALL, [0.0, 0.5, 1.0], progress=False)
    film = gr.plot.motion(moved, output=tmp_path / "fall.gif", width=2.0)
    assert (tmp_path / "fall.gif").read_bytes()[:4] == b"GIF8"
    (axes,) = film._fig.axes
    film._func(2)
    (disks,) = [one for one in axes.collections if type(one).__name__ == "EllipseCollection"]
    np.testing.assert_allclose(disks.get_offsets(), moved["position"].values[2])
    for wrong in (moved.isel(time=0), moved.isel(time=[0]), BALL):
        refuses(gr.plot.PictureError, r"^moved: ", gr.plot.motion, wrong)
    refuses(gr.plot.PictureError, r"format '.avi' is unknown", gr.plot.motion, moved, output="fall.avi")
