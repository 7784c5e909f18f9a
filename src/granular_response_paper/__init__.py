"""The reproduction of the paper, on top of the library: figure groups, claims, report."""

#: Whose code makes what tasks hand back, and whose classes hold it: see ``granular_response.sweeps.resources``.
PACKAGE = __name__

#: What simulating, drawing and judging may raise where allowed parameters have left nothing of what they look at.
TOO_LITTLE = (ArithmeticError, IndexError, KeyError, ValueError)
