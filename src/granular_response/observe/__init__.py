"""What is measured on states. Arrays in, arrays out; nothing here changes a state.

``floor``       excess floor force, smoothing, the interior
``peaks``       peaks of a response, one or two, symmetry
``events``      bisection of an event over a parameter
``network``     contact changes, orientations, coordination, mirror symmetry
``teardrop``    the region of contacts opened by the load
``difference``  rest and loaded state subtracted contact by contact
``stress``      coarse-grained stress and its balance
``profile``     contact force against horizontal position at a depth
``widths``      how wide a response is, and the power of depth with which that grows
``audit``       a state checked from its positions alone, with none of the solvers' code
"""
