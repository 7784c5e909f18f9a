"""What the studies of fields, piles and torques measure themselves, on hand-made input, and how it is put together."""

from dataclasses import replace

import numpy as np

from granular_response.observe import stress as coarse
from granular_response.scene import Scene, SlabPacking
from granular_response.studies import LoadPath, Measures
from granular_response.theory.lattice import poisson_ratio
from granular_response.theory.moduli import Moduli
from granular_response.theory.slab import Slab
from granular_response_paper import slab_response
from granular_response_paper.harmonic import harmonic_lattice


def test_harmonic_lattice_is_isotropic_where_it_is_fine() -> None:
    """Against the isotropic slab of the same Poisson ratio, a few disks away from the load."""
    packing = SlabPacking(layers=15, disks_per_row=61).build()
    load = np.zeros((packing.n, 2))
    load[-31, 1] = -1.0
    forces = harmonic_lattice(packing, load, 1.0, 2.0)
    x = np.linspace(-30.0, 30.0, 61)
    height = 10.0
    found = coarse.coarse_grained_stress(forces, np.stack([x + 61.0, np.full(61, height)], axis=1), 2.0)
    body = Slab(15 * np.sqrt(3.0), Moduli.isotropic(poisson_ratio(1.0, 0.0)), "smooth", 122.0)
    expected = -body.stress(x, height, smoothing=np.sqrt(2.0))[1]
    np.testing.assert_allclose(found[:, 1, 1], expected, atol=0.04 * expected.max())


def test_measurements_fit_together_where_few_states_have_disks_that_nothing_determines():
    described = Scene().updated({"packing": {"layers": 4, "disks_per_row": 11}, "loads.0.force": [0.0, -1.0]})
    path = LoadPath.of(described)
    state, measures = path.at(0.1), Measures(path)
    loose = replace(state, reached=replace(state.reached, certificate=replace(state.certificate, undetermined=(2,))))
    found = [slab_response.measured(measures, [one]) for one in (state, loose, state)]
    assert slab_response.measured_along("force", found).sizes["force"] == 3
    assert slab_response.measured_along("force", found[1:]).sizes["force"] == 2
