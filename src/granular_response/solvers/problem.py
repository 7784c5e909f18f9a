"""A scene as arrays: what the solvers work on.

Only the physics that a scene has gets arrays: rotations exist when some contact has friction, tangential
springs only for the contacts (of disks, of walls) that have it.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..contact import RULES, Law, without_friction
from ..contact.rolling import Rolling, arms
from ..errors import require
from ..kernels import neighbours, statics
from ..machine.lanes import WIDTH, aligned, aligned_zeros
from ..scene import Contact, Packing, Scene, SceneError, resolve_disk
from ..state import Contacts, FloatArray, State
from ..state.box import bodies
from .choice import Plan, plan
from .close_pairs import close_pairs
from .held import NOTHING, Held
from .laws import check_parameters, law_class
from .overlaps import without_overlaps

#: Largest gap of a listed candidate pair (mean radii). Half of it is how far disks may move before the list
#: is made again.
SKIN = 0.6
#: Largest overlap of a start, as a part of the smaller radius.
MOST_OVERLAP = 0.5
#: Overlap, in mean radii, that may be rounding of a file, and part of Coulomb's limit.
ROUNDED = 1e-9
#: With less room than this left on the lattice, neighbours are searched instead.
LEAST_LATTICE_LIMIT = 0.25

#: Reduced radius of two disks of mean radius, and of one at a wall.
DISKS, AT_WALL = 0.5, 1.0


@dataclass(frozen=True, repr=False)
class Candidates:
    """Contacts that can exist while no disk is farther than ``limit`` from ``reference``.

    Slots are the storage places of the runs (see ``kernels.forces``); ``slot`` maps each listed pair to its own.
    """

    reference: FloatArray  #: (n, 2) positions that displacements are measured from
    first: NDArray[np.int32]  #: (m,) listed pairs, first < second
    second: NDArray[np.int32]
    slot: NDArray[np.int64]  #: (m,)
    runs: NDArray[np.int64]  #: (r, 4)
    separation: FloatArray  #: (2, slots) reference separations of the slots' disks
    reach: FloatArray  #: (slots,) sums of radii; 0 in slots of no listed pair
    wall_disk: NDArray[np.int64]  #: (w,)
    wall: NDArray[np.int8]  #: (w,)
    wall_gap: FloatArray  #: (w,) reference gaps
    shape: FloatArray | None  #: (slots,) what the law needs of the radii; None for a law that needs nothing
    wall_shape: FloatArray | None  #: (w,)
    limit: float

    def __repr__(self) -> str:
        return f"Candidates({len(self.first)} pairs, {len(self.wall_disk)} at walls, limit={self.limit:g})"


def _check_period(packing: Packing) -> None:
    """Refuse periodic sides between which two disks may meet on both sides: a pair is one contact."""
    if not packing.periodic or len(packing.radius) < 2:
        return
    least = 2.0 * (float(np.sort(packing.radius)[-2:].sum()) + SKIN)
    if packing.width < least:
        raise SceneError(
            f"packing.width: the period is {packing.width:.4g} mean radii, must be at least {least:.4g} for disks of "
            "this size, so that no two meet on both sides"
        )


def _check_overlaps(packing: Packing, most: float) -> None:
    """Refuse disks that begin deeper inside others or walls than ``most`` of the smaller radius.

    What is read as radii or walls is then something else.
    """
    position, radius, box = packing.position, packing.radius, packing.box
    first, second = close_pairs(position, radius, 0.0, box.period)
    apart = np.linalg.norm(box.separation(position[first], position[second]), axis=1)
    disk, wall = box.near_walls(position, radius, 0.0)
    overlap = np.r_[radius[first] + radius[second] - apart, -box.wall_gap(position[disk], radius[disk], wall)]
    smaller = np.r_[np.minimum(radius[first], radius[second]), radius[disk]]
    deep = overlap > most * smaller
    if not deep.any():
        return
    k = int(np.argmax(np.where(deep, overlap / smaller, 0.0)))
    m = k - len(first)
    two = bodies(first[k], second[k], False) if m < 0 else bodies(disk[m], wall[m], True)
    cure = "are radii diameters, and walls and floor where they should be?"
    if packing.given is not None and most < 1.0:
        cure += " For measured disks packing.overlaps: removed takes overlaps of up to a radius out"
    if packing.left is not None:
        cure = "take lattice_constant touching-largest or less polydispersity"
    raise SceneError(
        f"packing: {two} (counted from 0) overlap by {overlap[k]:.3g} mean radii at the start, must be at most "
        f"{most * smaller[k]:.3g}, {'half ' * (most < 1.0)}the smaller radius; {cure}"
    )


def _laws(scene: Scene) -> tuple[Law, Law]:
    """The laws of a scene between disks and at walls."""
    least = -np.inf if scene.protocol.tensile_dashpot else 0.0

    def law(m: Contact, reduced_radius: float) -> Law:
        whole = law_class(scene.contact.law).of(
            m.normal_stiffness, m.normal_damping, m.tangential_stiffness, m.tangential_damping,
            m.friction, least, reduced_radius, **m.parameters.model_dump(),
        )  # fmt: skip
        return whole if m.rubs else without_friction(whole)

    pair, wall = law(scene.contact, DISKS), law(scene.resolved_wall, AT_WALL)
    check_parameters(scene.contact.law, pair, wall)
    return pair, wall


def _rolling(contact: Contact) -> Rolling | None:
    """The rolling resistance of one kind of contact; None without."""
    if not contact.rolls:
        return None
    return Rolling(contact.rolling_stiffness, contact.rolling_damping, contact.rolling_friction)


class Kind(NamedTuple):
    """Contacts of one kind, and their laws."""

    contacts: Contacts
    law: Law
    shape: FloatArray | None  #: (m,) what the law needs of the radii
    rolling: Rolling | None


@dataclass(frozen=True, repr=False)
class Problem:
    """A scene with its packing, in the form the kernels take.

    ``load`` is (l, 3): force components and torque on the disks ``load_disk`` (l,), and ``held`` the coordinates that
    loads hold; all empty for gravity alone and until :meth:`with_loads` has chosen the loaded disks on the rest state.
    """

    scene: Scene
    packing: Packing
    pair_law: Law
    wall_law: Law
    rule: int
    plan: Plan
    load_disk: NDArray[np.int64]
    load: FloatArray
    held: Held = NOTHING
    pair_rolling: Rolling | None = None
    wall_rolling: Rolling | None = None

    @classmethod
    def from_scene(cls, scene: Scene, packing: Packing | None = None) -> Problem:
        """Build the packing (unless given) and the laws of a scene, and decide how it is solved.

        Raises ``SceneError`` for a bad packing, among them, of those that are built here, packings in which disks begin
        deep inside others or walls; and for a method that the scene does not have.
        """
        start = scene.packing.build() if packing is None else packing
        _check_period(start)
        if packing is None:  # a given one is the caller's own
            removed = getattr(scene.packing, "overlaps", "kept") == "removed"
            _check_overlaps(start, 1.0 if removed else MOST_OVERLAP)
            start = without_overlaps(start) if removed else start
        pair_law, wall_law = _laws(scene)
        return cls(
            scene=scene,
            packing=start,
            pair_law=pair_law,
            wall_law=wall_law,
            rule=RULES[scene.protocol.friction_law],
            plan=plan(scene, start, pair_law, rotations=max(pair_law.friction, wall_law.friction) > 0.0),
            load_disk=np.zeros(0, np.int64),
            load=np.zeros((0, 3)),
            pair_rolling=_rolling(scene.contact),
            wall_rolling=_rolling(scene.resolved_wall),
        )

    @cached_property
    def n(self) -> int:
        return len(self.packing.radius)

    def __repr__(self) -> str:
        return f"Problem({self.n} disks, loads on disks {self.load_disk.tolist()}, scene={self.scene!r})"

    @cached_property
    def stiffness(self) -> float:
        """Of the normal springs between disks, at a normal force of one mean disk weight: the scale of stiffnesses."""
        return self.pair_law.normal_stiffness

    @property
    def too_soft(self) -> str:
        """That the lowest contacts overlap by a radius and more under the weight above them; empty where they do not.

        In a column as high as the packing they bear a weight for each diameter.
        """
        if 0.5 * float(self.packing.position[:, 1].max()) <= self.stiffness:
            return ""
        return (
            f"contacts are so soft (contact.normal_stiffness {self.stiffness:g}) that disks sink through each other "
            "under their weight: take a larger one"
        )

    @cached_property
    def pair_friction(self) -> bool:
        return self.pair_law.friction > 0.0

    @cached_property
    def wall_friction(self) -> bool:
        return self.wall_law.friction > 0.0

    @cached_property
    def rolls(self) -> bool:
        """Whether some contact resists rolling."""
        return self.pair_rolling is not None or self.wall_rolling is not None

    @cached_property
    def rotations(self) -> bool:
        return self.pair_friction or self.wall_friction

    @cached_property
    def freedoms(self) -> int:
        """Degrees of freedom of one disk: 3 with rotations, else 2."""
        return 3 if self.rotations else 2

    @cached_property
    def weight(self) -> FloatArray:
        """(n,) weights; their mean is 1."""
        return np.ascontiguousarray(self.packing.mass)

    @cached_property
    def inverse_mass(self) -> FloatArray:
        """(2 n,) or (3 n,) inverse masses and moments of inertia, in the order of ``q``."""
        packing = self.packing
        parts = [1.0 / packing.mass] * 2
        if self.rotations:
            parts.append(1.0 / packing.inertia)
        return np.concatenate(parts)

    @cached_property
    def lattice_pairs(self) -> NDArray[np.int32] | None:
        """(m, 2) neighbours on the lattice; None without one."""
        return self.packing.neighbour_pairs()

    def with_loads(self, position: FloatArray) -> Problem:
        """The same problem with the scene's loads on disks chosen at the rest ``position`` (n, 2)."""
        loads = self.scene.loads
        disk = np.array(
            [resolve_disk(one.disk, self.packing, position, key=f"loads[{k}].disk") for k, one in enumerate(loads)],
            np.int64,
        )
        return replace(
            self,
            load_disk=disk,
            load=np.array([[*load.force, load.torque] for load in loads], float).reshape(-1, 3),
            held=Held.by(loads, disk, position),
        )

    def without_friction(self) -> Problem:
        """The same packing with smooth disks and walls."""
        pair, wall = without_friction(self.pair_law), without_friction(self.wall_law)
        smooth = plan(self.scene, self.packing, pair, rotations=False)
        return replace(self, pair_law=pair, wall_law=wall, pair_rolling=None, wall_rolling=None, plan=smooth)

    @cached_property
    def load_size(self) -> float:
        """Mean disk weights of one unit of the load factor: a torque counts as a force at one radius, a displacement
        as what it takes to press it into a contact."""
        applied = np.hypot(self.load[:, 0], self.load[:, 1]).sum()
        size = max(float(applied), float(np.abs(self.load[:, 2]).sum()), 1e-300)
        return size + self.stiffness * float(np.abs(self.held.travel).sum())

    @cached_property
    def load_vector(self) -> FloatArray:
        """(dof,) generalised load at load factor 1; nothing on what is held."""
        total = np.zeros((3, self.n))
        np.add.at(total.T, self.load_disk, self.load)
        total[self.held.axis, self.held.disk] = 0.0
        return total[: self.freedoms].ravel()

    @property
    def crossing_time(self) -> float:
        """In which a compression wave runs through the packing, in sqrt(R/g): before, parts know nothing of others."""
        return float(self.packing.position[:, 1].max()) / (2.0 * self.scene.contact.normal_stiffness**0.5)

    @property
    def swing_time(self) -> float:
        """A whole period of the slowest motion, in sqrt(R/g): a wave up and down twice, its foot held, or to and fro
        between the sides, at a speed between those of shear and of compression (1.2 and 2.1 sqrt(k R/m)).

        The slowest period of the paper's slab is 0.82 to 0.94 of it with smooth walls and 0.38 with rough ones.
        """
        way = max(4.0 * float(self.packing.position[:, 1].max()), 2.0 * self.packing.width)
        return way / (1.5 * self.scene.contact.normal_stiffness**0.5)

    @cached_property
    def weight_vector(self) -> FloatArray:
        """(dof,) generalised gravity; nothing on what is held."""
        total = np.zeros((self.freedoms, self.n))
        total[1] = -self.weight
        total[self.held.axis, self.held.disk] = 0.0
        return total.ravel()

    @cached_property
    def slides_freely(self) -> bool:
        """Whether nothing holds the packing as a whole along x: no side walls, a smooth floor, no displacement."""
        return self.packing.periodic and not self.wall_friction and not (self.held.axis == 0).any()

    def list_candidates(self, position: FloatArray, *, search: bool = False, stride: float = 0.0) -> Candidates:
        """List candidate contacts at ``position`` (n, 2).

        As long as every disk is near its lattice site, the neighbours on the lattice are the only ones that can
        touch, and nothing is searched. ``search=True`` forces the search. The list holds for displacements of at
        least ``stride``.
        """
        packing, radius = self.packing, self.packing.radius
        pairs = None if search else self.lattice_pairs
        limit = 0.0
        if pairs is not None and packing.lattice_constant is not None:
            # second neighbours touch once two disks have moved this far towards each other
            room = np.sqrt(3.0) * packing.lattice_constant - 2.0 * float(radius.max())
            shift = np.linalg.norm(position - packing.position, axis=1)
            limit = 0.5 * room - float(shift.max())
        if pairs is not None and limit > max(LEAST_LATTICE_LIMIT, stride):
            first, second = pairs[:, 0], pairs[:, 1]
            margin = 2.0 * limit
        else:
            margin = max(SKIN, 2.0 * stride)
            first, second = close_pairs(position, radius, margin, packing.box.period)
            limit = 0.5 * margin
        runs, slot = neighbours.make_runs(first, second, self.n, multiple=WIDTH)
        i, j = neighbours.run_pairs(runs)
        reach = aligned_zeros(len(i))  # slots of no listed pair have none
        reach[slot] = radius[first] + radius[second]
        shapes = self.pair_shapes(first, second)
        shape = None
        if shapes is not None:
            shape = aligned_zeros(len(i))
            shape[slot] = shapes
        wall_disk, wall = packing.box.near_walls(position, radius, margin)
        return Candidates(
            reference=position.copy(),
            first=first.astype(np.int32),
            second=second.astype(np.int32),
            slot=slot,
            runs=runs,
            separation=aligned(packing.box.separation(position[i], position[j]).T),
            reach=reach,
            wall_disk=wall_disk,
            wall=wall,
            wall_gap=packing.box.wall_gap(position[wall_disk], radius[wall_disk], wall),
            shape=shape,
            wall_shape=self.wall_shapes(wall_disk),
            limit=limit,
        )

    def pair_shapes(self, first, second) -> FloatArray | None:
        """(m,) what the contact law needs of the radii of pairs."""
        radius = self.packing.radius
        return self.pair_law.shapes(radius[first], radius[second])

    def wall_shapes(self, disk) -> FloatArray | None:
        """(w,) what the contact law needs of the radii of disks at walls."""
        return self.wall_law.shapes(self.packing.radius[disk], None)

    def pair_arms(self, first, second) -> FloatArray:
        """(m,) reduced radii of pairs."""
        radius = self.packing.radius
        return arms(radius[first], radius[second])

    def wall_arms(self, disk) -> FloatArray:
        """(w,) arms at which disks roll on walls: their radii."""
        return arms(self.packing.radius[disk])

    def bare_state(self) -> State:
        """The unloaded initial packing: no displacement, no motion, and no springs but those that were given.

        Raises SceneError for given contacts that are not those of the packing.
        """
        n, none = self.n, spring_contacts((), ())
        position = np.array(self.packing.position, float)
        bare = self.relisted(State(position, np.zeros(n), np.zeros((n, 2)), np.zeros(n), none, none, self.packing.box))
        if self.packing.contacts is None:
            return bare
        pairs, walls = (self._given(kind, at_wall) for at_wall, kind in enumerate(self.kinds(bare)))
        return self.with_static_forces(replace(bare, pairs=pairs, walls=walls))

    def _given(self, kind: Kind, at_wall: int) -> Contacts:
        """The contacts of one kind with the springs that were given."""
        (c, law, _, rolling), key = kind, ("contact", "wall")[at_wall]
        known = {pair: k for k, pair in enumerate(zip(c.first.tolist(), c.second.tolist(), strict=True))}
        missing = (c.overlap > ROUNDED) & (law.friction > 0.0)
        force, roll = np.zeros((2, len(c.first)))
        for one in (one for one in self.packing.contacts or () if one.at_wall == at_wall):
            k, wrong = known.get((one.first, one.second)), ""
            if k is None or c.overlap[k] < -ROUNDED:
                wrong = "do not touch in this packing"
            elif one.tangential and not law.friction:
                wrong = f"bear a tangential force, {key}.friction must be greater than 0"
            elif abs(one.rolling) > 0.0 if rolling is None else math.isnan(one.rolling):
                wrong = f"have {'a' if rolling is None else 'no'} rolling force there, unlike {key}.rolling_friction"
            require(not wrong, f"packing.springs: {one.place}: {one.words} {wrong}", SceneError)
            force[k], roll[k], missing[k] = one.tangential, one.rolling, False
        if missing.any():
            at = int(missing.argmax())
            two = bodies(int(c.first[at]), int(c.second[at]), bool(at_wall))
            raise SceneError(f"packing.springs: {two} overlap by {c.overlap[at]:.2g} mean radii, must be among them")
        if len(over := np.flatnonzero(np.abs(force) > law.friction * (1.0 + ROUNDED))):
            most = f"{np.abs(force).max():.4g} of the normal force, {key}.friction is {law.friction:g}"
            warnings.warn(f"packing.springs: {len(over)} contacts bear up to {most}; they slip", stacklevel=2)
        spring = -force * c.normal_force / (law.tangential_stiffness or 1.0)
        turned = None if rolling is None else -roll * c.normal_force / rolling.stiffness
        return spring_contacts(c.first, c.second, spring, turned)

    def relisted(self, state: State) -> State:
        """The same state on candidates listed anew around its positions.

        Raises
        ------
        ValueError
            When a contact that carries a spring is not among the new candidates.
        """
        c = self.list_candidates(state.position)
        pairs = spring_contacts(c.first, c.second, *carry_springs(self.n, state.pairs, c.first, c.second))
        walls = spring_contacts(c.wall_disk, c.wall, *carry_springs(self.n, state.walls, c.wall_disk, c.wall))
        return self.with_static_forces(replace(state, pairs=pairs, walls=walls))

    def with_static_forces(self, state: State) -> State:
        """The state with overlaps, spring forces and statuses made from its positions and springs."""
        radius, k = self.packing.radius, state.walls.first
        distance = np.linalg.norm(state.pair_separation(), axis=1)
        gap = self.packing.box.wall_gap(state.position[k], radius[k], state.walls.second)
        overlaps = radius[state.pairs.first] + radius[state.pairs.second] - distance, -gap
        pairs, walls = (
            static_contacts(one.first, one.second, overlap, one.spring, shape, law, rolling, one.rolling_spring)
            for (one, law, shape, rolling), overlap in zip(self.kinds(state), overlaps, strict=True)
        )
        return replace(state, pairs=pairs, walls=walls)

    def kinds(self, state: State) -> tuple[Kind, Kind]:
        """The contacts of a state between disks, then those at walls, each with its laws."""
        pairs, walls = state.pairs, state.walls
        return (
            Kind(pairs, self.pair_law, self.pair_shapes(pairs.first, pairs.second), self.pair_rolling),
            Kind(walls, self.wall_law, self.wall_shapes(walls.first), self.wall_rolling),
        )


