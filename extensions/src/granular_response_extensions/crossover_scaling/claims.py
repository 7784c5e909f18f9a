"""Claims B8 and B9, beyond the paper: how the crossover force grows with the depth (Secs. IV.B, IV.C and VIII)."""

from __future__ import annotations

from granular_response_paper.claims.bounds import more_than, within
from granular_response_paper.claims.claim import Ask, Claims, Data, Numbers, at
from granular_response_paper.claims.numbers import Quantity

claim = Claims("crossover_scaling")

#: Series by their names in the data.
SERIES = {
    "constant confinement": "friction 0, constant lateral prestress",
    "confined as weight": "friction 0, prestress proportional to the layers",
    "walls": "friction 0, between walls",
    "friction 0.05": "friction 0.05, prestress proportional to the layers",
    "friction 0.1": "friction 0.1, prestress proportional to the layers",
    "friction 0.2": "friction 0.2, prestress proportional to the layers",
    "constant confinement with friction 0.2": "friction 0.2, constant lateral prestress",
}


def _exponent(data: Data, series: str, event: str) -> Quantity:
    return Quantity.over(
        at(data.get("crossover_scaling", "powers"), series=series, event=event)["exponent"].values.tolist()
    )


@claim("B8", "beyond the paper, IV.B, VIII", Ask("exponent of the crossover force in the layers", more_than(0.0)),
       primary=SERIES["walls"])  # fmt: skip
def grows(data: Data) -> Numbers:
    """For identical external loads, very deep systems should exhibit a single peaked response whereas relatively
    shallow ones, as studied in some experiments (Sec. II B), should exhibit two peaks.
    Short: Deep slabs have one peak under a load that gives shallow ones two
    Here: Without friction and between walls the crossover force grows with the number of layers with the exponent {0}.
    """
    for series, name in SERIES.items():
        yield name, _exponent(data, series, "crossover")


@claim("B9", "beyond the paper, IV.C", Ask("exponent of the force in the layers", within("nearly", 2.0)),
       primary=f"open region at the floor, {SERIES['walls']}", source="hypothesis", finds="not supported")  # fmt: skip
def as_the_weight(data: Data) -> Numbers:
    """Therefore, the opening of contacts is due to a "competition" between the compression due to gravity and the
    tensile (excess) forces due to the applied force, and is therefore determined directly by the stress, rather than
    the strain (which does depend on the particle stiffness, of course), provided that the geometry is not significantly
    affected by the applied force (as it would for particles which are sufficiently soft to allow significant overlap).
    Short: Contacts open by the stress, so forces grow as the weight above
    Here: Without friction and between walls the force at which the open region reaches the floor grows with the number
    of layers with the exponent {0}; 2 is that of the weight above a line.
    Remark: The weight above a line grows as the square of the layers, in two dimensions. Without friction horizontal
    contacts carry the lateral prestress, not the weight above. Sides that press as the weight does have its power by
    choice and are left out"""
    for event, text in (("reaches_floor", "open region at the floor"), ("crossover", "two peaks")):
        for series, name in SERIES.items():
            if series != "confined as weight":
                yield f"{text}, {name}", _exponent(data, series, event)
