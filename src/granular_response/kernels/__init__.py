"""Numba kernels on plain arrays: force loops, neighbour search, integrators, statics and its tangent.

Nothing here knows a scene. Motion lives in flat vectors of generalised coordinates
``q = [x displacements | z displacements | angles]`` of length ``2 n`` without rotations and ``3 n`` with
them; ``v`` and ``f`` are laid out alike. Displacements are measured from the reference positions at which
the candidate contacts were listed, so small overlaps keep their digits.
"""
