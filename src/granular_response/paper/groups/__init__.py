"""Figure groups, a folder for each; ``NAMES`` is their list.

A folder holds ``parameters.py`` (the class ``Parameters``, the group's section of ``params.yaml``), ``simulate.py``
(parameters to datasets), ``draw.py`` (datasets to figures), ``captions.py`` (what the figures show) and, where the
paper claims something, ``claims.py`` (what is judged from its datasets).
"""

#: In the order in which they are drawn.
NAMES = (
    "theory",
    "slab_comparison",
    "frictionless_crossover",
    "friction_linear_range",
    "symmetry_breaking",
    "stiffness_ratio_crossover",
    "friction_fields",
    "pile_dip",
    "torque",
    "polydisperse_averages",
    "phase_diagram",
    "sensitivity",
    "superposition",
    "numerics",
    "stability",
)
