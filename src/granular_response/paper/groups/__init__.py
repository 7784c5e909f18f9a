"""One folder for each figure group: ``simulate`` (parameters to datasets) and ``draw`` (datasets to figures)."""
