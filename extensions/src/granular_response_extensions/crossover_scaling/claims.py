"""Claims B8 and B9, beyond the paper: finite size, with friction too (Secs. IV.B, IV.C and VIII)."""

from __future__ import annotations

from granular_response_paper.claims.claim import Data, Numbers, Quantity

#: How the sides are confined, in words.
SIDES = {"walls": "between walls", "constant": "constant confinement", "as weight": "confined as weight"}


def powers(data: Data, by_choice: bool = True, **events: str) -> Numbers:
    """B8, B9: powers of the layers of events, in each series of layers.

    Without those in which the power is that of the weight ``by_choice`` of the confinement, if it is false.
    """
    study = data.get("crossover_scaling", "powers")
    for event, what in events.items():
        for one in (study.isel(series=k).sel(event=event) for k in range(study.sizes["series"])):
            friction, confined = float(one["friction"]), str(one["confined"].values)
            if str(one["varied"].values) == "layers" and (by_choice or friction > 0.0 or confined != "as weight"):
                value, *ends = one["exponent"].values.tolist()
                name = f"friction {friction:g}, {SIDES[confined]}"
                yield ", ".join(filter(None, (what, name))), Quantity.range(ends, value)
