import math

import pytest

from granular_response.observe.events import bisect_event


@pytest.mark.parametrize("rising", [True, False])
def test_bracket_holds_the_event_within_the_tolerance(rising):
    bracket = bisect_event(lambda f: (f > math.pi) is rising, 0.0, 10.0, 0.01)
    assert bracket.low <= math.pi < bracket.high
    assert bracket.width <= 0.01
    assert bracket.low < bracket.middle < bracket.high
    assert bracket.at_low is not rising


def test_each_point_is_evaluated_once():
    seen = []

    def predicate(f):
        seen.append(f)
        return f >= 3.0

    bracket = bisect_event(predicate, 0.0, 8.0, 1.0)
    assert len(seen) == len(set(seen)) == bracket.evaluations == 5  # two ends, three halvings
    assert (bracket.low, bracket.high) == (2.0, 3.0)


def test_tolerance_below_the_spacing_of_numbers_ends():
    bracket = bisect_event(lambda f: f > 1e9 + 0.3, 1e9, 1e9 + 1.0, 1e-12)
    assert bracket.high == math.nextafter(bracket.low, math.inf)
