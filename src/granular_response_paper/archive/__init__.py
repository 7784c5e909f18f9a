"""The whole reproduction as one file, and back: datasets, figures, claims, sources and how each was made.

``lock`` reads what ``dvc.lock`` says of every stage and compares files with it, ``crate`` writes an RO-Crate,
``restore`` takes the datasets out of one. Neither computes anything, and neither needs DVC.
"""

from granular_response.errors import GranularError


class ArchiveError(GranularError):
    """Files that are not those of ``dvc.lock``, or an archive that is not to be trusted. The message is one line."""
