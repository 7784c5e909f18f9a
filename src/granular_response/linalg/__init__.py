"""Factorisations of tangent stiffnesses: banded where the band is narrow, multifrontal elsewhere.

:func:`elimination` chooses; solvers know the protocols :class:`Factor` and :class:`Storage` only.
"""

from .factor import Eliminated, Factor, Storage
from .nearby import Sequence
from .ordering import REMEMBERED, Elimination, elimination

__all__ = ["REMEMBERED", "Eliminated", "Elimination", "Factor", "Sequence", "Storage", "elimination"]
