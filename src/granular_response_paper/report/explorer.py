"""What the page's explorer shows: slabs under a force that the reader moves, with Figs. 6 and 22 beside them.

Slabs and Fig. 6 come from the datasets of ``friction_linear_range``, Fig. 22 from those of ``phase_diagram``.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.peaks import asymmetry
from granular_response.scene import Scene
from granular_response.state import OPEN, FloatArray, contact_force
from granular_response.studies.measures import MARGINS

from ..captions import Datasets
from ..claims.claim import at
from ..claims.numbers import Quantity, text
from ..survey.datasets import usual
from .typeset import typeset

FRICTIONS = (0.0, 0.2, 1.0)

#: What is shown of the measurements.
MEASURED = ["floor_response", "response_at_centre", "peak_count"]

#: Half of the part of a slab that is shown, in radii.
REACH = 30.0

#: A contact's byte is the square root of its added force per applied force, FULL at the largest of all, negative where
#: compression is lost; OPENED is a contact that touched at rest and does not under load.
FULL, OPENED = 120, 127

#: From this asymmetry on the response counts as having lost its symmetry (as ``loss_of_symmetry``).
ASYMMETRY = 0.2

#: Coefficient of friction, force in mg, what the paper says happens there, where, and the stored events beside it:
#: ordered slabs, k_T/k_N = 0.8.
PAPER: tuple[tuple[float, float, str, str, tuple[str, ...]], ...] = (
    (0.0, 0.75, "the first contact opens", "Sec. V.B", ("first_opening",)),
    (0.2, 4.0, "the first contact opens", "Sec. V.B", ("first_opening",)),
    (0.2, 20.0, "open contacts reach the floor; two peaks", "Sec. V.E", ("reaches_floor", "crossover")),
    (0.2, 40.0, "a small third peak", "Sec. V.E", ("third_peak",)),
    (1.0, 6.0, "the first contact opens", "Sec. V.B", ("first_opening",)),
    (1.0, 50.0, "still one peak", "Sec. V.A", ()),
    (1.0, 91.0, "above it the response loses its symmetry", "Sec. V.E", ("loss_of_symmetry",)),
)


@dataclass(frozen=True)
class ExploredSlab:
    """A slab at rest and under k growing forces."""

    states: tuple[xr.Dataset, ...]  #: with one list of contacts; rest is the first state of each
    chosen: list[tuple[int, int]]  #: for each force, which of ``states``, and which state of it
    measured: xr.Dataset  #: along ``force``
    friction: float
    scene: Scene  #: with all else
    motion: float | None = None  #: smallest force whose state dynamics from rest reached; below it lies the load path


def payload(friction: Datasets, phase: Datasets) -> dict[str, Any]:
    """What the page embeds, and ``packed``, the contacts of all slabs.

    The datasets are those of ``friction_linear_range`` and ``phase_diagram``.
    """
    slabs = list(_slabs(friction))
    contacts = [_Contacts.of(slab) for slab in slabs]
    strongest = max(float(one.strength.max()) for one in contacts)
    return {
        "reach": REACH,
        "full": FULL,
        "opened": OPENED,
        "strongest": round(strongest, 6),
        "slabs": [_described(slab, one, friction) for slab, one in zip(slabs, contacts, strict=True)],
        "range": _range(friction),
        "crossovers": _crossovers(phase),
        "packed": base64.b64encode(zlib.compress(b"".join(one.bytes(strongest) for one in contacts), 9)).decode(),
    }


def _described(slab: ExploredSlab, contacts: _Contacts, study: Datasets) -> dict[str, Any]:
    """A slab as the page has it; ``study`` has the stored events."""
    measured = slab.measured
    x, response = measured["x"].values, measured["floor_response"].values
    shown = np.abs(x) <= REACH + 0.5
    return {
        "friction": slab.friction,
        "about": _about(slab),
        "about_set": typeset(_about(slab)),
        "contacts": len(contacts.lines),
        "forces": measured["force"].values.tolist(),
        "height": round(contacts.height, 2),
        "x": _rounded(x[shown], 2),
        "response": [_rounded(row, 4) for row in response[:, shown]],
        "centre": _rounded(measured["response_at_centre"].values, 6),
        "peaks": measured["peak_count"].values.astype(int).tolist(),
        "symmetric": [asymmetry(x, row) <= ASYMMETRY for row in response],
        "walls": slab.scene.resolved_wall.friction,
        "motion": slab.motion,
        "paper": [
            {"force": force, "what": what, "place": place, "here": _here(study, mu, events)}
            for mu, force, what, place, events in PAPER
            if (slab.scene.contact.stiffness_ratio, mu) == (0.8, slab.friction)
        ],
    }


def _rounded(values: FloatArray, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]


def _about(slab: ExploredSlab) -> str:
    """The parameters in words."""
    contact, walls = slab.scene.contact, slab.scene.resolved_wall.friction
    ratio = f", k_T/k_N = {contact.stiffness_ratio:g}" if slab.friction or walls else ""
    friction = f"µ = {slab.friction:g}, µ_wall = {walls:g}"
    return f"ordered packing, {friction}{ratio}, k_N = {contact.normal_stiffness:g} mg/R"


def _here(datasets: Datasets, friction: float, names: Sequence[str]) -> str:
    """At which forces the stored events happen here, in words."""
    events = (at(datasets["events"], name=name, friction=friction) for name in names)
    return ", ".join(text(Quantity.bracket(float(one["low"]), float(one["high"])), "mg") for one in events)


def _slabs(datasets: Datasets) -> Iterator[ExploredSlab]:
    """The slabs of Figs. 6 to 9 and 16: the load path, then dynamics from rest from its first force on."""
    for friction in FRICTIONS:
        name = f"states_mu_{friction:g}"
        along = datasets["response"]
        along = along.isel(friction=int(np.abs(along["friction"].values - friction).argmin()))
        sources = [(datasets[name], along)]
        large, motion = datasets.get("large_forces"), None
        if large is not None and float(large["friction"]) == friction:
            sources.append((datasets["large_force_states"], large))
            motion = float(large["force"].min())
        chosen: list[tuple[int, int]] = []
        rows: list[xr.Dataset] = []
        for source, (states, measured) in enumerate(sources):
            for k, force in enumerate(states["force"].values.tolist()):
                here = np.flatnonzero(np.isclose(measured["force"].values, force))
                replaced = source == 0 and motion is not None and force >= motion
                if force > 0.0 and here.size and not replaced:
                    chosen.append((source, k))
                    rows.append(measured[MEASURED].isel(force=int(here[0])))
        scene = Scene.from_text(datasets[name].attrs["scene"])
        shown = xr.concat(rows, "force", coords="minimal", compat="override")
        yield ExploredSlab(tuple(states for states, _ in sources), chosen, shown, friction, scene, motion)


@dataclass(frozen=True)
class _Contacts:
    """The contacts of a slab that are shown."""

    lines: NDArray[np.int16]  #: (contact, 4) ends at rest, in tenths of a radius from below the load
    strength: FloatArray  #: (k, contact) added force per applied force, negative where compression is lost
    opened: NDArray[np.bool_]  #: (k, contact)
    sliding: NDArray[np.bool_]  #: (k, contact)
    height: float

    @classmethod
    def of(cls, slab: ExploredSlab) -> _Contacts:
        rest = slab.states[0].isel(state=0)
        first, second = rest["contact_disk"].values, rest["contact_partner"].values
        place = rest["position"].values.astype(float)
        place = place - np.array([place[int(rest["loaded_disk"]), 0], 0.0])
        ever = np.any([np.any(states["contact_status"].values != OPEN, axis=0) for states in slab.states], axis=0)
        inside = ever & (np.abs(place[first, 0]) <= REACH) & (np.abs(place[second, 0]) <= REACH)
        first, second = first[inside], second[inside]
        found = []
        for source, states in enumerate(slab.states):
            position = states["position"].values.astype(float)
            normal = position[:, first] - position[:, second]
            normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
            along, across = (
                states[f"contact_{part}_force"].values[:, inside].astype(float) for part in ("normal", "tangential")
            )
            touching = states["contact_status"].values[:, inside] != OPEN
            force = contact_force(normal, along, across)
            added = np.where(along >= along[0], 1.0, -1.0) * np.linalg.norm(force - force[0], axis=-1)
            slides = touching & (np.abs(across) >= (1.0 - MARGINS[0]) * slab.friction * along) & (slab.friction > 0.0)
            chosen = [k for one, k in slab.chosen if one == source]
            found.append((added[chosen], (touching[0] & ~touching)[chosen], slides[chosen]))
        added, opened, sliding = map(np.concatenate, zip(*found, strict=True))
        lines = np.rint(10.0 * np.concatenate([place[first], place[second]], axis=1)).astype(np.int16)
        strength = added / slab.measured["force"].values[:, None]
        return cls(lines, strength, opened, sliding, float(place[:, 1].max()) + 1.0)

    def bytes(self, strongest: float) -> bytes:
        """Lines as little-endian 16-bit numbers; then for each force a byte for each contact and a bit for sliding."""
        levels = np.rint(FULL * np.sign(self.strength) * np.sqrt(np.abs(self.strength) / strongest)).astype(np.int8)
        levels[self.opened] = OPENED
        frames = np.concatenate([levels.view(np.uint8), np.packbits(self.sliding, axis=1)], axis=1)
        return self.lines.astype("<i2").tobytes() + frames.tobytes()


def _range(datasets: Datasets) -> list[dict[str, Any]]:
    """The curves of Fig. 6, which end at 50 mg."""
    response = datasets["response"]
    response = response.isel(force=response["force"].values <= 50.0)
    found = []
    for friction, row in zip(response["friction"].values, response["response_at_centre"].values, strict=True):
        known = np.isfinite(row)
        force = response["force"].values[known].tolist()
        found.append({"friction": float(friction), "force": force, "centre": _rounded(row[known], 6)})
    return found


def _crossovers(datasets: Datasets) -> list[dict[str, Any]]:
    """The curves of Fig. 22 that start with the largest disks in touch, smoothed with w = 6.

    ``kind`` 1 and 2 are bounds: two peaks at the smallest force already, or not yet at the largest.
    """
    data = usual(datasets["crossovers"])
    data = data.isel(width=int(np.abs(data["width"].values - 6.0).argmin()))
    found = []
    for delta in np.unique(data["polydispersity"].values):
        one = data.isel(case=data["polydispersity"].values == delta).sortby("friction")
        found.append(
            {
                "polydispersity": float(delta),
                "friction": one["friction"].values.tolist(),
                "force": _rounded(one["force"].values, 4),
                "low": _ends(one, 0),
                "high": _ends(one, -1),
                "kind": one["kind"].values.astype(int).tolist(),
            }
        )
    return found


def _ends(one: xr.Dataset, end: int) -> Sequence[float | None]:
    """An end of the interval of 95 % of the draws; None where it is a bound."""
    values = one["interval"].values[:, end]
    return [round(float(v), 4) if np.isfinite(v) and v > 0.0 else None for v in values]
