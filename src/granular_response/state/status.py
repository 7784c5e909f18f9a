"""What a candidate contact does: the codes that kernels, states, datasets and pictures share."""

#: Part of its limit by which a force may be below it and count as at the limit.
AT_LIMIT = 1e-9

#: Not in touch; in touch within the Coulomb limit (or without friction); at the Coulomb limit.
OPEN, STICKING, SLIDING = 0, 1, 2
#: Their names, in order.
MEANINGS = ("open", "sticking", "sliding")
