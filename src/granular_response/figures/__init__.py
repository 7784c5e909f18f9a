"""One module per figure group: datasets to figures; one shared style."""
