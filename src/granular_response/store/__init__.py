"""Results as labelled files, whole or not at all; exports and summaries of them."""
