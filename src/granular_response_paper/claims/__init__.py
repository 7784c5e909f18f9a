"""What the paper says, set against stored data: beside each figure group ``claims.yaml`` declares the claims, which
:mod:`declared` describes, and ``claims.py`` has the functions of some; :mod:`table` judges all of them.
"""
