"""Files cut and changed at random, the same ones in every run; ``make broken`` tries many more."""

from collections import Counter

import broken_files
import pytest


@pytest.mark.parametrize("seed", range(2))
def test_every_broken_file_is_refused_or_taken_for_what_it_says(tmp_path, seed):
    trials = broken_files.attempts(60, seed, tmp_path)
    assert [trial for trial in trials if trial.outcome in broken_files.WRONG] == []
    counts = Counter(trial.outcome for trial in trials)
    assert set(counts) == {"refused", "taken"} and counts["refused"] > counts["taken"]
    assert all(trial.said.startswith("granular-response: ") for trial in trials if trial.said)
