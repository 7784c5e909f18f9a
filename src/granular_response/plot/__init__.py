"""Pictures in one style: for the figures of the paper and for own results.

``response``, ``floor``, ``forces``, ``contacts``, ``stress`` and ``packing`` each draw a result on axes of their own or
the ones given as ``ax``, and return the axes; ``page`` makes one figure of several of them. Below them: ``network``,
``field`` and ``style``, which take arrays.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .pictures import contacts, floor, forces, packing, page, response, stress

__all__ = ["contacts", "floor", "forces", "packing", "page", "response", "stress"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.pictures"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
