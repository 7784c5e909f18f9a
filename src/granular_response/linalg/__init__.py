"""Factorisations of tangent stiffnesses: banded where the band is narrow, multifrontal elsewhere.

:func:`elimination` chooses.
"""

from .factor import Factor
from .nearby import Sequence
from .ordering import REMEMBERED, Eliminated, Elimination, Storage, elimination

__all__ = ["REMEMBERED", "Eliminated", "Elimination", "Factor", "Sequence", "Storage", "elimination"]
