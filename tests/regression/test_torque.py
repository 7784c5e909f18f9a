"""Fig. 18 on a slab of 5 layers, from parameters through a file to figures."""

import numpy as np


def test_loads_are_balanced(datasets) -> None:
    """The contacts of the loaded disk take up the applied force and the clockwise torque."""
    data = datasets["torques"]
    disk = int(data["loaded_disk"])
    first, second = data["contact_disk"].values, data["contact_partner"].values
    np.testing.assert_allclose(data["applied_force"], 10.0 * np.array([np.cos(np.pi / 6), -0.5]))
    for index in range(3):
        added = data["contact_added_force"].values[index]
        force = added[first == disk].sum(axis=0) - added[second == disk].sum(axis=0)
        np.testing.assert_allclose(force, -data["applied_force"], atol=1e-8)
    assert np.all(np.diff(data["rotation"]) < 0.0)
