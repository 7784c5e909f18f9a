"""What is measured on a slab under a growing force on one disk, and what may happen there (Sec. V of the paper).

Forces are in mean disk weights, lengths in mean radii.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..errors import check_positive, require
from ..observe import network, peaks
from ..observe.floor import floor_disks, floor_response, interior_mask, smoothed_response, wall_margin
from ..observe.teardrop import OpenRegion, open_region
from ..state import FloatArray, State
from ..store.result import common_candidates
from .path import Happening, LoadPath

#: A contact is mobilised when its tangential force is within one of these fractions of the Coulomb limit.
#: Whether it slides is lost in the last vibrations before rest, which take it off the limit by a little.
MARGINS = (0.01, 0.05)

#: The linear range ends where the response at x = 0 differs by this fraction from that to the smallest force.
LINEARITY = 0.01

#: What counts as an event.
FIRST_OPENING = "a contact of disks in the central third of the slab is open that touches at rest"
ANY_OPENING = "a contact of disks anywhere in the slab is open that touches at rest"
TWO_PEAKS = "on each side of x = 0 the floor response has a peak that exceeds the response at x = 0"
REACHES_FLOOR = "the region of opened contacts below the load contains a contact of the bottom row"


class Measures:
    """What is measured on the loaded states of one slab under a force on one disk.

    ``x`` are the places of the floor disks from the loaded disk, at rest; ``interior`` is true for those away from the
    side walls, where peaks are looked for. Contacts near the load are those of disks in the central third.

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> measures = gr.studies.Measures(path)
    >>> measures.opened(path.at(0.001)), measures.double_peaked(path.at(0.001)), round(measures.width)
    (0, False, 18)
    """

    def __init__(self, path: LoadPath) -> None:
        packing = path.problem.packing
        self.rest, self.width = path.rest, packing.width
        self.friction = path.scene.contact.friction
        self.loaded_disk = int(path.problem.load_disk[0])
        self.lattice_constant = float(packing.lattice_constant or 2.0)
        self.disks = floor_disks([path.rest], np.flatnonzero(packing.row == 0))
        middle = float(path.rest.position[self.loaded_disk, 0])
        self.x: FloatArray = path.rest.position[self.disks, 0] - middle
        self.interior = interior_mask(self.x, packing.width, wall_margin(packing.width), left_wall=-middle)
        # Near the load means the central third, as in Figs. 4, 8 and 9. Towards the upper corners some contacts
        # carry almost nothing under gravity, so that they open under the least force.
        self.near = network.interior_contacts(path.rest, packing.width, packing.width / 3.0)
        self._lattice, self._radius = packing.position, packing.radius

    @property
    def confinement(self) -> float:
        """Mean normal force at rest of the horizontal contacts in the central third that touch; 0 where none does."""
        pairs = self.rest.pairs
        level = pairs.touching & (network.lattice_direction(self.rest) == network.HORIZONTAL) & self.near
        return float(pairs.normal_force[level].mean()) if level.any() else 0.0

    @cached_property
    def mirror(self) -> NDArray[np.intp]:
        """(n,) mirror images in the middle, on the undeformed lattice; rows between periodic sides have none."""
        return network.mirror_disks(self._lattice, 0.5 * self.width)

    def response(self, state: State) -> FloatArray:
        """(floor_disk,) floor response per applied force."""
        return floor_response(self.rest, state, self.disks, abs(state.load_factor))

    def centre(self, state: State, width: float = 0.0) -> float:
        """Response at x = 0; that of a disordered packing is smoothed, with a Gaussian of ``width``."""
        if width:
            return float(smoothed_response([0.0], self.x, self.response(state), width)[0])
        return float(np.interp(0.0, self.x, self.response(state)))

    def dip(self, state: State) -> float:
        """How far the response at x = 0 is below the lower maximum beside it, per largest response."""
        return peaks.central_dip(self.x, self.response(state), interior=self.interior)

    def opened(self, state: State, anywhere: bool = False) -> int:
        """Number of contacts of disks that the load opened in the central third, or ``anywhere`` in the slab."""
        rest, state, near = self._matched(state)
        return int(np.count_nonzero(network.opened(rest.pairs, state.pairs) & (near | anywhere)))

    def double_peaked(self, state: State, prominence: float = peaks.RELATIVE_PROMINENCE) -> bool:
        """Whether the floor response has two peaks, as :func:`two_peaks` defines them."""
        return peaks.is_double_peaked(
            self.x, self.response(state), interior=self.interior, relative_prominence=prominence
        )

    def third_peak(self, state: State) -> float:
        """Prominence of the further peak of a double-peaked response at x = 0; 0 without it."""
        return peaks.third_peak(self.x, self.response(state), interior=self.interior)

    def asymmetry(self, state: State) -> float:
        """Largest difference of the response and its mirror image, per largest response."""
        return peaks.asymmetry(self.x, self.response(state), interior=self.interior)

    def region(self, state: State) -> OpenRegion:
        """The opened contacts below the load."""
        rest, state, near = self._matched(state)
        opened, origin = network.opened(rest.pairs, state.pairs), rest.position[self.loaded_disk]
        return open_region(rest, opened, origin, start=near, lattice_constant=self.lattice_constant)

    def _matched(self, state: State) -> tuple[State, State, NDArray[np.bool_]]:
        """The rest state and this one on one list of candidates, which dynamics may have made anew, and those near."""
        rest, state = common_candidates([self.rest, state], self._radius)
        near = self.near if rest is self.rest else network.interior_contacts(rest, self.width, self.width / 3.0)
        return rest, state, near

    def mobilised(self, state: State) -> list[int]:
        """Number of contacts of disks within each of ``MARGINS`` of the Coulomb limit."""
        return [int(state.pairs.near_limit(self.friction, margin).sum()) for margin in MARGINS]


def first_opening(measures: Measures, anywhere: bool = False) -> Happening:
    """The first contact opens, in the central third of the slab or ``anywhere`` in it.

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> gr.studies.first_opening(gr.studies.Measures(path)).happened(path.at(0.001))
    False
    """
    text = ANY_OPENING if anywhere else FIRST_OPENING
    return Happening(lambda state: measures.opened(state, anywhere) > 0, text, of_contacts=True)


def reaches_floor(measures: Measures) -> Happening:
    """The open contacts reach the floor.

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> gr.studies.reaches_floor(gr.studies.Measures(path)).happened(path.at(0.001))
    False
    """
    return Happening(lambda state: measures.region(state).reaches_floor, REACHES_FLOOR, of_contacts=True)


def two_peaks(measures: Measures, prominence: float = peaks.RELATIVE_PROMINENCE) -> Happening:
    """The floor response has two peaks: the crossover (Sec. IV.A).

    It has two peaks where on each side of x = 0, below the loaded disk, there is a local maximum that exceeds the
    response at x = 0 by at least ``prominence`` times the largest response, and lower dips than that separate no
    peaks. The default is 0.001, a tenth of a percent, which a printed curve hardly shows: there it is a plateau. A dip
    that the eye sees is about 0.01. Floor disks near the side walls (``Measures.interior``) are left out.

    Raises ``ValueError`` for a ``prominence`` that is not positive, or not below 1, the largest response itself.

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> measures = gr.studies.Measures(path)
    >>> gr.studies.two_peaks(measures).happened(path.at(0.001))
    False
    >>> gr.studies.two_peaks(measures, prominence=0.01).definition.endswith("by 0.01 of the largest response")
    True
    """
    check_positive(prominence=prominence)
    require(prominence < 1.0, f"prominence = {prominence:g}: must be below 1, 0.01 is a per cent", ValueError)
    text = TWO_PEAKS
    if prominence != peaks.RELATIVE_PROMINENCE:
        text += f" by {prominence:g} of the largest response"
    return Happening(lambda state: measures.double_peaked(state, prominence), text)


def happenings(measures: Measures, smallest: State, asymmetry: float) -> dict[str, Happening]:
    """What happens along a load path of the paper's slabs, by name.

    ``linear_range``: the response at x = 0 is off that in the ``smallest`` loaded state by more than :data:`LINEARITY`
    of it. ``third_peak``: a response with two peaks has another one between them. ``loss_of_symmetry_path``: the
    response and its mirror image differ by more than ``asymmetry`` of the largest response.

    Examples
    --------
    >>> path = gr.studies.LoadPath.of(result.scene)
    >>> sought = gr.studies.happenings(gr.studies.Measures(path), path.at(0.001), 0.1)
    >>> [name for name, what in sought.items() if what.happened(path.at(0.001))]
    []
    """
    linear, force = measures.centre(smallest), abs(smallest.load_factor)
    off = f"the response at x = 0 differs by more than {LINEARITY:.0%} from that at force {force:g}"
    third = "the double-peaked floor response has a further peak at x = 0"
    exceeds = f"along the load path, the asymmetry of the floor response exceeds {asymmetry:g}"
    return {
        "first_opening": first_opening(measures),
        "linear_range": Happening(lambda state: abs(measures.centre(state) / linear - 1.0) > LINEARITY, off),
        "crossover": two_peaks(measures),
        "reaches_floor": reaches_floor(measures),
        "third_peak": Happening(lambda state: measures.third_peak(state) > 0.0, third),
        "loss_of_symmetry_path": Happening(lambda state: measures.asymmetry(state) > asymmetry, exceeds, in_turn=True),
    }
