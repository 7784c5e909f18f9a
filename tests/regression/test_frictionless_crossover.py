"""Figs. 3 to 5 on small slabs, from parameters through a file to figures."""

import numpy as np

from granular_response_paper.groups.frictionless_crossover import draw as figures

STEMS = [
    "fig03_frictionless_response",
    "fig04_frictionless_contacts",
    "fig05_teardrop",
    "fig05b_stiffness",
    "fig05c_depth",
]


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


def test_one_slab_has_one_result(datasets) -> None:
    """The same slab in two tables was solved once."""
    forces = [0.5, 1.0]
    tables = [
        datasets["response"].sel(force=forces),
        datasets["sizes"].isel(slab=0).sel(force=forces),
        datasets["widths"].isel(slab=0).sel(force=forces),
        datasets["stiffness"].sel(normal_stiffness=3000.0, force=forces),
    ]
    for data in tables[1:]:
        places = tables[0].sizes["floor_disk"]
        np.testing.assert_array_equal(data["floor_response"][:, :places], tables[0]["floor_response"])


def test_soft_slabs_open_later(datasets) -> None:
    """Sec. IV.C: the region of opened contacts is smaller in softer slabs, its opening is at larger forces."""
    stiffness = datasets["stiffness"]
    opening = stiffness["first_opening_bracket"].mean("bracket").values
    assert np.all(np.diff(opening) < 0.0)
    assert np.all(np.diff(stiffness["teardrop_depth"].sel(force=1.0).values) >= -0.01)


def test_figures(datasets) -> None:
    drawn = figures.draw(datasets)
    assert list(drawn) == STEMS
    profiles, _ = drawn["fig03_frictionless_response"].axes
    response = datasets["response"]
    inside = response["interior"].values > 0
    np.testing.assert_array_equal(
        profiles.lines[0].get_ydata(), response["floor_response"].sel(force=0.25).values[inside]
    )
    networks = [axes for axes in drawn["fig04_frictionless_contacts"].axes if axes.get_title(loc="left")]
    assert len(networks) == len(figures.nearest(response["force"].values, figures.NETWORK_FORCES))
    curve = drawn["fig05_teardrop"].axes[0].lines[0]
    depth = datasets["sizes"]["teardrop_depth"][0].values
    np.testing.assert_array_equal(curve.get_ydata(), depth[: len(curve.get_ydata())])
