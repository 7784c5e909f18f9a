"""What a reading can change of the paper's set-up: the one place that tells a variant from an interpretation.

A reading without a change is an *interpretation*: the text allows it, and the verdict follows from these alone. A
reading with one of these changes is a *variant*: the text says otherwise, and it shows how robust the statement is.
"""

from __future__ import annotations

#: Every change, in the order in which what breaks first is looked for, and what the text says instead.
CHANGES: dict[str, str] = {
    "gravity": "Gravity grown slowly, or applied before there is friction. Sec. III.C lets the packing relax under "
    "gravity and grows the external force alone.",
    "walls": "Rough walls. The caption of Fig. 16 has smooth ones.",
    "stiffness": "Contacts of k_N = 1e5. The results of Sec. IV pertain to k_N = 3000 (Sec. IV.C).",
    "lattice": "An initial lattice wider than that in which the largest disks touch. The lattice constant of Sec. "
    "III.C is twice the mean radius; what lies between the two is taken as an interpretation.",
    "smoothing": "Smoothing with w = 3. The caption of Fig. 21, from which Fig. 22 is drawn, has w = 6.",
}
