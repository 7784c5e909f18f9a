"""The verdict on a claim follows from its tests and is never written by hand.

The scheme, as the page and the notes print it, is :data:`SCHEME`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Literal

from granular_response_paper import TOO_LITTLE

from .claim import Claim, Data, NotMeasured, Outcome, Test
from .words import FACTORS, words

SCHEME = (
    "Each sentence has one primary test, which the text fixes: its figure, its forces, its number of samples.",
    "The sentence is supported, or not supported, if the 95 % interval or the bracket of the measured number lies on "
    "one side of the bound; otherwise the data cannot tell.",
    "Where the text leaves a parameter open, the row lists the values for which the sentence holds (in part).",
    "A star marks a verdict that changes if the threshold of a qualitative term is halved or doubled.",
    "The second column says whether the sentence also holds under another preparation of the packing: yes, no, cannot "
    "tell or not tried.",
)

Kind = Literal["supported", "in part", "not supported", "cannot tell", "not seen", "derivation", "not measured"]

#: Every verdict and what it says.
MEANINGS: dict[Kind, str] = {
    "supported": "the sentence holds for every value of what the text leaves open",
    "in part": "it holds for some of these values",
    "not supported": "it holds for none of them, and fails for one or more",
    "cannot tell": "the interval straddles the bound",
    "not seen": "the sentence says that something may be, and it was not found here",
    "derivation": "algebra that no simulation can fail; counted apart",
    "not measured": "no stored dataset decides it",
}

#: The second column.
Elsewhere = Literal["yes", "no", "cannot tell", "not tried"]


def key(kind: str) -> str:
    """Of a verdict in the stored table."""
    return kind.replace(" ", "_")


def together(outcomes: Iterable[Outcome]) -> Outcome:
    """Of numbers that must all lie in their bounds."""
    found = set(outcomes)
    return "no" if "no" in found else "cannot tell" if "cannot tell" in found else "yes"


def _outcomes(tests: Sequence[Test], of: Literal["case", "prepared"]) -> dict[str, Outcome]:
    """The outcome for each value of what the text leaves open, or in each other preparation."""
    chosen = [test for test in tests if bool(test.prepared) is (of == "prepared")]
    names = dict.fromkeys(getattr(test, of) for test in chosen)
    return {name: together(test.outcome for test in chosen if getattr(test, of) == name) for name in names}


def verdict_of(tests: Sequence[Test], claim: Claim | None = None) -> Kind:
    """Raises ValueError without a test in the paper's preparation."""
    outcomes = set(_outcomes(tests, "case").values())
    if not outcomes:
        raise ValueError("a claim needs a test in the paper's own preparation")
    if outcomes == {"yes"}:
        return "derivation" if claim and claim.derivation else "supported"
    if "yes" in outcomes:
        return "in part"
    if "no" in outcomes:
        return "not seen" if claim and claim.modal else "not supported"
    return "cannot tell"


def elsewhere_of(tests: Sequence[Test]) -> Elsewhere:
    """Whether the tests hold in every other preparation."""
    found = _outcomes(tests, "prepared")
    return together(found.values()) if found else "not tried"


@dataclass(frozen=True)
class Verdict:
    """On a claim. ``star`` names the qualitative terms whose threshold, halved or doubled, changes it."""

    claim: Claim
    verdict: Kind
    tests: Sequence[Test] = ()
    missing: str = ""
    elsewhere: Elsewhere = "not tried"
    star: Sequence[str] = field(default_factory=list)

    @property
    def here(self) -> str:
        """What was measured, in a sentence."""
        if not self.tests:
            return self.missing
        own = [test for test in self.tests if not test.prepared]
        found = [test.found.text(test.unit) for test in own]
        with suppress(IndexError):  # fewer tests than the sentence quotes, of a smaller study
            if self.claim.here:
                return self.claim.here.format(*found)
        return f"{own[0].what}: {found[0]}"

    @property
    def cases(self) -> str:
        """For which values of what the text leaves open it holds, fails or is open."""
        found = _outcomes(self.tests, "case")
        return _listed(found, "Supported for", "Not supported for", "Cannot tell for") if len(found) > 1 else ""

    @property
    def preparations(self) -> str:
        """In which other preparations it holds, fails or is open."""
        return _listed(_outcomes(self.tests, "prepared"), "Holds", "Fails", "Open")


def _listed(found: Mapping[str, Outcome], *titles: str) -> str:
    names = [[name for name, one in found.items() if one == outcome] for outcome in ("yes", "no", "cannot tell")]
    return " ".join(f"{title}: {'; '.join(some)}." for title, some in zip(titles, names, strict=True) if some)


def judge(claim: Claim, data: Data) -> Verdict:
    """Make the tests of a claim on stored data.

    It is not measured if its function finds too little: a variable, a label, or all that is left to look at is missing.
    """

    def under(word: str, factor: float) -> Kind:
        """The verdict with the threshold of one term changed."""
        return verdict_of(claim.measure(replace(data, words=words(word, factor))), claim)

    try:
        tests = claim.measure(data)
        verdict, elsewhere = verdict_of(tests, claim), elsewhere_of(tests)
        used = sorted({test.bound.word for test in tests if test.bound.word and not test.prepared})
        star = [word for word in used if any(under(word, factor) != verdict for factor in FACTORS)]
        return Verdict(claim, verdict, tests, "", elsewhere, star)
    except NotMeasured as missing:
        return Verdict(claim, "not measured", missing=str(missing))
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        return Verdict(claim, "not measured", missing=f"data/{claim.group}.nc holds too little ({problem})")
