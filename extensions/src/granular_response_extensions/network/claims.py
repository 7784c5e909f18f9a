"""Claims B11 to B13, beyond the paper: the contact networks of disordered packings beside the literature (Sec. VI)."""

from __future__ import annotations

from itertools import product

import numpy as np

from granular_response_paper.claims.bootstrap import over_realizations
from granular_response_paper.claims.bounds import at_most, within
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity

claim = Claims("network")

DELTAS, FRICTIONS = (0.01, 0.1, 0.25), (0.0, 0.05, 0.2, 0.5, 1.0)


def _mean(data: Data, name: str, state: str, delta: float, friction: float) -> Quantity:
    study = at(data.get("network", "statistics"), state=state, polydispersity=delta, friction=friction)
    return over_realizations(study[name].values, np.mean)


@claim("B11", "beyond the paper, VI",
       Ask("coefficient of variation of the excess of normal forces", within("nearly", 1.0)),
       primary="rest, δ = 0.01, friction 0.2", source="literature", finds="not supported")  # fmt: skip
def exponential(data: Data) -> Numbers:
    """Normal forces above their mean are distributed exponentially, as in granular packings under pressure.
    Short: Normal forces above their mean are distributed exponentially
    Here: At polydispersity 0.01 and friction 0.2 the coefficient of variation in the initial equilibrium is {0}; it is
    1 for an exponential and 0.76 for a Gaussian distribution.
    Remark: Forces relative to the mean at their height. The bound of a tenth tells an exponential distribution from a
    Gaussian; a fifth would not"""
    primary = ("rest", 0.01, 0.2)
    for state, delta, mu in dict.fromkeys([primary, *product(("rest", "loaded"), DELTAS, FRICTIONS)]):
        yield f"{state}, δ = {delta:g}, friction {mu:g}", _mean(data, "tail_variation", state, delta, mu)


@claim("B12", "beyond the paper, VI", Ask("contacts per disk, friction 0", within("nearly", 4.0)),
       Ask("contacts per disk, friction 1", within("nearly", 3.0)), primary="δ = 0.01", source="literature",
       finds="not supported")  # fmt: skip
def isostatic(data: Data) -> Numbers:
    """Packings have the isostatic 4 contacts a disk without friction, and nearly the isostatic 3 at large friction.
    Short: z is 4 without friction and nearly 3 at large friction
    Here: At polydispersity 0.01 a disk has {0} contacts without friction and {1} at friction 1, without rattlers.
    Remark: Gravity applied instantaneously"""
    for delta in DELTAS:
        yield f"δ = {delta:g}", *(_mean(data, "coordination_number", "rest", delta, mu) for mu in (0.0, 1.0))


@claim("B13", "beyond the paper, VI", Ask("force components beyond equations, per equation", at_most("nearly"), "%"),
       primary="δ = 0.01, friction 0.2", source="literature", finds="not supported")  # fmt: skip
def generalized(data: Data) -> Numbers:
    """Packings with friction are isostatic once fully mobilized contacts are counted (generalized isostaticity).
    Short: With mobilized contacts counted, packings are isostatic
    Here: At polydispersity 0.01 and friction 0.2 there are {0} more force components than equations of balance."""
    for delta, mu in dict.fromkeys([(0.01, 0.2), *product(DELTAS, FRICTIONS[1:])]):
        yield f"δ = {delta:g}, friction {mu:g}", _mean(data, "hyperstaticity", "rest", delta, mu)
