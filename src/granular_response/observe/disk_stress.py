"""Stress inside a disk under the forces at its contacts, in closed form.

A force F on the edge of a half-plane makes the radial stress 2 F·e / (π r) along the unit vector e from where it acts,
at the distance r (Flamant). Such solutions for all contacts of a disk leave the same pressure on its whole rim, which a
uniform tension takes away (Timoshenko and Goodier, *Theory of Elasticity*, 3rd ed., art. 41; Daniels, Kollmer and
Puckett, Rev. Sci. Instrum. 88, 051808 (2017)), if the forces balance. Forces that do not, as those that bear the weight
of the disk, are balanced by a force spread evenly over the disk, and a torque by one that grows with the distance from
the centre: then the rim is free of stress everywhere else, exactly.

Units: mean disk weights per mean radius and per thickness, compression positive as in ``observe.stress``.
"""

from __future__ import annotations

import numpy as np

from ..state import FloatArray


def disk_stress(point: FloatArray, outward: FloatArray, force: FloatArray, radius: float) -> FloatArray:
    """(p, 2, 2) stress tensor at ``point`` (p, 2), places from the centre of the disk.

    Parameters
    ----------
    outward : (c, 2) unit vectors from the centre to where each force acts on the rim.
    force : (c, 2) forces on the disk, in mean disk weights.
    radius : of the disk, in mean radii.

    The stress is infinite where a force acts.

    Examples
    --------
    Two forces P press a disk of radius 1 together. At its centre the compression along them is 3 P / π, the tension
    across P / π:

    >>> disk_stress(np.zeros((1, 2)), np.array([[0, 1], [0, -1]]), np.array([[0, -1], [0, 1]]), 1.0) * np.pi
    array([[[-1.,  0.],
            [ 0.,  3.]]])
    """
    point, outward, force = (np.asarray(given, float) for given in (point, outward, force))
    x, z = point.T
    from_contact = point[:, None] - radius * outward
    square = np.sum(from_contact**2, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        # (2 / π) F·e / r of e e, with r e in place of e
        radial = (2.0 / np.pi) * np.einsum("pci,ci->pc", from_contact, force) / square**2
        stress = np.einsum("pc,pci,pcj->pij", radial, from_contact, from_contact)
    stress += np.sum(force * outward) / (2.0 * np.pi * radius) * np.eye(2)
    (left_x, left_z), area = force.sum(axis=0), np.pi * radius**2
    torque = radius * np.sum(outward[:, 0] * force[:, 1] - outward[:, 1] * force[:, 0])
    # in equilibrium with what is spread over the disk, without a trace
    deviator = (left_z * z - left_x * x) / (2.0 * area) + torque * x * z / (area * radius**2)
    shear = -(left_z * x + left_x * z) / (2.0 * area) - torque * (x**2 - z**2) / (2.0 * area * radius**2)
    return stress + np.stack([deviator, shear, shear, -deviator], axis=-1).reshape(-1, 2, 2)


def principal_difference(stress: FloatArray) -> FloatArray:
    """(...) difference of the principal values of symmetric tensors ``stress`` (..., 2, 2)."""
    return np.hypot(stress[..., 0, 0] - stress[..., 1, 1], 2.0 * stress[..., 0, 1])
