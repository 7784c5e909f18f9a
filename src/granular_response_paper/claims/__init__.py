"""The machinery of claims: records, words, verdicts, bootstrap, table.

What is claimed stands beside each figure group, in ``groups/<group>/claims.py``; :mod:`table` collects it.
"""
