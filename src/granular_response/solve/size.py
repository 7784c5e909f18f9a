"""What a scene needs at least, found before anything of its size is allocated."""

from __future__ import annotations

from ..machine import memory
from ..scene import Scene, SceneError

#: Bytes for each disk, measured on slabs of a million: dynamics alone, and with factorisations.
DYNAMICS, STATICS = 700, 5000


def least_memory(scene: Scene) -> int:
    """Bytes that solving the scene takes at least; 0 for a packing from a file, which is in memory once counted."""
    static = scene.protocol.static_finish or scene.protocol.method != "dynamics"
    return scene.packing.disk_count * (STATICS if static else DYNAMICS)


def check_memory(scene: Scene) -> None:
    """Raise SceneError if the scene needs more memory than there is."""
    needed, available = least_memory(scene), memory.available()
    if available is not None and needed > available:
        raise SceneError(
            f"packing: {scene.packing.disk_count} disks need at least {needed / 2**30:.1f} GiB of memory, "
            f"there are {available / 2**30:.1f} GiB; must be fewer"
        )
