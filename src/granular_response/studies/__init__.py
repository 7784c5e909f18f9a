"""One module per figure group: parameters to datasets."""
