"""Springs that a user's own packing begins with."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import numpy as np

from ..errors import require
from ..scene import SceneError
from ..scene.contacts import GivenContact
from ..state import Contacts
from ..state.box import bodies
from .springs import Kind, spring_contacts

#: Overlap, in mean radii, that may be rounding of a file, and part of Coulomb's limit.
ROUNDED = 1e-9


def given_springs(given: Sequence[GivenContact], kind: Kind, at_wall: bool) -> Contacts:
    """The contacts of one kind with the springs that were given. SceneError unless they are those of the packing."""
    (c, laws, _), key = kind, "wall" if at_wall else "contact"
    law, rolls = laws[0], any(one.friction > 0.0 for one in laws[1:])
    known = {pair: k for k, pair in enumerate(zip(c.first.tolist(), c.second.tolist(), strict=True))}
    missing = (c.overlap > ROUNDED) & (law.friction > 0.0)
    force, roll = forces = np.zeros((2, len(c.first)))
    for one in (one for one in given if one.at_wall == at_wall):
        k, wrong = known.get((one.first, one.second)), ""
        if k is None or c.overlap[k] < -ROUNDED:
            wrong = "do not touch in this packing"
        elif one.tangential and not law.friction:
            wrong = f"bear a tangential force, {key}.friction must be greater than 0"
        elif math.isnan(one.rolling) if rolls else abs(one.rolling) > 0.0:
            wrong = f"have {'no' if rolls else 'a'} rolling force there, unlike {key}.rolling_friction"
        require(not wrong, f"packing.springs: {one.place}: {one.words} {wrong}", SceneError)
        force[k], roll[k], missing[k] = one.tangential, one.rolling, False
    if missing.any():
        at = int(missing.argmax())
        two = bodies(int(c.first[at]), int(c.second[at]), at_wall)
        raise SceneError(f"packing.springs: {two} overlap by {c.overlap[at]:.2g} mean radii, must be among them")
    if len(over := np.flatnonzero(np.abs(force) > law.friction * (1.0 + ROUNDED))):
        most = f"{np.abs(force).max():.4g} of the normal force, {key}.friction is {law.friction:g}"
        warnings.warn(f"packing.springs: {len(over)} contacts bear up to {most}; they slip", stacklevel=2)
    stiffness = [[one.tangential_stiffness or 1.0] for one in laws]
    return spring_contacts(c.first, c.second, -forces[: len(laws)] * c.normal_force / stiffness)
