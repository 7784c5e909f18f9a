"""What the paper says, set against stored data: beside each figure group ``claims.py`` declares its claims,
functions with their sentences (:mod:`claim`); :mod:`table` judges all of them.
"""
