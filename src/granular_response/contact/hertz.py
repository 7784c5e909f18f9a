"""Normal force by the power 3/2 of the overlap, which Sec. III.B names for the paper's disks (H. Hertz, 1882).

``f = K sqrt(R) overlap^(3/2)`` with the reduced radius ``R = R_i R_j / (R_i + R_j)``, at a wall the disk's own. ``K``
follows from the stiffness ``k`` at a normal force of one mean disk weight: ``K sqrt(R) = (2 k / 3)^(3/2)`` there, with
``R`` of two mean disks, or of one at a wall.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..machine.lanes import magnitude, root
from ..state import reduced_radii


class Hertz(NamedTuple):
    """Normal force by the power 3/2, the rest as in the linear law; see :mod:`.law`.

    ``reduced_radius`` is that of the contacts for which ``normal_stiffness`` is given (mean radii).
    """

    normal_stiffness: float
    normal_damping: float
    tangential_stiffness: float
    tangential_damping: float
    friction: float
    least_force: float
    reduced_radius: float
    factor: float  #: K sqrt(reduced_radius)

    @classmethod
    def of(cls, normal_stiffness: float, *constants: float) -> Hertz:
        """The law from the constants of :meth:`.law.Law.of`."""
        return cls._make((normal_stiffness, *constants, (normal_stiffness / 1.5) ** 1.5))

    # Open contacts, with a negative overlap, are asked too; what they answer is not used.
    def elastic_force(self, overlap, shape):
        return self.factor * shape * overlap * root(magnitude(overlap))

    def stiffness(self, overlap, shape):
        return 1.5 * self.factor * shape * root(magnitude(overlap))

    def energy(self, overlap, shape):
        return 0.4 * self.factor * shape * overlap * overlap * root(magnitude(overlap))

    def shapes(self, first, second):
        # 1 between the bodies for which the stiffness is given
        return np.sqrt(reduced_radii(first, second) / self.reduced_radius)

    def stiffest(self, force: float) -> float:
        return self.normal_stiffness * max(force, 0.0) ** (1.0 / 3.0)
