"""Questions beyond the paper: figure groups on top of the library and of the paper's reproduction.

Each folder is a figure group, as :mod:`granular_response_paper.registry` describes it.
"""

from granular_response_paper.registry import Collection

COLLECTION = Collection("extensions", __name__, "extensions", "the extensions")
