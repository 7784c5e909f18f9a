"""A scene as arrays: what the solvers work on.

Only the physics that a scene has gets arrays: rotations exist when some contact has friction, tangential
springs only for the contacts (of disks, of walls) that have it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contact import RULES, Law, without_friction
from ..scene import Packing, Scene, SceneError, resolve_disk
from ..state import FloatArray, State, reduced_radii
from ..state.box import bodies
from .candidates import SKIN, list_candidates
from .choice import Plan, plan
from .close_pairs import close_pairs
from .given_springs import given_springs
from .held import NOTHING, Held
from .laws import laws_of
from .overlaps import without_overlaps
from .springs import Kind, carry_springs, spring_contacts, static_contacts

#: Largest overlap of a start, as a part of the smaller radius.
MOST_OVERLAP = 0.5


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


@dataclass(frozen=True, repr=False)
class Problem:
    """A scene with its packing, in the form the kernels take.

    ``load`` is (l, 3): force components and torque on the disks ``load_disk`` (l,), and ``held`` the coordinates that
    loads hold; all empty for gravity alone and until :meth:`with_loads` has chosen the loaded disks on the rest state.
    ``laws`` are those between disks and at walls, row by row (``state.ROWS``); without friction a row bears nothing.
    """

    scene: Scene
    packing: Packing
    laws: tuple[tuple[Any, Any], ...]
    rule: int
    plan: Plan
    load_disk: NDArray[np.int64]
    load: FloatArray
    held: Held = NOTHING

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
        laws = laws_of(scene)
        pair_law, wall_law = laws[0]
        return cls(
            scene=scene,
            packing=start,
            laws=laws,
            rule=RULES[scene.protocol.friction_law],
            plan=plan(scene, start, pair_law, rotations=max(pair_law.friction, wall_law.friction) > 0.0),
            load_disk=np.zeros(0, np.int64),
            load=np.zeros((0, 3)),
        )

    @cached_property
    def pair_law(self) -> Law:
        return self.laws[0][0]

    @cached_property
    def wall_law(self) -> Law:
        return self.laws[0][1]

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
        return replace(self, laws=((pair, wall),), plan=smooth)

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

    def shapes(self, first, second, at_wall) -> tuple[FloatArray | None, FloatArray | None]:
        """(m,) and (w,) what the contact law needs of the radii of pairs, and of disks at walls."""
        radius = self.packing.radius
        return self.pair_law.shapes(radius[first], radius[second]), self.wall_law.shapes(radius[at_wall], None)

    def arms(self, first, second, at_wall) -> tuple[FloatArray, FloatArray]:
        """(m,) and (w,) reduced radii of pairs, and of disks at walls: their own."""
        radius = self.packing.radius
        return reduced_radii(radius[first], radius[second]), reduced_radii(radius[at_wall])

    def bare_state(self) -> State:
        """The unloaded initial packing: no displacement, no motion, and no springs but those that were given.

        Raises SceneError for given contacts that are not those of the packing.
        """
        n, none = self.n, spring_contacts((), ())
        position = np.array(self.packing.position, float)
        bare = self.relisted(State(position, np.zeros(n), np.zeros((n, 2)), np.zeros(n), none, none, self.packing.box))
        if self.packing.contacts is None:
            return bare
        given = self.packing.contacts
        pairs, walls = (given_springs(given, kind, bool(at_wall)) for at_wall, kind in enumerate(self.kinds(bare)))
        return self.with_static_forces(replace(bare, pairs=pairs, walls=walls))

    def relisted(self, state: State) -> State:
        """The same state on candidates listed anew around its positions.

        Raises
        ------
        ValueError
            When a contact that carries a spring is not among the new candidates.
        """
        c = list_candidates(self.packing, self.laws[0], state.position)
        pairs = spring_contacts(c.first, c.second, carry_springs(self.n, state.pairs, c.first, c.second))
        walls = spring_contacts(c.wall_disk, c.wall, carry_springs(self.n, state.walls, c.wall_disk, c.wall))
        return self.with_static_forces(replace(state, pairs=pairs, walls=walls))

    def with_static_forces(self, state: State) -> State:
        """The state with overlaps, spring forces and statuses made from its positions and springs."""
        radius, k = self.packing.radius, state.walls.first
        distance = np.linalg.norm(state.pair_separation(), axis=1)
        gap = self.packing.box.wall_gap(state.position[k], radius[k], state.walls.second)
        overlaps = radius[state.pairs.first] + radius[state.pairs.second] - distance, -gap
        pairs, walls = (
            static_contacts(one.first, one.second, overlap, one.springs, shape, laws)
            for (one, laws, shape), overlap in zip(self.kinds(state), overlaps, strict=True)
        )
        return replace(state, pairs=pairs, walls=walls)

    def kinds(self, state: State) -> tuple[Kind, Kind]:
        """The contacts of a state between disks, then those at walls, each with its laws."""
        pairs, walls = state.pairs, state.walls
        of_pairs, of_walls = zip(*self.laws, strict=True)
        shape, wall_shape = self.shapes(pairs.first, pairs.second, walls.first)
        return Kind(pairs, of_pairs, shape), Kind(walls, of_walls, wall_shape)
