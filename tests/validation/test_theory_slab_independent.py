"""The slab's Fourier series against two discretisations: finite elements and a packing of springs."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from granular_response.theory import crossover, lattice
from granular_response.theory.lattice import Springs
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab, response_of_layers


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


def packing_floor_share(
    layers: int, disks_per_row: int, normal: float, tangential: float, *, horizontal: bool = True
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Floor disks' positions and shares of a small force on the middle top disk of a triangular packing.

    Linear springs at every contact, disks free to turn, floor and side walls twice as stiff and smooth.
    """
    position = []
    for layer in range(layers):
        count = disks_per_row - layer % 2
        position += [(2.0 * i + 1.0 + layer % 2, 1.0 + np.sqrt(3.0) * layer) for i in range(count)]
    disk = np.array(position)
    n = len(disk)
    by_place = {(round(x), round((z - 1.0) / np.sqrt(3.0))): i for i, (x, z) in enumerate(disk)}
    entries: list[tuple[list[tuple[int, float]], float]] = []
    for (x, layer), i in by_place.items():
        for dx, dz in ((2, 0), (1, 1), (-1, 1)):
            j = by_place.get((x + dx, layer + dz))
            if j is None:
                continue
            nx, nz = dx / 2.0, dz * np.sqrt(3.0) / 2.0
            if dz or horizontal:
                entries.append(([(3 * j, nx), (3 * j + 1, nz), (3 * i, -nx), (3 * i + 1, -nz)], normal))
                shift = [(3 * j, -nz), (3 * j + 1, nx), (3 * i, nz), (3 * i + 1, -nx)]
                entries.append(([*shift, (3 * i + 2, -1.0), (3 * j + 2, -1.0)], tangential))
        if layer == 0:
            entries.append(([(3 * i + 1, 1.0)], 2.0 * normal))
        if x in (1, 2 * disks_per_row - 1):
            entries.append(([(3 * i, 1.0)], 2.0 * normal))
    row = np.concatenate([[r] * len(spring) for r, (spring, _) in enumerate(entries)])
    column = np.array([c for spring, _ in entries for c, _ in spring])
    value = np.array([v for spring, _ in entries for _, v in spring])
    stretch = coo_array((value, (row, column)), shape=(len(entries), 3 * n)).tocsr()
    k = np.array([stiffness for _, stiffness in entries])
    matrix = (stretch.T @ (stretch * k[:, None])).tolil()
    if tangential == 0.0:
        for i in range(n):
            matrix[3 * i + 2, 3 * i + 2] = 1.0
    load = np.zeros(3 * n)
    top = np.flatnonzero(disk[:, 1] == disk[:, 1].max())
    loaded = top[len(top) // 2]
    load[3 * loaded + 1] = -1.0
    u = spsolve(matrix.tocsc(), load)
    return disk[:disks_per_row, 0] - disk[loaded, 0], -2.0 * normal * u[1 : 3 * disks_per_row : 3]


@pytest.mark.parametrize("ratio", [0.0, 0.8], ids=["frictionless", "sticking"])
def test_packing_of_springs_tends_to_the_isotropic_slab(ratio: float) -> None:
    moduli = lattice.moduli(Springs.uniform(1.0, ratio), "free")
    for layers, disks, tolerance in ((15, 61, 4e-3), (31, 125, 2e-3)):
        x, share = packing_floor_share(layers, disks, 1.0, ratio)
        assert share.sum() == pytest.approx(1.0, rel=1e-9)
        elastic = response_of_layers(x, layers=layers, moduli=moduli, floor="smooth", width=2.0 * disks)
        error = np.abs(share - elastic)[np.abs(x) < 2.0 * layers].max() / elastic.max()
        assert error < tolerance


@pytest.mark.parametrize("beta", [0.25, 0.32], ids=["two peaks", "one peak"])
def test_packing_without_horizontal_springs_has_the_moduli_of_free_rotations(beta: float) -> None:
    error: dict[str, list[float]] = {"free": [], "suppressed": []}
    for layers, disks in ((15, 61), (31, 125)):
        x, share = packing_floor_share(layers, disks, 1.0, beta, horizontal=False)
        for rotations, series in error.items():
            moduli = lattice.moduli(Springs(0.0, 1.0, 0.0, beta), rotations)
            elastic = response_of_layers(x, layers=layers, moduli=moduli, floor="smooth", width=2.0 * disks)
            series.append(np.abs(share - elastic).max() / elastic.max())
    assert error["free"][1] < 0.5 * error["free"][0]
    assert error["suppressed"][1] > 0.5 * error["suppressed"][0]
    middle = len(x) // 2
    assert (share[middle] > share[middle + 1]) == (beta > crossover.stiffness_ratio("smooth floor", "free"))
