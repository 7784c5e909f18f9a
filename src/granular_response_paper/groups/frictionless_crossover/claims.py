"""Claims F4 to F10: the ordered slab without friction, and what friction changes in its open region (Sec. IV)."""

from __future__ import annotations

from itertools import combinations, pairwise, product

import numpy as np
import xarray as xr

from granular_response.state import FloatArray

from ...claims.bounds import about, at_least, at_most, between, hardly_lower, less_than, more_than, within
from ...claims.claim import SLAB, Ask, Claims, Data, Numbers, at
from ...claims.numbers import Quantity, needs

GROUP = "frictionless_crossover"
claim = Claims(GROUP, SLAB)

#: Distance of two rows of disks, and of two disks in a row (mean radii): the resolution of a region's size.
ROW, DISK = float(np.sqrt(3.0)), 2.0


@claim("F4a", "IV.A, Fig. 3", Ask("force at which two peaks appear", about(3.0), "mg", 3.0),
       primary="rows of 61 and 60", figures=[3, 4])  # fmt: skip
def crossover(data: Data) -> Numbers:
    """A crossover from a single peaked to a double peaked response occurs as the applied force is increased.
    Short: Without friction one peak turns into two as the force grows
    Here: Without friction two peaks appear at {0}, in rows of 60 disks at {rows of 60|0}.
    Remark: The number is that of the paper's Fig. 3"""

    def force(data: Data) -> Quantity:
        return data.event("crossover", 0.0)

    yield "rows of 61 and 60", data.protocol(force)
    yield "rows of 60", data.event("crossover", 0.0, "events_equal_rows")
    for case, found in data.elsewhere(force):
        if not case.prepared:  # without friction there is one equilibrium
            yield case, found


@claim("F4b", "IV.A, Figs. 3, 4",
       Ask("crossover force per force at which the region reaches the lowest row", within("slightly"), "%"),
       Ask("the same", less_than(1.0), "%"), primary="rows of 61 and 60")  # fmt: skip
def near_the_floor(data: Data) -> Numbers:
    """Otherwise, the anisotropy induced by the external force reaches the floor (Fig. 4(c), inducing a double peaked
    response (the crossover actually occurs at slightly smaller forces, at which the "teardrop" almost reaches the
    floor).
    Short: The crossover comes as the open region nears the floor
    Here: Without friction two peaks appear at {0} of the force at which the open region reaches the floor.
    Remark: The ends are those of the search; without friction the equilibrium does not depend on the protocol"""
    crossed, reached = (data.bracket(GROUP, "events", name=name) for name in ("crossover", "teardrop_reaches_floor"))
    ratio = crossed.per(reached)
    yield "rows of 61 and 60", ratio, ratio
    literal = (data.event(name, 0.0, "events_equal_rows") for name in ("crossover", "reaches_floor"))
    ratio = next(literal).per(next(literal))
    yield "rows of 60", ratio, ratio


@claim("F5", "IV.A, Fig. 4", Ask("horizontal part of the opened contacts, smallest", hardly_lower("visible"), "part"),
       Ask("widest row per the wider end", more_than(1.0)),
       Ask("smallest growth with the force, rows (known to half a row)", at_least(-0.5)),
       Ask("growth of the depth, rows", at_least(0.5)),
       Ask("size per that at the next smaller of the frictions 0, 0.2 and 1, largest", less_than(1.0), "%"),
       primary="width, 5 to 50 mg", figures=[4, 5, 8, 9], finds="any")  # fmt: skip
def teardrop(data: Data) -> Numbers:
    """As the force is increased, horizontal contacts are opened in a teardrop shaped region below the point of
    application of the force, whose size increases with the force and decreases with friction.
    Short: Horizontal contacts open in a teardrop that grows with force, shrinks with friction
    Here: Until the open region reaches the floor, {0} of its contacts are horizontal. It is widest between its ends,
    {1} times as wide as at the wider one, and grows by {3} rows. Of the frictions 0, 0.2 and 1 its width at one is at
    most {width at 5 mg|0} of that at the one before under 5 mg, {width at 15 mg|0} under 15 mg, {width at 30 mg|0}
    under 30 mg and {width at 50 mg|0} under 50 mg.
    Remark: The text compares no forces here, so that the range over them decides. At larger forces oblique contacts
    open too, close below the load; the text describes none. The size is that of the connected region below the load
    (Fig. 5)"""
    response, friction = (data.get(group, "response") for group in (GROUP, "friction_linear_range"))
    states = data.get(GROUP, "states").isel(force=response["reaches_floor"].values == 0)
    level = states["teardrop_horizontal"].values[states["teardrop"].values.any(axis=1)].min()
    last = states.isel(force=-1)
    height = last["position"].values[:, 1]
    middle = 0.5 * (height[last["contact_disk"].values] + height[last["contact_partner"].values])
    rows = np.round(middle[last["teardrop"].values.astype(bool)] / ROW).astype(int)
    widths = np.bincount(rows - rows.min())
    depth = response["teardrop_depth"].values / ROW
    needs(len(widths) > 3, "no region of four rows that has not reached the floor")
    shape = (level, widths.max() / max(widths[0], widths[-1]), np.diff(depth).min(), depth.max() - depth[0])
    found = {}
    for name, force in product(("width", "depth", "opened contacts"), (5.0, 15.0, 30.0, 50.0)):
        variable = "opened_contacts" if name == "opened contacts" else f"teardrop_{name}"
        sizes = (at(friction, friction=mu, force=force)[variable].values.item() for mu in (0.0, 0.2, 1.0))
        found[f"{name} at {force:g} mg"] = max(after / before for before, after in pairwise(sizes))
    yield "width, 5 to 50 mg", *shape, Quantity.over(one for case, one in found.items() if case.startswith("width"))
    for case, one in found.items():
        yield case, *(None,) * 4, one


