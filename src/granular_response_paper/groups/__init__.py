"""Figure groups, a folder for each; ``groups.json`` lists them, for the pipeline too.

A folder holds ``parameters.py`` (the class ``Parameters``, the group's section of ``params.yaml``), ``simulate``
(parameters to datasets: the study, and beside it what it measures where that is much), ``draw.py`` (datasets to
figures, and what these show) and, where the paper claims something, ``claims.py`` (what is judged from its datasets)
beside ``claims.yaml`` (what the paper says).
"""

import json
from importlib import resources

#: Names of the groups, in an order in which they can run.
NAMES: tuple[str, ...] = tuple(json.loads(resources.files(__name__).joinpath("groups.json").read_text())["groups"])
