"""Studies of a slab under a growing load: its path, what is measured on it, and where something happens first.

A :class:`LoadPath` holds the states of a scene along its load, each found from the one below it. :class:`Measures` says
what is measured on these states, a :class:`Happening` what is looked for along the path, and :meth:`LoadPath.first` at
which load it happens first. :func:`happenings` has those of the paper. Along anything but the load, such as the
friction, :func:`bisect_event` narrows an event down. Units are the reduced ones: mean radii, and mean disk weights for
forces.

Examples
--------
>>> scene = gr.Scene(packing=gr.Slab(layers=4, disks_per_row=9), loads=[gr.Load(disk="top-centre", force=(0, -1))])
>>> path = gr.studies.LoadPath.of(scene)
>>> states = path.through([0.1, 0.5, 2.0])
>>> opening = gr.studies.first_opening(gr.studies.Measures(path))
>>> low, high = path.first([0.1, 0.5, 2.0], opening)
>>> 0.0 < low < high < 2.0
True
"""

from .brackets import Bracket, EventNotBracketed, First
from .measures import Measures, first_opening, happenings, reaches_floor, two_peaks
from .path import Happening, LoadPath, by_motion, lost
from .search import bisect_event, first_change, linear_end

__all__ = ["Bracket", "EventNotBracketed", "First", "Happening", "LoadPath", "Measures", "bisect_event", "by_motion"]
__all__ += ["first_change", "first_opening", "happenings", "linear_end", "lost", "reaches_floor", "two_peaks"]
