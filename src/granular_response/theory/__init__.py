"""Elastic and hyperbolic references in closed form, or as series summed to rounding.

``moduli`` holds the elastic constants every other module takes; ``lattice`` computes them for the spring
lattice of Sec. V.C; ``half_plane``, ``slab`` and ``rays`` predict the pressure under a localized force.
Everything is two-dimensional and static.

Examples
--------
>>> gr.theory.half_plane.pressure([0.0], 10.0, gr.theory.moduli.Moduli.isotropic(0.3)).round(4)
array([0.0637])
"""

from . import half_plane, lattice, moduli, rays, slab

__all__ = ["half_plane", "lattice", "moduli", "rays", "slab"]
