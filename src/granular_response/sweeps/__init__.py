"""One function on many items: cores, Dask, checkpoints, and the rest states that they share."""
