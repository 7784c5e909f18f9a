"""How equilibrium is reached.

``solution`` settles and loads a scene by the methods that ``choice`` decides once: ``dynamics`` (explicit relaxation),
``energy`` (minimisation where there is no friction), ``equilibrium`` (Newton's method with the contact law), ``path``
(quasi-static loading from one contact event to the next).
"""
