"""What a scene needs at least: found before anything of its size is allocated, or when its table has been counted."""

from __future__ import annotations

from ..machine import memory
from ..scene import Scene, SceneError

#: Bytes for each disk, measured on slabs of a million: dynamics alone, and with factorisations.
DYNAMICS, STATICS = 700, 5000


def check_memory(scene: Scene, disks: int) -> None:
    """Raise SceneError if the scene with so many disks needs more memory than there is."""
    static = scene.protocol.static_finish or scene.protocol.method != "dynamics"
    needed, available = disks * (STATICS if static else DYNAMICS), memory.available()
    if available is not None and needed > available:
        raise SceneError(
            f"packing: {disks} disks need at least {needed / 2**30:.3g} GiB of memory, "
            f"there are {available / 2**30:.3g} GiB; must be fewer"
        )
