"""Pictures in one style: for the figures of the paper and for own results.

``response``, ``floor``, ``forces``, ``contacts``, ``stress`` and ``packing`` each draw a result on axes of their own or
the ones given as ``ax``, and return the axes; ``page`` makes one figure of several of them. Below them: ``network``,
``field`` and ``style``, which take arrays.
"""

from __future__ import annotations

from .pictures import contacts, floor, forces, packing, page, response, stress

__all__ = ["contacts", "floor", "forces", "packing", "page", "response", "stress"]
