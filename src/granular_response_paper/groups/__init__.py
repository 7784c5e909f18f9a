"""Figure groups of the paper; :mod:`granular_response_paper.registry` says what the folder of one holds."""