def size_in_steps(size: FloatArray, step: float) -> Quantity:
    """The mean of a size over evenly spaced forces at which it grows by whole steps.

    A size is rounded down, by half a step in the mean over each whole step that it grows. So the mean lacks half a
    step, to within half a step over the number of steps grown.
    """
    steps = max(1.0, float(size.max() - size.min()) / step)
    mean, off = float(size.mean()) + 0.5 * step, 0.5 * step / steps
    return Quantity(mean, mean - off, mean + off, "bracket")


@claim("F6", "IV.B, Fig. 5", Ask("depth per that in 15 layers", hardly_lower("slightly")),
       Ask("width per that in 15 layers", hardly_lower("slightly")), primary="all depths", finds="any")  # fmt: skip
def teardrop_and_depth(data: Data) -> Numbers:
    """However, Fig. 5 clearly demonstrates that the size of the "teardrop" only slightly decreases as the depth of the
    slab increases.
    Short: The open region shrinks only slightly in deeper slabs
    Here: In slabs of 20, 30 and 40 layers the open region is {20 layers|0}, {30 layers|0} and {40 layers|0} times as
    deep as in 15 layers.
    Remark: Means over evenly spaced forces at which the region of 15 layers has not reached its floor. The text does
    not name its sizes; 20 layers is the least change. In deep slabs gravity presses horizontal contacts together, which
    open later; the symmetric equilibria of 30 and 40 layers may have others beside them"""
    study = data.get(GROUP, "regions").sortby("layers")
    slabs = study.isel(slab=np.isclose(study["normal_stiffness"].values, 3000.0))
    thin = slabs.isel(slab=0)
    slabs = slabs.isel(force=(thin["reaches_floor"].values == 0) & (thin["teardrop_depth"].values > 2.0 * ROW))
    found = {}
    for k, layers in enumerate(slabs["layers"].values[1:], 1):
        sizes = ((slabs[f"teardrop_{name}"].values, step) for name, step in (("depth", ROW), ("width", DISK)))
        ratios = [size_in_steps(one[k], step).per(size_in_steps(one[0], step)) for one, step in sizes]
        found[f"{layers:g} layers"] = ratios
    yield "all depths", *(Quantity.over(each) for each in zip(*found.values(), strict=True))
    for name, each in found.items():
        yield name, *each


@claim("F7", "IV.B, VIII", Ask("crossover force, deep per shallow", more_than(1.0)),
       primary="20 x 82 against 15 x 61 disks", figures=[5])  # fmt: skip
def deep_and_shallow(data: Data) -> Numbers:
    """For identical external loads, very deep systems should exhibit a single peaked response whereas relatively
    shallow ones, as studied in some experiments (Sec. II B), should exhibit two peaks.
    Short: Deep slabs have one peak under a load that gives shallow ones two
    Here: In a slab of 20 layers and 82 disks a row the crossover force is {0} times that in 15 layers and 61 disks.
    Remark: The ends are those of the search; without friction the equilibrium does not depend on the protocol. Sec.
    IV.C asks for contacts that are still closed in the horizontal direction; slabs that have lost some of them at rest
    are left out"""
    for name in ("sizes", "widths"):
        study = data.get(GROUP, name).sortby("layers")
        closed = study["open_at_rest"].values == 0
        slabs = study.isel(slab=closed & np.isclose(study["normal_stiffness"].values, 3000.0))
        columns = (slabs[key].values.tolist() for key in ("layers", "disks_per_row", "crossover_bracket"))
        for (thin, few, shallow), (layers, row, deep) in combinations(zip(*columns, strict=True), 2):
            # of the first, the width grows with the depth; of the second, walls are at the same distance
            if thin == slabs["layers"].min() < layers and (name == "sizes" or abs(few - row) <= 1):
                ratio = Quantity.bracket(*deep).per(Quantity.bracket(*shallow))
                yield f"{layers:g} x {row:g} against {thin:g} x {few:g} disks", ratio


