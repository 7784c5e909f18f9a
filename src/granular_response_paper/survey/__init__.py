"""Ensembles large enough to decide what the paper says of disordered slabs (Secs. VI and VII), in blocks of cases.

They cost too much for the pipeline of the figures, so they have one of their own (``survey/dvc.yaml``), and their
datasets are part of the repository: ``survey/BLOCK.nc``.
"""
