"""Time integrators, one module each, with one record that describes it.

An integrator keeps its memory in ``history``, with ``rows`` rows of ``dof`` entries or more; row 0 is the acceleration
at the present time, the last row scratch. ``advance(steps, dt, schedule, limit, q, v, history, velocity, model)`` takes
up to ``steps`` steps and returns how many it took: fewer when a disk has moved so far that the candidate contacts must
be listed again. ``schedule = (time, gravity_from, gravity_to, gravity_time, load_from, load_to, load_time)`` gives the
linear ramps of gravity and load; ``limit`` is the displacement that ends the validity of the candidate list (``inf``:
never checked); ``velocity`` is scratch for the predicted velocity.
"""

from . import beeman, gear, verlet
from .record import Integrator

INTEGRATORS: dict[str, Integrator] = {module.RECORD.name: module.RECORD for module in (beeman, verlet, gear)}

__all__ = ["INTEGRATORS", "Integrator"]
