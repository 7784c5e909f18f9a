"""The verdict on a claim follows from its tests, by :data:`SCHEME`, and is never written by hand."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Literal

from granular_response_paper import TOO_LITTLE

from .claim import Claim, Data, NotMeasured, Outcome, Test, needs
from .words import FACTORS

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


def key(kind: str) -> str:
    """Of a verdict in the stored table."""
    return kind.replace(" ", "_")


def together(outcomes: Iterable[Outcome]) -> Outcome:
    """Of numbers that must all lie in their bounds."""
    found = set(outcomes)
    return "no" if "no" in found else "cannot tell" if "cannot tell" in found else "yes"


@dataclass(frozen=True)
class Verdict:
    """On a claim, by its tests, or what is ``missing`` for them.

    ``star`` names the qualitative terms whose threshold, halved or doubled, changes it.
    """

    claim: Claim
    tests: Sequence[Test] = ()
    missing: str = ""
    star: Sequence[str] = field(default_factory=list)

    def outcomes(self, of: Literal["case", "prepared"]) -> dict[str, Outcome]:
        """For each value of what the text leaves open, or in each other preparation."""
        chosen = [test for test in self.tests if bool(test.prepared) is (of == "prepared")]
        names = dict.fromkeys(getattr(test, of) for test in chosen)
        return {name: together(test.outcome for test in chosen if getattr(test, of) == name) for name in names}

    @property
    def verdict(self) -> Kind:
        """Raises NotMeasured without a test in the paper's preparation."""
        if self.missing:
            return "not measured"
        outcomes = set(self.outcomes("case").values())
        needs(outcomes, "nothing to test")
        if outcomes == {"yes"}:
            return "derivation" if self.claim.derivation else "supported"
        if "yes" in outcomes:
            return "in part"
        if "no" in outcomes:
            return "not seen" if self.claim.modal else "not supported"
        return "cannot tell"

    @property
    def elsewhere(self) -> Literal[Outcome, "not tried"]:
        """The second column: whether the tests hold in every other preparation."""
        found = self.outcomes("prepared")
        return together(found.values()) if found else "not tried"

    @property
    def here(self) -> str:
        """What was measured, in a sentence."""
        if self.missing:
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
        found = self.outcomes("case")
        return _listed(found, "Supported for", "Not supported for", "Cannot tell for") if len(found) > 1 else ""

    @property
    def preparations(self) -> str:
        """In which other preparations it holds, fails or is open."""
        return _listed(self.outcomes("prepared"), "Holds", "Fails", "Open")


def _listed(found: Mapping[str, Outcome], *titles: str) -> str:
    names = [[name for name, one in found.items() if one == outcome] for outcome in ("yes", "no", "cannot tell")]
    return " ".join(f"{title}: {'; '.join(some)}." for title, some in zip(titles, names, strict=True) if some)


def judge(claim: Claim, data: Data) -> Verdict:
    """Make the tests of a claim on stored data.

    It is not measured if its function finds too little: a variable, a label, or all that is left to look at is missing.
    """

    def under(word: str, factor: float) -> Kind:
        """The verdict with the threshold of one term changed."""
        changed = data.words | {word: factor * data.words[word]}
        return Verdict(claim, claim.measure(replace(data, words=changed))).verdict

    try:
        found = Verdict(claim, claim.measure(data))
        verdict, _ = found.verdict, found.elsewhere  # so that what is missing for either shows here
        used = sorted({test.bound.word for test in found.tests if test.bound.word and not test.prepared})
        return replace(found, star=[word for word in used if any(under(word, factor) != verdict for factor in FACTORS)])
    except NotMeasured as missing:
        return Verdict(claim, missing=str(missing))
    except TOO_LITTLE as error:
        problem = " ".join(f"{type(error).__name__}: {error}".split())
        return Verdict(claim, missing=f"data/{claim.group}.nc holds too little ({problem})")
