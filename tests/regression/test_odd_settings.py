"""Every stage of every figure group with parameters that leave little to be measured: results, or one line."""

from functools import partial

import odd_settings
import pytest
import reduced

from granular_response.errors import SolveError
from granular_response.plot import style
from granular_response.scene import SceneError, text
from granular_response.store import files as store
from granular_response.sweeps.errors import SweepError
from granular_response_paper.claims import table
from granular_response_paper.claims.claim import Data
from granular_response_paper.groups import NAMES
from granular_response_paper.pipeline import GroupError, drawing, simulation

#: What the command line tells in one line.
LINES = (GroupError, SceneError, SolveError)
#: The group that measures what another pipeline has simulated.
MEASURES_THE_SURVEY = "phase_diagram"


@pytest.fixture(autouse=True)
def coarse_pictures(monkeypatch):
    """All that is asked of a picture here is that it can be drawn, wherever its panels are."""
    render = style.render

    def coarse(drawn, file_format):
        drawn.set_layout_engine("none")  # to lay out takes as long as to draw
        return render(drawn, file_format, dpi=30)

    monkeypatch.setattr(style, "render", coarse)
    monkeypatch.setattr(style, "save", partial(style.save, formats=["png"]))


def judged(group, data):
    """The verdicts on the claims of a group, from its own datasets alone."""
    claims = [claim for claim in table.CLAIMS if claim.group == group]
    return {entry.claim.id: entry.verdict for entry in table.evaluate(Data({group: store.read(data)}), claims)}


def test_every_group_has_odd_settings():
    assert set(odd_settings.SETTINGS) == set(NAMES) - {MEASURES_THE_SURVEY}
    assert {len(settings) for settings in odd_settings.SETTINGS.values()} == {3}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("number", range(3))
@pytest.mark.parametrize("group", odd_settings.SETTINGS)
def test_an_experiment_never_ends_in_a_traceback(group, number, tmp_path):
    sections = {"common": {"method": "auto"}, group: odd_settings.section(group, number)}
    (tmp_path / "params.yaml").write_text(text.write(sections))
    data = tmp_path / "data.nc"
    done = []
    for stage in (
        lambda: simulation.simulate(group, data, parameter_file=tmp_path / "params.yaml", workers=1),
        lambda: judged(group, data),
        lambda: drawing.draw(group, data, tmp_path / "figures"),
    ):
        try:
            done.append(stage())
        except SweepError as error:  # a scene that is not solved is told by its own line
            assert isinstance(error.__cause__, LINES), error
            assert "\n" not in str(error)
        except LINES as error:
            assert "\n" not in str(error)
        if not data.exists():
            return
    assert len(done) == 3 or not (tmp_path / "figures" / "captions.json").exists()


def test_a_slab_narrower_than_its_rings_has_a_figure_and_verdicts(tmp_path):
    """Rings beyond the slab hold nothing, and limits of an axis were not a number."""
    small = {**reduced.parameters("torque"), "distances": [60.0, 80.0, 100.0]}
    (tmp_path / "params.yaml").write_text(text.write({"common": {"method": "auto"}, "torque": small}))
    data = simulation.simulate("torque", tmp_path / "data.nc", parameter_file=tmp_path / "params.yaml", workers=1)
    assert tmp_path / "fig18_torque_reach.png" in drawing.draw("torque", data, tmp_path)
    assert judged("torque", data) == {"T1a": "not measured", "T1b": "not measured"}
