"""Claims R1 to R8: ordered slabs with friction under growing forces (Secs. V.A, V.B and V.E)."""

from __future__ import annotations

import numpy as np

from .claim import Claim, Condition, Data, Finding, NotMeasured, about_event, at, sampled_event

GROUP = "friction_linear_range"
BREAKING = "symmetry_breaking"


def linear_range(data: Data) -> Finding:
    without = data.event(GROUP, "linear_range", 0.0)
    ratios = {mu: data.event(GROUP, "linear_range", mu).middle / without.middle for mu in (0.2, 1.0)}
    conditions = [
        Condition(f"at friction {mu:g}, 5 to 15 times larger", 5.0 <= r <= 15.0, f"friction {mu:g}: {r:.1f} times")
        for mu, r in ratios.items()
    ]
    return Finding(
        f"{ratios[0.2]:.1f} times at friction 0.2 and {ratios[1.0]:.1f} times at 1 "
        f"(without friction the range ends at {without.text(' mg')})",
        ratios[1.0],
        conditions,
        (min(ratios.values()), max(ratios.values())),
    )


def single_peak(data: Data) -> Finding:
    names = ("double_peaked", "half_maximum_width", "peak_height", "force", "friction")
    curve = at(data.get(GROUP, "response", *names), friction=1.0)
    force = curve["force"].values
    use = (force <= 50.0) & np.isfinite(curve["peak_height"].values)
    if not use.any() or force[use].max() < 50.0:
        raise NotMeasured(f"data/{GROUP}.nc: response does not reach 50 mg at friction 1")
    double = curve["double_peaked"].values[use]
    width, height = curve["half_maximum_width"].values[use], curve["peak_height"].values[use]
    return Finding(
        f"one peak at all {use.sum()} forces up to 50 mg; its full width falls from {width[0]:.1f} to "
        f"{width[-1]:.1f} R, its height grows from {height[0]:.4f} to {height[-1]:.4f}",
        width[-1] / width[0],
        [
            Condition("no stored force up to 50 mg has two peaks", not double.any(), f"{double.sum():.0f} have", True),
            Condition(
                "full width at half maximum at 50 mg at most 0.95 of that at the smallest force",
                bool(width[-1] <= 0.95 * width[0]),
                f"{width[-1] / width[0]:.2f}",
            ),
        ],
    )


def crossover_and_floor(data: Data) -> Finding:
    crossover, floor = data.event(GROUP, "crossover", 0.2), data.event(GROUP, "reaches_floor", 0.2)
    return Finding(
        f"crossover at {crossover.text(' mg')}; open region at the floor from {floor.text(' mg')}",
        crossover.middle,
        [
            *about_event("crossover", crossover, 20.0),
            *about_event("open region at the floor", floor, 20.0),
        ],
        (crossover.low, crossover.high),
    )


def third_peak(data: Data) -> Finding:
    bracket = data.event(GROUP, "third_peak", 0.2)
    curve = at(data.get(GROUP, "response", "third_peak_prominence", "force", "friction"), friction=0.2)
    sizes = np.nan_to_num(curve["third_peak_prominence"].values)
    size, where = float(sizes.max()), float(curve["force"].values[sizes.argmax()])
    return Finding(
        f"from {bracket.text(' mg')}; prominence up to {size:.3f} of the largest response, at {where:g} mg",
        bracket.middle,
        [
            *sampled_event("third peak", bracket, 40.0),
            Condition(
                "small: prominence at most a quarter of the largest response at every stored force",
                size <= 0.25,
                f"prominence {size:.2f} at {where:g} mg",
            ),
        ],
        (bracket.low, bracket.high),
    )


def _jump(data: Data):
    """The dynamic runs at large forces, in order, and the index of the first asymmetric one."""
    names = ("asymmetry", "force", "mobilised_contacts", "network_asymmetry", "floor_response", "asymmetry_sign")
    runs = data.get(GROUP, "large_forces", *names).sortby("force")
    lost = np.flatnonzero(runs["asymmetry"].values > 0.1)
    return runs, int(lost[0]) if lost.size else -1


def loss_of_symmetry(data: Data) -> Finding:
    bracket = data.event(GROUP, "loss_of_symmetry", 1.0)
    protocols = "not varied"
    if BREAKING in data.groups:
        brackets = data.get(BREAKING, "brackets", "low", "high", "ramp_time", "time_step")
        high = brackets["high"].values
        protocols = f"{np.nanmin(high):.4g} to {np.nanmax(high):.4g} mg" if np.isfinite(high).any() else "none"
    runs, first = _jump(data)
    asymmetry = runs["asymmetry"].values
    sharp = first > 0 and asymmetry[first - 1] < 0.01 and asymmetry[first] > 0.1
    found = f"{asymmetry[first - 1]:.1e} to {asymmetry[first]:.2f}" if first > 0 else "no jump"
    return Finding(
        f"at {bracket.text(' mg')}, asymmetry from {found}; with other ramps and time steps: {protocols}",
        bracket.middle,
        [
            *about_event("loss of symmetry", bracket, 91.0, 0.05),
            Condition("asymmetry from below 0.01 to above 0.1 between two neighbouring forces", sharp, found),
        ],
        (bracket.low, bracket.high),
    )


