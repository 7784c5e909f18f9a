"""Records whose fields say what they hold, and the datasets made of them."""

from functools import partial

import numpy as np

from granular_response.sweeps.resources import using
from granular_response_paper.records import column, record, table
from granular_response_paper.tasks import computed


@record
class Outcome:
    height: float = column("height in mean disk radii")
    count: int = column("number of contacts")
    name: str = column("how it was made")
    profile: np.ndarray = column("stress per force", "line")
    rest: object = None


def outcome(lines):
    return Outcome(lines, lines, "x" * lines, np.arange(float(lines)), object())


def test_places_without_a_record_are_nan():
    found = table({(0, 1): outcome(2), (1, 0): outcome(2)}, "case", "realization")
    assert found["name"].values.tolist() == [["", "xx"], ["xx", ""]]
    np.testing.assert_array_equal(found["count"], [[np.nan, 2.0], [2.0, np.nan]])
    assert found["profile"].shape == (2, 2, 2)
    np.testing.assert_array_equal(np.isfinite(found["profile"]).all("line"), [[False, True], [True, False]])


def test_one_record_and_none_are_tables_too():
    assert table({(): outcome(2)})["profile"].dims == ("line",)

    @record
    class Event:
        low: float = column("force before")
        name: str = column("what happens")

    found = table([], "event", kind=Event)
    assert found.sizes == {"event": 0} and found["low"].dtype == float and found["name"].dtype.kind == "U"


def test_tasks_give_what_they_compute_by_their_places():
    begun = []
    tasks = {name: partial(lambda name, power: begun.append(name) or 2**power, name, k) for k, name in enumerate("abc")}
    with using(workers=1):
        assert computed(tasks, "powers", work=tasks.__contains__) == {"a": 1, "b": 2, "c": 4}
        assert begun == ["a", "b", "c"]
        assert list(computed(tasks, "powers", work=ord)) == ["a", "b", "c"]
    assert begun[3:] == ["c", "b", "a"]
