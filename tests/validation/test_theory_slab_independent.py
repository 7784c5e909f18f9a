"""The slab's Fourier series against finite elements."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from granular_response.theory import lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab


def finite_element_floor_force(moduli: Moduli, floor: str, half_width: float, cells: int) -> NDArray[np.float64]:
    """Force on each floor node of the right half of a slab of height 1 (bilinear squares, ``cells`` high)."""
    size, across = 1.0 / cells, round(half_width * cells)
    shear = np.diag([0.0, 0.0, 0.5 * moduli.d])  # engineering shear strain
    stiffness = moduli.matrix() * np.array([[1, 1, 0], [1, 1, 0], [0, 0, 0]]) + shear
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    element = np.zeros((8, 8))
    for gx in (-1, 1):
        for gz in (-1, 1):
            x, z = gx / np.sqrt(3.0), gz / np.sqrt(3.0)
            slope = np.stack([corner[:, 0] * (1 + corner[:, 1] * z), corner[:, 1] * (1 + corner[:, 0] * x)], axis=1) / (
                2.0 * size
            )
            strain = np.zeros((3, 8))
            strain[0, ::2], strain[1, 1::2] = slope[:, 0], slope[:, 1]
            strain[2, ::2], strain[2, 1::2] = slope[:, 1], slope[:, 0]
            element += strain.T @ stiffness @ strain * size**2 / 4.0
    nodes = (across + 1) * (cells + 1)
    index = np.arange(nodes).reshape(across + 1, cells + 1)
    four = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1).reshape(-1, 4)
    unknown = np.stack([2 * four, 2 * four + 1], axis=-1).reshape(-1, 8)
    rows, columns = np.repeat(unknown, 8, axis=1), np.tile(unknown, 8)
    matrix = coo_array((np.tile(element.ravel(), len(four)), (rows.ravel(), columns.ravel()))).tocsr()
    held = np.zeros(2 * nodes, dtype=bool)
    held[2 * index[[0, -1]].ravel()] = True  # symmetry line and smooth side wall
    held[2 * index[:, 0] + 1] = True
    if floor == "rough":
        held[2 * index[:, 0]] = True
    load = np.zeros(2 * nodes)
    load[2 * index[0, -1] + 1] = -0.5
    displacement = np.zeros(2 * nodes)
    displacement[~held] = spsolve(matrix[~held][:, ~held].tocsc(), load[~held])
    return (matrix @ displacement)[2 * index[:, 0] + 1]


@pytest.mark.parametrize("floor", ["rough", "smooth"])
@pytest.mark.parametrize(
    "moduli",
    [Moduli.isotropic(0.0526), Moduli.isotropic(0.6), lattice.moduli(Springs(0.3, 1.0, 0.0, 0.1))],
    ids=["isotropic", "nearly incompressible", "anisotropic"],
)
def test_finite_elements_converge_to_the_series(moduli: Moduli, floor: str) -> None:
    half_width = 3.0
    slab = Slab(1.0, moduli, floor, width=2.0 * half_width)
    errors = []
    for cells in (12, 24):
        node_force = finite_element_floor_force(moduli, floor, half_width, cells)
        assert node_force.sum() == pytest.approx(0.5, rel=1e-9)
        x = np.arange(len(node_force)) / cells
        # The force on a node is that of the hat function around it: half on the first and the last.
        share = node_force * cells * np.where((x == 0.0) | (x == half_width), 2.0, 1.0)
        errors.append(np.max(np.abs(share - slab.floor_pressure(x))) / slab.floor_pressure(0.0))
    assert errors[1] < 4e-3
    assert errors[1] < 0.4 * errors[0]
