"""Trials that push the dynamics and the solvers to where they may fail; the study ``stability`` runs them."""