def _between(data: Data) -> xr.Dataset:
    """The study of stiffness for k_N from 1000 to 1e5. Raises NotMeasured if it does not span them."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness").sel(normal_stiffness=slice(999.0, 1.001e5))
    stiffness = study["normal_stiffness"].values
    needs(stiffness.size and stiffness[0] < 1001.0 and stiffness[-1] > 0.99e5, "stiffness does not span 1000 to 1e5")
    return study


@claim("F8", "IV.C", Ask("change of the response at x = 0", between(0.0, 0.025), "%", 0.02), primary="all forces",
       finds="any", figures=[5])  # fmt: skip
def stiffness_response(data: Data) -> Numbers:
    """The response is also quite insensitive to the choice of stiffness for k_N ≳ 1000mg/R: at x = 0, it only changes
    by about 2% in the range 1000mg/R < k_N < 10⁵mg/R.
    Short: The response at x = 0 depends on k_N by only about 2 %
    Here: For k_N from 1000 to 1e5 mg/R the response at x = 0 changes by {1 mg|0} under 1 mg, by {3 mg|0} under 3 mg,
    the crossover, and by {15 mg|0} under 15 mg.
    Remark: The text does not name the force, so that the range over forces decides. Its middle is the number under 15
    mg, the force at which the paper compares other parameters (Figs. 10, 12 to 14). About 2 % is at most a quarter more
    than 2 %"""
    study = _between(data)
    by_force = study["response_at_centre"].transpose("force", ...).values
    forces = study["force"].values.tolist()
    found = {force: np.ptp(one) / abs(one[-1]) for force, one in zip(forces, by_force, strict=True)}
    yield "all forces", Quantity.over([found[15.0], *found.values()])
    for force, change in found.items():
        yield f"{force:g} mg", change


@claim("F9", "IV.C", Ask("change of the depth from 2000 on", at_most("nearly"), "%"),
       Ask("change of the width from 2000 on", at_most("nearly"), "%"), Ask("growth of the depth, rows", at_least(0.5)),
       figures=[5])  # fmt: skip
def stiffness_teardrop(data: Data) -> Numbers:
    """We performed simulations with different values of k_N, and found that the size of the "teardrop" did increase
    with the stiffness of the particles, but appeared to saturate for k_N ≳ 2000mg/R.
    Short: The open region grows with k_N and saturates from 2000 mg/R on
    Here: From 2000 mg/R on the depth of the open region changes by {0} and its width by {1}; from the softest disks on
    the depth grows by {2} rows."""
    study = data.get(GROUP, "stiffness").sortby("normal_stiffness")
    high = study["normal_stiffness"].values >= 2000.0
    needs(high.sum() > 1 and not high.all(), "stiffness holds too few stiffnesses to compare")
    depth, width = study["teardrop_depth"].values, study["teardrop_width"].values
    use = (depth[-1] > 2.0 * ROW) & ~study["reaches_floor"].values.astype(bool).any(axis=0)
    spread = [(np.ptp(size[high], axis=0) / size[-1]).max() for size in (depth[:, use], width[:, use])]
    yield *spread, (depth[-1] - depth[0])[use].max() / ROW


@claim("F10", "IV.C", Ask("crossover force per that at the largest k_N, from 1000 on", within("nearly")),
       primary="two peaks, each above the response at x = 0", figures=[5])  # fmt: skip
def crossover_and_stiffness(data: Data) -> Numbers:
    """We conclude that the crossover from a single peaked to a double peaked response is essentially independent of the
    particle rigidity (provided that the particles are sufficiently stiff; otherwise the particle "overlaps" may be
    appreciable and the localized force would lead to significant rearrangements of the particles).
    Short: The crossover is independent of the stiffness
    Here: The crossover force at k_N = 1000 mg/R is {0} times that at 1e5.
    Remark: This lies at the bound of 1.1, so that what counts as two peaks decides"""
    study = _between(data)
    definitions = {"two peaks, each above the response at x = 0": study["crossover_bracket"].values}
    definitions |= {f"a dip above {dip:.1%}": study["crossovers"].sel(dip=dip).values for dip in study["dip"].values}
    for case, brackets in definitions.items():
        yield case, Quantity.over(Quantity.bracket(*one).per(Quantity.bracket(*brackets[-1])) for one in brackets[:-1])
