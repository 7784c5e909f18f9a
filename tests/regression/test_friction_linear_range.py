"""Figs. 6 to 9, 12 and 16 on a slab of 7 layers of 25 disks: what the study finds there, and that it is drawn."""

from granular_response.state import SLIDING


def test_path_and_dynamics_agree(datasets):
    path = datasets["response"]["floor_response"].sel(friction=0.2, force=4.0)
    dynamic = datasets["large_forces"]["floor_response"].sel(force=4.0)
    assert float(abs(path - dynamic).max()) < 1e-3


def test_stored_states_show_the_contact_changes(datasets):
    states, response = datasets["states_mu_0.2"], datasets["response"].sel(friction=0.2)
    assert states["force"].values.tolist() == [0.0, 0.1, 0.5, 1.0, 2.0, 4.0, 6.0, 8.0, 9.0]
    sliding = (states["contact_status"] == SLIDING).sum("contact")
    for state, force in enumerate(states["force"].values[1:], 1):
        assert int(sliding[state]) == int(response["sliding_contacts"].sel(force=force))
    opened = ((states["contact_status"][0] > 0) & (states["contact_status"] == 0)).sum("contact")
    near = response["opened_contacts"].sel(force=[2.0, 8.0]).values
    assert near[0] == 0 < near[1] <= int(opened[7])
