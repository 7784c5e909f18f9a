"""Copies of a packing that differ in the order of arithmetic, or by displacements of the size of rounding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr

from granular_response import studies
from granular_response.observe import network
from granular_response.scene import Packing, Scene
from granular_response.state import FloatArray
from granular_response.store.variables import WEIGHTS
from granular_response_paper import slab_response as slab
from granular_response_paper.groups.symmetry_breaking.parameters import Copies
from granular_response_paper.records import variables


def copies_of(given: Copies, packing: Packing) -> dict[str, Packing]:
    """By how they differ from the packing."""
    found = {"as it is": packing, "numbered from right to left": mirrored(packing)}
    shift, name = random_shift(packing.position.shape, given.displacement, given.seed), f"seed {given.seed}"
    found[f"displaced at random, {name}"] = displaced(packing, shift)
    found[f"displaced at random, {name}, mirror image"] = displaced(packing, shift, mirror_image=True)
    return found


def mirrored(packing: Packing) -> Packing:
    """The mirror image of a packing, each disk with its number: for a symmetric lattice only the numbers change."""
    return replace(packing, position=packing.position * [-1.0, 1.0] + [packing.width, 0.0])


def displaced(packing: Packing, shift: FloatArray, *, mirror_image: bool = False) -> Packing:
    """The packing with its disks moved by ``shift`` (n, 2), or by the mirror image of it."""
    if mirror_image:
        shift = shift[network.mirror_disks(packing.position, 0.5 * packing.width)] * [-1.0, 1.0]
    return replace(packing, position=packing.position + shift)


def random_shift(shape: tuple[int, ...], size: float, seed: int) -> FloatArray:
    """Displacements by up to ``size`` along each axis."""
    return np.random.default_rng(seed).uniform(-size, size, shape)


def copied(scene: Scene, packing: Packing, force: float) -> xr.Dataset:
    """What is measured under one force on one copy of the packing, settled under gravity anew."""
    path = studies.LoadPath.of(scene, packing=packing)
    return slab.measured(studies.Measures(path), [path.at(force)])


def compared(found: Mapping[str, xr.Dataset], force: float) -> xr.Dataset:
    """The copies by name."""
    return slab.measured_along("copy", list(found.values())).assign(
        variables(
            name=("copy", list(found), "how the copy differs from the packing"),
            force=("", force, f"applied force {WEIGHTS}"),
        )
    )
