"""The machinery of claims: what the paper says, the tests on stored data, bounds of qualitative terms, verdicts.

What is claimed stands beside each figure group: ``claims.yaml`` holds the sentences with the tests that can be
declared (:mod:`declared`), ``claims.py`` the functions of the others; :mod:`table` collects and judges all of them.
"""
