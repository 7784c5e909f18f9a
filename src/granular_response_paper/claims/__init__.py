"""The machinery of claims: records, words, verdicts, bootstrap, table.

What is claimed stands beside each figure group: texts in ``groups/<group>/claims.yaml``, the functions that measure in
``claims.py``; :mod:`table` collects both.
"""
