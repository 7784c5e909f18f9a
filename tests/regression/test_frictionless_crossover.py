"""Figs. 3 to 5 on small slabs, from parameters through a file to figures."""

import numpy as np


def test_events(datasets) -> None:
    """Each bracket is as narrow as asked and the stored states on both sides of it say the same."""
    events = datasets["events"].to_dataframe().set_index("name")
    response = datasets["response"]
    happens = {
        "first_opening": response["teardrop_depth"] > 0,
        "crossover": response["double_peaked"] > 0,
        "teardrop_reaches_floor": response["reaches_floor"] > 0,
    }
    for name, yes in happens.items():
        low, high = events.loc[name, ["low", "high"]]
        first = float(response["force"][int(yes.argmax("force"))])
        assert 0.0 < high - low <= 0.002 * first
        assert not yes.sel(force=slice(0.0, low)).any()
        assert float(response["force"][yes.values].min()) >= high


def test_certificates(datasets) -> None:
    for name in ("response", "sizes", "widths", "stiffness"):
        data = datasets[name]
        assert float(data["certificate_force_residual"].max()) < 1e-9
        assert int(data["certificate_negative_modes"].max()) == 0
        np.testing.assert_allclose(data["floor_response"].sum(data["floor_response"].dims[-1]), 1.0, rtol=1e-9)


def test_stored_states_give_the_stored_measurements(datasets) -> None:
    """What a page draws from the states is what the figures and claims are made of."""
    rest, states, response = datasets["rest"], datasets["states"], datasets["response"]
    disks = states.sizes["disk"]
    on_floor = states["wall_index"].values == 0

    def floor_force(one):
        force = np.zeros(disks)
        np.add.at(force, one["wall_disk"].values[on_floor], one["wall_normal_force"].values[on_floor])
        return force[response["floor_disk"].values]

    before = floor_force(rest.isel(state=0))
    np.testing.assert_allclose(before.sum(), disks, rtol=1e-10)
    was = rest["contact_status"].values[0] > 0
    for k, force in enumerate(states["force"].values):
        one = states.isel(force=k)
        added = (floor_force(one) - before) / force
        np.testing.assert_allclose(added, response["floor_response"].sel(force=force), atol=1e-12)
        region = one["teardrop"].values > 0
        assert np.all(was[region] & (one["contact_status"].values[region] == 0))
        assert bool(region.any()) == (float(response["teardrop_depth"].sel(force=force)) > 0.0)


def test_soft_slabs_open_later(datasets) -> None:
    """Sec. IV.C: the region of opened contacts is smaller in softer slabs, its opening is at larger forces."""
    stiffness = datasets["stiffness"]
    opening = stiffness["first_opening_bracket"].mean("bracket").values
    assert np.all(np.diff(opening) < 0.0)
    assert np.all(np.diff(stiffness["teardrop_depth"].sel(force=1.0).values) >= -0.01)
