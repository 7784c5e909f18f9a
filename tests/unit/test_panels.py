"""What the figures of several groups repeat."""

import numpy as np
import xarray as xr

from granular_response.plot import style
from granular_response.state import FLOOR, LEFT_WALL
from granular_response_paper import panels


def test_names_beside_curves_do_not_cover_each_other():
    axes = style.figure()[1][0, 0]
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    panels.label_ends(axes, [("high", 0.5, 0.52, "black"), ("low", 0.5, 0.5, "black"), ("far", 0.5, 0.9, "black")])
    axes.figure.draw_without_rendering()
    low, high, far = (one.get_window_extent() for one in axes.texts)
    assert [text.get_text() for text in axes.texts] == ["low", "high", "far"]
    assert low.y1 <= high.y0 + 2.0 and high.y1 < far.y0


def test_lines_of_forces_and_their_key_have_one_scale():
    """Length and width are proportional to the force, as the captions of Figs. 2, 13 and 17 ask."""
    axes = style.figure()[1][0, 0]
    along = np.array([[0.6, 0.8], [1.0, 0.0]])
    contacts = panels.Contacts(np.array([[1.0, 2.0], [5.0, 2.0]]), along)
    panels.forces(axes, contacts, np.array([[3.0, 4.0], [2.5, 0.0]]), 5.0)
    panels.force_key(axes, (8.0, 6.0), 1.0, 5.0, style.WEIGHT)
    drawn, key = axes.collections
    length = np.linalg.norm(np.diff(np.array([*drawn.get_segments(), *key.get_segments()]), axis=1)[:, 0], axis=1)
    np.testing.assert_allclose(length, panels.LONGEST * np.array([1.0, 0.5, 0.2]))
    width = np.concatenate([drawn.get_linewidth(), key.get_linewidth()])
    np.testing.assert_allclose(width, panels.WIDEST * np.array([1.0, 0.5, 0.2]))
    panels.forces(axes, contacts, np.zeros((2, 2)), 0.0)
    assert len(axes.collections) == 2


def test_contacts_with_walls_come_last_and_their_normals_point_inwards():
    data = xr.Dataset(
        {
            "radius": ("disk", [1.0, 1.0]), "contact_disk": ("contact", [0]), "contact_partner": ("contact", [1]),
            "wall_disk": ("wall_contact", [0, 1]), "wall_index": ("wall_contact", [FLOOR, LEFT_WALL]),
        }
    )  # fmt: skip
    found = panels.Contacts.of(data, np.array([[3.0, 1.0], [1.0, 1.0]]))
    np.testing.assert_allclose(found.point, [[2.0, 1.0], [3.0, 0.0], [0.0, 1.0]])
    np.testing.assert_allclose(found.normal, [[2.0, 0.0], [0.0, 1.0], [1.0, 0.0]])
