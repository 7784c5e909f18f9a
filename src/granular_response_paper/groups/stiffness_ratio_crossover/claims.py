"""Claims K1, K6 and K7: large friction and the ratio of stiffnesses (Secs. V.B and V.C)."""

from __future__ import annotations

import numpy as np

from ...claims.bounds import about, at_most, between, within
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import Quantity, needs

GROUP = "stiffness_ratio_crossover"
claim = Claims(GROUP, {**SLAB, "force": 15.0, "scene.contact.friction": 10.0})


@claim("K1a", "V.B, Fig. 10", Ask("ratio at which two peaks turn into one", about(0.3), paper=0.3))
def ratio(data: Data) -> Numbers:
    """A crossover from a single peaked to a double peaked response occurs with decreasing k_T/k_N (the crossover occurs
    at k_T/k_N ≃ 0.3).
    Short: k_T/k_N of about 0.3 separates two peaks from one
    Here: At friction 10 two peaks first vanish at k_T/k_N = {0}.
    Remark: Above this ratio a dip of some tenths of a per cent may return, until the response is largest at x = 0. The
    ends are those of the search; other protocols were not tried"""
    yield data.bracket(GROUP, "events", name="two_peaks_end")


@claim("K1b", "V.B, Fig. 10", Ask("largest change of the response per largest response", at_most("nearly"), "%"),
       primary="from 0.4 or 0.5 on", finds="any")  # fmt: skip
def independent(data: Data) -> Numbers:
    """For larger values of k_T/k_N, the response is nearly independent of k_T/k_N.
    Short: Above it the response is nearly independent of the ratio
    Here: Responses at k_T/k_N from 0.5 to 1 differ from that at 0.8 by up to {from 0.5 on|0} of the peak, from 0.4 to 1
    by up to {from 0.4 on|0}.
    Remark: Just above 0.3 the response still changes, and the text does not say from where on it does not, so that the
    range decides. Away from the side walls"""
    study = data.get(GROUP, "response")
    inside = study["interior"].values > 0
    ratios, response = study["stiffness_ratio"].values, study["floor_response"].transpose("stiffness_ratio", ...).values
    usual = at(study, stiffness_ratio=0.8)["floor_response"].values
    found = {}
    for least in (0.5, 0.4):
        there = ratios > least - 1e-9
        needs(there.sum() > 1, f"response holds too few ratios above {least:g}")
        found[f"from {least:g} on"] = float(np.abs(response[there] - usual)[:, inside].max() / usual.max())
    yield "from 0.4 or 0.5 on", Quantity.over(found.values())
    yield from found.items()


@claim("K6", "V.C", Ask("root of r(β) without horizontal springs", between(0.29145, 0.29155), paper=0.2915),
       Ask("root per ratio of the slab", within("quite well"), paper=0.2915 / 0.3), primary="rotations suppressed",
       figures=[10, 11])  # fmt: skip
def criterion(data: Data) -> Numbers:
    """Nevertheless, the estimate obtained using this criterion fits our result for the finite slab quite well: for the
    model used here (with no horizontal springs), r = (β² + 10β − 3)/(β² + 6β + 9), where β ≡ k_2^t/k_2^n. Hence (in the
    physically relevant range β > 0), two peaks are expected for β ≲ 0.2915, which is consistent with the value k_T/k_N
    ≃ 0.3 obtained in the simulation (Fig. 10).
    Short: The half plane's criterion, 0.2915, gives the slab's ratio quite well
    Here: The criterion has its root at {0:4}, which is {1} times the ratio k_T/k_N at which two peaks of the slab turn
    into one; with disks free to turn, {disks free to turn|0} times.
    Remark: Eq. (5) keeps the disks from turning; the paper's disks turn. The ratio of the slab has the ends of the
    search (K1a)"""
    slab = data.bracket(GROUP, "events", name="two_peaks_end")
    for case, rotations in (("rotations suppressed", "suppressed"), ("disks free to turn", "free")):
        root = Quantity.exact(data.value(GROUP, "elastic.root", rotations=rotations))
        yield case, root if rotations == "suppressed" else None, root.per(slab)


@claim("K7", "V.B",
       Ask("difference of the responses at friction 2 and 10 per largest response", at_most("nearly"), "%"),
       Ask("contacts at the Coulomb limit at friction 10", at_most(0.0), "count"), figures=[10, 12])  # fmt: skip
def immaterial(data: Data) -> Numbers:
    """When µ is sufficiently large (and F_ext sufficiently small), its value is essentially immaterial, since sliding
    is never reached.
    Short: Sufficiently large friction is immaterial, since nothing slides
    Here: From friction 2 to 10 the response under 15 mg changes by {0} of its peak. At friction 10 and every ratio of
    stiffnesses above 0, {1} contact is at the Coulomb limit.
    Remark: Friction 10 starts from rest and has rough walls (Fig. 10), friction 2 follows the load path beside smooth
    walls (Fig. 12)"""
    ten, axis = (
        data.get(group, name) for group, name in ((GROUP, "response"), ("friction_linear_range", "friction_axis"))
    )
    values = at(ten, stiffness_ratio=0.8)["floor_response"].values
    two = at(axis, friction=2.0, force=15.0)["floor_response"].values
    slide = ten["sliding_contacts"].values[ten["stiffness_ratio"].values > 0.001].max()
    yield float(np.abs(values - two)[ten["interior"].values > 0].max() / values.max()), slide
