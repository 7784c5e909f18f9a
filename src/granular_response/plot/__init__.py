"""Pictures in one style: for the figures of the paper and for own results.

``response``, ``floor``, ``forces``, ``contacts``, ``stress`` and ``packing`` each draw a result on axes of their own or
the ones given as ``ax``, and return the axes, as does ``photoelastic``; ``page`` makes one figure of several of them,
``animate`` an animation of a growing load, ``motion`` one of moving disks. Below them: ``network``, ``field`` and
``style``, which take arrays.
"""

from .animation import animate
from .motion import motion
from .photoelastic import photoelastic
from .pictures import contacts, floor, forces, packing, page, response, stress
from .shown import PictureError as PictureError

__all__ = ["animate", "contacts", "floor", "forces", "motion", "packing", "page", "photoelastic", "response", "stress"]
