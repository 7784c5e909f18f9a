"""What a candidate contact does: the codes that kernels, states, datasets and pictures share."""

from __future__ import annotations

#: Not in touch; in touch within the Coulomb limit (or without friction); at the Coulomb limit.
OPEN, STICKING, SLIDING = 0, 1, 2
#: Their names, in order.
MEANINGS = ("open", "sticking", "sliding")
