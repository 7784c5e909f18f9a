"""The record of how a state was reached."""

from dataclasses import replace

from small_scenes import scene
from test_events import shown

from granular_response.solvers.solution import solve_scene
from granular_response.store import files as store
from granular_response.store.result import state_from, to_dataset


def test_stability_that_nobody_looked_at_is_said_so(tmp_path):
    solution = solve_scene(scene())
    (state,) = solution.loaded
    assert state.certificate.stable is True
    assert to_dataset(solution).attrs["stable"] == "yes"
    for modes, stable, said in ((None, None, "not determined"), (1, False, "no")):
        certificate = replace(state.certificate, negative_modes=modes)
        assert certificate.stable is stable
        other = replace(state, reached=replace(state.reached, certificate=certificate))
        data = to_dataset(replace(solution, loaded=(other,)))
        assert data.attrs["stable"] == said
        assert state_from(data).certificate == certificate
        store.write(tmp_path / "result.nc", data)
        lines = shown(tmp_path / "result.nc").splitlines()
        assert [line.split()[1:] for line in lines if line.startswith("stable")] == [said.split()]
        row = next(line for line in lines if line.startswith("negative modes"))
        assert row.split(maxsplit=2)[2].split(maxsplit=1) == ["0", "not determined" if modes is None else "1"]