def sliding_drops(data: Data) -> Finding:
    runs, first = _jump(data)
    if first <= 0:
        raise NotMeasured(f"data/{GROUP}.nc: large_forces holds no forces on both sides of the loss of symmetry")
    sliding = runs["mobilised_contacts"].isel(margin=0).values
    network = runs["network_asymmetry"].values
    before, after = sliding[first - 1], sliding[first]
    return Finding(
        f"contacts within 1 % of the Coulomb limit: {before:.0f} before, {after:.0f} after; contacts without a mirror "
        f"image: {network[first - 1]:.1%} before, {network[first]:.1%} after",
        float(after / before) if before else float("nan"),
        [
            Condition(
                "sliding contacts fall by at least a fifth", bool(after <= 0.8 * before), f"{before:.0f} to {after:.0f}"
            ),
            Condition(
                "contact network symmetric before (0.5 %), at least 1 % without mirror image after",
                bool(network[first - 1] <= 0.005 and network[first] >= 0.01),
                f"{network[first - 1]:.1%} to {network[first]:.1%}",
            ),
        ],
        (float(before), float(after)),
    )


def mirror_images(data: Data) -> Finding:
    runs, first = _jump(data)
    if first < 0:
        raise NotMeasured(f"data/{GROUP}.nc: large_forces holds no asymmetric response")
    after = runs.isel(force=slice(first, None))
    response, force = after["floor_response"].values, after["force"].values
    sign, x = after["asymmetry_sign"].values, after["x"].values
    if np.abs(x + x[::-1]).max() > 0.1:
        raise NotMeasured(f"data/{GROUP}.nc: the floor disks are not symmetric about x = 0")
    pairs = [
        (float(np.abs(response[a] - response[b][::-1]).max() / response[a].max()), force[a], force[b])
        for a in range(len(force))
        for b in range(a + 1, len(force))
        if sign[a] * sign[b] < 0 and force[b] - force[a] <= 0.05 * force[a]
    ]
    copies = ""
    if BREAKING in data.groups:
        study = data.get(BREAKING, "copies", "asymmetry_sign", "force")
        signs = study["asymmetry_sign"].values
        copies = (
            f"; copies of the packing that differ by rounding at {float(study['force']):g} mg: "
            f"{(signs > 0).sum()} to the right, {(signs < 0).sum()} to the left"
        )
    best = min(pairs, default=(float("nan"), float("nan"), float("nan")))
    seen = f"{best[1]:g} and {best[2]:g} mg, difference {best[0]:.1%}" if pairs else "no pair of opposite sign"
    return Finding(
        f"{seen}{copies}",
        best[0],
        [
            Condition("two forces within 5 % lean to opposite sides", bool(pairs), seen, essential=True),
            Condition(
                "one is the mirror image of the other within 10 % of the largest response",
                bool(pairs) and best[0] <= 0.1,
                seen,
            ),
        ],
    )


def floor_with_one_peak(data: Data) -> Finding:
    low, high = data.event(GROUP, "reaches_floor", 1.0), data.event(GROUP, "reaches_floor", 0.2)
    curve = at(data.get(GROUP, "response", "double_peaked", "force", "friction"), friction=1.0)
    force, double = curve["force"].values, curve["double_peaked"].values
    beyond = (force >= low.high) & np.isfinite(double)
    if low.happens and not beyond.any():
        raise NotMeasured(f"data/{GROUP}.nc: response ends before the open region reaches the floor")
    return Finding(
        f"at the floor from {low.text(' mg')} (friction 1) and {high.text(' mg')} (friction 0.2)",
        low.middle,
        [
            Condition(
                "smaller force at friction 1",
                low.happens and (not high.happens or low.high < high.low),
                f"{low.text(' mg')} against {high.text(' mg')}",
                essential=True,
            ),
            Condition(
                "one peak at every stored force beyond it",
                not (double[beyond] > 0).any(),
                f"two peaks at {np.count_nonzero(double[beyond] > 0)} of {beyond.sum()} forces",
            ),
        ],
        (low.low, low.high),
    )


CLAIMS = (
    Claim(
        "R1",
        "V.A, Fig. 6",
        "force at which the response at x = 0 is 1 % off that to the smallest force, with friction over without",
        "almost ten times larger",
        linear_range,
        (6,),
        GROUP,
    ),
    Claim(
        "R2",
        "V.A, Fig. 7",
        "friction 1: number of peaks up to 50 mg, full width at half maximum",
        "a single peak up to 50 mg, and sharper",
        single_peak,
        (7,),
        GROUP,
    ),
    Claim(
        "R3",
        "V.E, Fig. 8",
        "friction 0.2: force at which the open region reaches the lowest row, and force of the crossover to two peaks",
        "about 20 mg, both",
        crossover_and_floor,
        (7, 8),
        GROUP,
    ),
    Claim(
        "R4",
        "V.E, Fig. 16a",
        "friction 0.2: force from which the response with two peaks has a third one at x = 0, by bisection",
        "small, from about 40 mg",
        third_peak,
        (16,),
        GROUP,
    ),
    Claim(
        "R5",
        "V.E, Fig. 16b",
        "friction 1: force at which the response to a ramp from rest loses its symmetry, the paper's protocol",
        "sharp change above 91 mg",
        loss_of_symmetry,
        (16,),
        GROUP,
    ),
    Claim(
        "R6",
        "V.E",
        "contacts at the Coulomb limit and mirror symmetry of the contact network on both sides of that change",
        "sliding contacts drop, contact network becomes asymmetric",
        sliding_drops,
        (16,),
        GROUP,
    ),
    Claim(
        "R7",
        "V.E",
        "beyond that change: responses at nearly equal forces that lean to opposite sides, one mirrored",
        "nearly equal forces can give mirror images (95 mg)",
        mirror_images,
        (16,),
        GROUP,
    ),
    Claim(
        "R8",
        "V.B, Fig. 9",
        "force at which the open region reaches the lowest row at friction 1 and 0.2, and peaks beyond it",
        "at a smaller force for friction 1, where one peak remains",
        floor_with_one_peak,
        (8, 9),
        GROUP,
    ),
)