def carry_springs(n: int, contacts: Contacts, first, second) -> tuple[FloatArray, FloatArray]:
    """Tangential and rolling springs of ``contacts`` in the order of another list ``(first, second)`` of the same kind.

    Raises
    ------
    ValueError
        When a contact that carries a spring is not in the other list.
    """
    if np.array_equal(contacts.first, first) and np.array_equal(contacts.second, second):
        return contacts.spring.copy(), contacts.rolling_spring.copy()
    held = np.flatnonzero((contacts.spring != 0.0) | (contacts.rolling_spring != 0.0))
    key = np.asarray(first, np.int64) + n * np.asarray(second, np.int64)
    by = np.argsort(key)
    wanted = contacts.first[held].astype(np.int64) + n * contacts.second[held].astype(np.int64)
    place = np.searchsorted(key[by], wanted)
    lost = np.append(key[by], -1)[place] != wanted
    if lost.any():
        k = held[np.flatnonzero(lost)[0]]
        raise ValueError(f"contact {contacts.first[k]}-{contacts.second[k]} carries a spring but is not listed")
    springs, rolling = np.zeros((2, len(key)))
    springs[by[place]] = contacts.spring[held]
    rolling[by[place]] = contacts.rolling_spring[held]
    return springs, rolling


def static_contacts(
    first, second, overlap, spring, shape, law: Law, rolling: Rolling | None = None, rolling_spring=None
) -> Contacts:
    """Contacts with the spring parts of their forces (Sec. III.A without velocities)."""
    size = len(overlap)
    out = statics.Response.empty(size, rolls=rolling is not None)
    statics.spring_forces(overlap, spring, shape, law, out)
    if rolling is not None:
        statics.rolling_spring_forces(rolling_spring, rolling, out)
    status = out.status.astype(np.int8)
    rows = (slice(at, at + size) for at in (0, size)[: 1 + (rolling is not None)])
    parts: list[Any] = [part for row in rows for part in (out.tangential[row], out.spring[row], status[row])]
    return Contacts(np.asarray(first, np.int32), np.asarray(second, np.int32), overlap, out.normal, *parts)


def spring_contacts(
    first, second, spring: FloatArray | None = None, rolling_spring: FloatArray | None = None
) -> Contacts:
    """Contacts of which no more is known than their springs, or not even these; zero stands for it."""
    zero = np.zeros(len(first))
    return Contacts(
        np.asarray(first, np.int32), np.asarray(second, np.int32),
        zero, zero, zero, zero if spring is None else spring, zero.astype(np.int8),
        rolling_spring=zero if rolling_spring is None else rolling_spring,
    )  # fmt: skip
