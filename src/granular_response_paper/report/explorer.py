"""What the page's explorer shows: slabs under a force that the reader moves, with Figs. 6 and 22 beside them.

Everything comes from three datasets: ordered slabs and Fig. 6 from ``friction_linear_range``, slabs with small k_T/k_N
and disordered ones from ``explorer``, Fig. 22 from ``phase_diagram``.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from granular_response.observe.peaks import asymmetry
from granular_response.scene import Scene
from granular_response.state import OPEN, FloatArray, contact_force

from .typeset import typeset

Datasets = Mapping[str, xr.Dataset]

FRICTIONS = (0.0, 0.2, 1.0)

#: Half of the part of a slab that is shown, in radii.
REACH = 30.0

#: A contact's byte is the square root of its added force per applied force, FULL at the largest of all, negative where
#: compression is lost; OPENED is a contact that touched at rest and does not under load.
FULL, OPENED = 120, 127

#: A contact slides if its tangential force is within this part of the Coulomb limit (as ``mobilised_contacts``).
MARGIN = 0.01

#: Largest force of Fig. 6.
LARGEST_OF_FIG_6 = 50.0

#: Width of the Gaussian of the Fig. 22 that is shown.
WIDTH = 6.0

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
class Slab:
    """A slab at rest and under k growing forces."""

    states: tuple[xr.Dataset, ...]  #: with one list of contacts; rest is the first state of each
    polydispersity: float
    friction: float
    wall_friction: float
    stiffness_ratio: float
    normal_stiffness: float
    force: FloatArray  #: (k,)
    chosen: NDArray[np.intp]  #: (k, 2) which of ``states``, and which state of it
    x: FloatArray  #: (floor_disk,)
    response: FloatArray  #: (k, floor_disk) floor force per applied force; of a disordered slab stress times R
    smoothed: FloatArray | None  #: (k, floor_disk) stress times R per applied force, of a disordered slab
    centre: FloatArray  #: (k,) response at x = 0, smoothed if there is a smoothed one
    peaks: FloatArray  #: (k,)
    width: float = 0.0  #: of the Gaussian that smooths a disordered slab
    motion: float | None = None  #: smallest force whose state dynamics from rest reached; below it lies the load path

    @property
    def symmetric(self) -> list[bool]:
        """Of each state of an ordered slab."""
        return [asymmetry(self.x, row) <= ASYMMETRY for row in self.response]

    @property
    def shown(self) -> NDArray[np.bool_]:
        """(floor_disk,) which of them are in the part that is shown."""
        return np.abs(self.x) <= REACH + 0.5


def payload(friction: Datasets, more: Datasets | None = None, phase: Datasets | None = None) -> dict[str, Any] | None:
    """What the page embeds, and ``packed``, the contacts of all slabs; None without the states of any friction.

    Parameters
    ----------
    friction, more, phase : datasets of ``friction_linear_range``, ``explorer`` and ``phase_diagram``.
    """
    slabs = [*_ordered(friction), *map(_added, (more or {}).values())]
    if not slabs:
        return None
    contacts = [_Contacts.of(slab) for slab in slabs]
    strongest = max(float(one.strength.max()) for one in contacts)
    packed = b"".join(one.bytes(strongest) for one in contacts)
    return {
        "reach": REACH,
        "full": FULL,
        "opened": OPENED,
        "strongest": round(strongest, 6),
        "slabs": [
            {
                "polydispersity": slab.polydispersity,
                "friction": slab.friction,
                "ratio": slab.stiffness_ratio,
                "about": _about(slab),
                "about_set": typeset(_about(slab)),
                "contacts": one.count,
                "forces": slab.force.tolist(),
                "height": round(one.height, 2),
                "x": _rounded(slab.x[slab.shown], 2),
                "response": [_rounded(row, 4) for row in slab.response[:, slab.shown]],
                "smoothed": None if slab.smoothed is None else [_rounded(r, 4) for r in slab.smoothed[:, slab.shown]],
                "centre": _rounded(slab.centre, 6),
                # noise gives a disordered slab many
                "peaks": None if slab.polydispersity else [int(count) for count in slab.peaks],
                "symmetric": None if slab.polydispersity else slab.symmetric,
                "walls": slab.wall_friction,
                "width": slab.width,
                "motion": slab.motion,
                "paper": [
                    {"force": force, "what": what, "place": place, "here": _here(friction, mu, events)}
                    for mu, force, what, place, events in PAPER
                    if (slab.polydispersity, slab.stiffness_ratio, mu) == (0.0, 0.8, slab.friction)
                ],
            }
            for slab, one in zip(slabs, contacts, strict=True)
        ],
        "range": _range(friction),
        "crossovers": _crossovers(phase) if phase else [],
        "width": WIDTH,
        "packed": base64.b64encode(zlib.compress(packed, 9)).decode(),
    }


def _rounded(values: FloatArray, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]


def _about(slab: Slab) -> str:
    """The parameters in words."""
    kind = f"one packing with δ = {slab.polydispersity:g}" if slab.polydispersity else "ordered packing"
    ratio = f", k_T/k_N = {slab.stiffness_ratio:g}" if slab.friction or slab.wall_friction else ""
    walls = f"µ_wall = {slab.wall_friction:g}"
    return f"{kind}, µ = {slab.friction:g}, {walls}{ratio}, k_N = {slab.normal_stiffness:g} mg/R"


def _here(datasets: Datasets, friction: float, names: Sequence[str]) -> str:
    """At which forces the stored events happen here, in words; empty where none is stored."""
    stored = datasets.get("events")
    if stored is None or not names:
        return ""
    own = stored.isel(event=stored["friction"].values == friction)
    rows = [own.isel(event=own["name"].values == name) for name in names]
    ends = [(float(row["low"][0]), float(row["high"][0])) for row in rows if row.sizes["event"]]
    said = []
    for low, high in ends:
        first, last = f"{low:.3g}", f"{high:.3g}"
        said.append(f"above {first}" if np.isnan(high) else first if first == last else f"between {first} and {last}")
    return f"{', '.join(said)} mg" if said else ""


def _ordered(datasets: Datasets) -> Iterator[Slab]:
    """The slabs of Figs. 6 to 9 and 16: the load path, then dynamics from rest from its first force on."""
    for friction in FRICTIONS:
        name = f"states_mu_{friction:g}"
        if name not in datasets:
            continue
        along = datasets["response"]
        along = along.isel(friction=int(np.abs(along["friction"].values - friction).argmin()))
        sources, parts = [datasets[name]], [(0, along)]
        large, motion = datasets.get("large_forces"), None
        if large is not None and float(large["friction"]) == friction:
            sources.append(datasets["large_force_states"])
            parts.append((1, large))
            motion = float(large["force"].min())
        chosen: list[tuple[int, int]] = []
        rows: list[xr.Dataset] = []
        for source, measured in parts:
            for k, force in enumerate(sources[source]["force"].values.tolist()):
                here = np.flatnonzero(np.isclose(measured["force"].values, force))
                replaced = source == 0 and motion is not None and force >= motion
                if force > 0.0 and here.size and not replaced:
                    chosen.append((source, k))
                    rows.append(measured.isel(force=int(here[0])))
        scene = Scene.from_text(datasets[name].attrs["scene"])
        yield Slab(
            states=tuple(sources),
            polydispersity=0.0,
            friction=friction,
            wall_friction=float(scene.resolved_wall.friction),
            stiffness_ratio=float(scene.contact.stiffness_ratio),
            normal_stiffness=float(scene.contact.normal_stiffness),
            force=np.array([float(row["force"]) for row in rows]),
            chosen=np.array(chosen),
            x=along["x"].values,
            response=np.stack([row["floor_response"].values for row in rows]),
            smoothed=None,
            centre=np.array([float(row["response_at_centre"]) for row in rows]),
            peaks=np.array([float(row["peak_count"]) for row in rows]),
            motion=motion,
        )


def _added(data: xr.Dataset) -> Slab:
    """A slab of the group ``explorer``."""
    loaded = data.isel(state=slice(1, None))
    width = float(data["smoothing_width"])
    # a smoothed response is a stress, as in Fig. 20; so is the force of one disk over the distance to the next one
    spacing = float(np.diff(data["x"].values).mean()) if width else 1.0
    return Slab(
        states=(data,),
        polydispersity=float(data["polydispersity"]),
        friction=float(data["friction"]),
        wall_friction=float(data["wall_friction"]),
        stiffness_ratio=float(data["stiffness_ratio"]),
        normal_stiffness=float(data["normal_stiffness"]),
        force=loaded["force"].values.astype(float),
        chosen=np.array([(0, k) for k in range(1, data.sizes["state"])]),
        x=data["x"].values,
        response=loaded["floor_response"].values / spacing,
        smoothed=loaded["smoothed_response"].values if width else None,
        centre=loaded["response_at_centre"].values,
        peaks=loaded["peak_count"].values,
        width=width,
    )


@dataclass(frozen=True)
class _Contacts:
    """The contacts of a slab that are shown."""

    lines: NDArray[np.int16]  #: (contact, 4) ends at rest, in tenths of a radius from below the load
    strength: FloatArray  #: (k, contact) added force per applied force, negative where compression is lost
    opened: NDArray[np.bool_]  #: (k, contact)
    sliding: NDArray[np.bool_]  #: (k, contact)
    height: float

    @property
    def count(self) -> int:
        return len(self.lines)

    @classmethod
    def of(cls, slab: Slab) -> _Contacts:
        first = slab.states[0]["contact_disk"].values
        second = slab.states[0]["contact_partner"].values
        rest = slab.states[0].isel(state=0)
        place = rest["position"].values.astype(float)
        place = place - np.array([place[int(rest["loaded_disk"]), 0], 0.0])
        ever = np.any([np.any(states["contact_status"].values != OPEN, axis=0) for states in slab.states], axis=0)
        inside = ever & (np.abs(place[first, 0]) <= REACH) & (np.abs(place[second, 0]) <= REACH)
        first, second = first[inside], second[inside]
        at_rest = [_forces(states.isel(state=0), first, second, inside) for states in slab.states]
        strength, opened, sliding = [], [], []
        for applied, (source, k) in zip(slab.force, slab.chosen, strict=True):
            force, along, across, touching = _forces(slab.states[source].isel(state=k), first, second, inside)
            before, along_before, _, touched = at_rest[source]
            sign = np.where(along >= along_before, 1.0, -1.0)
            strength.append(sign * np.linalg.norm(force - before, axis=1) / applied)
            opened.append(touched & ~touching)
            limit = (1.0 - MARGIN) * slab.friction * along
            sliding.append(touching & (np.abs(across) >= limit) & (slab.friction > 0.0))
        return cls(
            np.rint(10.0 * np.concatenate([place[first], place[second]], axis=1)).astype(np.int16),
            np.stack(strength),
            np.stack(opened),
            np.stack(sliding),
            float(place[:, 1].max()) + 1.0,
        )

    def bytes(self, strongest: float) -> bytes:
        """Lines as little-endian 16-bit numbers; then for each force a byte for each contact and a bit for sliding."""
        levels = np.rint(FULL * np.sign(self.strength) * np.sqrt(np.abs(self.strength) / strongest)).astype(np.int8)
        levels[self.opened] = OPENED
        frames = np.concatenate([levels.view(np.uint8), np.packbits(self.sliding, axis=1)], axis=1)
        return self.lines.astype("<i2").tobytes() + frames.tobytes()


def _forces(
    state: xr.Dataset, first: NDArray[np.intp], second: NDArray[np.intp], inside: NDArray[np.bool_]
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.bool_]]:
    """Of contacts ``inside``: (contact, 2) forces on their first disks, normal and tangential parts, what touches."""
    position = state["position"].values.astype(float)
    normal = position[first] - position[second]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along, across = (state[f"contact_{part}_force"].values[inside].astype(float) for part in ("normal", "tangential"))
    return contact_force(normal, along, across), along, across, state["contact_status"].values[inside] != OPEN


def _range(datasets: Datasets) -> list[dict[str, Any]]:
    """The curves of Fig. 6."""
    response = datasets["response"]
    response = response.isel(force=response["force"].values <= LARGEST_OF_FIG_6)
    found = []
    for friction, row in zip(response["friction"].values, response["response_at_centre"].values, strict=True):
        known = np.isfinite(row)
        force = response["force"].values[known].tolist()
        found.append({"friction": float(friction), "force": force, "centre": _rounded(row[known], 6)})
    return found


def _crossovers(datasets: Datasets) -> list[dict[str, Any]]:
    """The curves of Fig. 22 that start with the largest disks in touch, smoothed with ``WIDTH``.

    ``kind`` 1 and 2 are bounds: two peaks at the smallest force already, or not yet at the largest.
    """
    data = datasets["crossovers"]
    data = data.isel(width=int(np.abs(data["width"].values - WIDTH).argmin()))
    data = data.isel(case=data["lattice_constant"].values == "touching-largest")
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
