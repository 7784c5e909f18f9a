"""Files cut and changed at random, the same ones in every run; ``make broken`` tries many more."""

import re
from collections import Counter

import broken_files
import counts
import numpy as np
import pytest
import unlike_scenes
from places import ROOT
from stress import random_scenes

from granular_response.inputs import read_json


def test_every_broken_file_is_refused_or_taken_for_what_it_says(tmp_path):
    trials = broken_files.attempts(60, 1, tmp_path)
    assert [trial for trial in trials if trial.outcome in broken_files.WRONG] == []
    found = Counter(trial.outcome for trial in trials)
    assert set(found) == {"refused", "taken"} and found["refused"] > found["taken"]
    assert all(trial.said.startswith("granular-response: ") for trial in trials if trial.said)


@pytest.mark.filterwarnings("ignore:overflow")
def test_packings_that_are_changed_are_refused_or_account_for_the_change(tmp_path):
    """Readers alone, which take so little time that thousands of changes are tried."""
    packings = [file for file in broken_files.originals(tmp_path) if not file.name.endswith((".nc", ".yaml"))]
    refused = Counter()
    for index in range(600):
        file, g = packings[index % len(packings)], np.random.default_rng([7, index])
        _, content = broken_files.changed(g, file.content, not file.name.endswith(".gsd"))
        try:
            assert broken_files.quiet_change(file, content, tmp_path) == "", (index, file.name)
        except (broken_files.formats.FormatError, UnicodeDecodeError) as error:
            assert "\n" not in str(error)
            refused[file.name] += 1
    assert refused.keys() == {file.name for file in packings} and min(refused.values()) > 10


def quoted(name: str) -> list[int]:
    """The numbers of the page in the paragraph or the point of a list that names the file."""
    page = (ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
    (paragraph,) = (part for part in re.split(r"\n\n|\n\* ", page) if f"`tests/data/{name}`" in part)
    return [int(number.replace(",", "")) for number in re.findall(r"(?<![\w.])\d[\d,]*(?=\s)", paragraph)]


def test_of_ten_thousand_files_none_was_read_as_something_else():
    found = counts.totals(ROOT / "tests" / "data" / "broken_files.json")
    assert set(found) == {"refused", "taken"} and sum(found.values()) >= 10_000
    assert quoted("broken_files.json")[:3] == [sum(found.values()), found["refused"], found["taken"]]


def test_no_random_scene_was_solved_wrongly():
    path = ROOT / "tests" / "data" / "random_scenes.json"
    found = counts.totals(path)
    assert set(found) <= set(random_scenes.OUTCOMES) - {"wrong"}
    outcomes = read_json(path)["outcomes"]
    assert {kind.removesuffix(unlike_scenes.ROLL) for kind in outcomes} == set(unlike_scenes.KINDS)
    rolls = [one for kind, one in outcomes.items() if kind.endswith(unlike_scenes.ROLL)]
    resist = [sum(sum(one.values()) for one in rolls), sum(one["certified"] for one in rolls)]
    said = quoted("random_scenes.json")
    assert said[:5] == [sum(found.values()), found["certified"], unlike_scenes.STEPS, *resist]
