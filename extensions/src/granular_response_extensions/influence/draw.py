"""What every disk sets in motion on the floor, and how a force and its halves differ with distance."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.collections import PatchCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from granular_response.plot import style
from granular_response_extensions.panels import materials
from granular_response_paper.captions import Caption, Datasets, lettered, of_group, of_scene, values
from granular_response_paper.panels import label_ends, note, titles, zero

from .parameters import Parameters

#: Half the width of the maps (radii).
REACH = 30.0
#: End of the colour scale: a little below the least there is, 1 where walls bear nothing.
LEAST = 0.8
#: A map is drawn where one disk in twenty exceeds the median by this factor; others have one colour.
VARIED = 1.2


def draw(datasets: Datasets) -> dict[str, Figure]:
    return {"influence_map": _maps(datasets["packings"]), "influence_saint_venant": _decay(datasets["saint_venant"])}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    packings, decay = datasets["packings"], datasets["saint_venant"]
    maps = _mapped(packings)
    like = packings.isel(case=packings["polydispersity"].values == packings["polydispersity"].values[-1])
    medians = [
        f"{float(np.nanmedian(one)):.2g} at µ = {float(mu):g}"
        for one, mu in zip(like["total"].values, like["friction"].values, strict=True)
    ]
    powers = []
    for case in range(decay.sizes["case"]):
        exponent = decay.isel(case=case, separation=0)["exponent"].values[:, 0]
        if np.isfinite(exponent).any():
            delta, mu = (float(decay[name][case]) for name in ("polydispersity", "friction"))
            powers.append(f"{np.nanmean(exponent):.2g} (δ = {delta:g}, µ = {mu:g})")
    said = of_scene(parameters.base, friction=None, wall_friction=None, polydispersity=None)
    return of_group(
        "influence",
        {"influence_map": said, "influence_saint_venant": said},
        {
            "influence_map": f"A small force changes the floor forces by a median of {values(medians)} times itself.",
            "influence_saint_venant": f"Exponents of the decay: {', '.join(powers)}.",
        },
        p=parameters,
        panels=lettered(
            f"δ = {float(delta):g}, µ = {float(mu):g}"
            for delta, mu in zip(maps["polydispersity"].values, maps["friction"].values, strict=True)
        ),
        most=max(case.realizations for case in parameters.cases),
    )


def _maps(data: xr.Dataset) -> Figure:
    """A panel for each case that differs from disk to disk; disks that bear nothing stay white."""
    data = _mapped(data)
    figure, (panels,) = style.figure(1, data.sizes["case"], height=1.2 + 2.4 / data.sizes["case"], sharey=True)
    # the weight of a unit force is 1 where no floor disk is relieved; what exceeds that is pushed up and down
    largest = float(np.nanquantile(data["total"].values, 0.995))
    medians = np.nanmedian(data["total"].values, axis=1)
    cases = materials(data["polydispersity"], data["friction"])
    titles(panels, [f"{name}, median {middle:.1f}" for (name, _), middle in zip(cases, medians, strict=True)])
    for case, axes in enumerate(panels):
        one = data.isel(case=case)
        x, z = one["position"].values.T
        shown = np.flatnonzero(np.abs(x) <= REACH)
        disks = [Circle((x[k], z[k]), one["radius"].values[k]) for k in shown]
        drawn = PatchCollection(disks, cmap=style.SEQUENTIAL, edgecolor="none")
        drawn.set_array(np.ma.masked_invalid(one["total"].values[shown]))
        drawn.set_norm(LogNorm(LEAST, max(largest, 2.0 * LEAST)))
        axes.add_collection(drawn)
        axes.axhline(0.0, color=style.BLACK, linewidth=1.0)
        axes.set(xlim=(-REACH, REACH), ylim=(-1.0, z.max() + 1.5), aspect="equal", xlabel=style.POSITION)
    panels[0].set_ylabel(style.HEIGHT)
    ticks = [t for t in (1.0, 2.0, 5.0, 10.0, 20.0, 50.0) if t <= largest]
    label = "absolute forces on the floor\nper unit force on the disk"
    bar = figure.colorbar(drawn, ax=panels, label=label, shrink=0.8)
    bar.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
    bar.minorticks_off()
    return figure


def _mapped(data: xr.Dataset) -> xr.Dataset:
    """The cases with the polydispersity of the last one whose weights differ from disk to disk."""
    data = data.isel(case=data["polydispersity"].values == data["polydispersity"].values[-1])
    varied = np.nanquantile(data["total"].values, 0.95, axis=1) > VARIED * np.nanmedian(data["total"].values, axis=1)
    return data.isel(case=varied) if varied.any() else data


def _decay(data: xr.Dataset) -> Figure:
    """(a) the difference against height over separation, (b) its power for each case."""
    figure, ((falls, powers),) = style.figure(1, 2, height=3.2)
    cases = materials(data["polydispersity"], data["friction"])
    ends_of: list[tuple[str, float, float, str]] = []
    for case, (name, look) in enumerate(cases):
        one = data.isel(case=case, separation=0)
        ratio = (one["height"] / (one["spacing"] * float(one["separation"]))).mean("realization").values
        each = one["difference"].values
        each = each[np.isfinite(each).any(axis=1)]
        if len(each):  # else no row is as far from the walls as the margin asks
            mean = each.mean(axis=0)
            falls.plot(ratio, mean, **look)
            known = np.flatnonzero(np.isfinite(mean) & (mean > 0.0))
            if known.size:
                ends_of.append((name, float(ratio[known[-1]]), float(mean[known[-1]]), look["color"]))
        if len(each) > 1:
            spread = each.std(axis=0, ddof=1)
            falls.fill_between(ratio, mean - spread, mean + spread, color=look["color"], alpha=0.15, linewidth=0.0)
        each = one["exponent"].values
        each = each[np.isfinite(each[:, 0])]
        if len(each):
            mean = each[:, 0].mean()
            error = np.array([[mean - each.min()], [each.max() - mean]])  # of a lattice: the range over the fits
            if len(each) > 1:
                error = np.full((2, 1), 1.96 * each[:, 0].std(ddof=1) / np.sqrt(len(each)))
            powers.errorbar([case], [mean], error, capsize=3, **look | {"linestyle": "none", "markersize": 5})
    ends = np.array(data.attrs["fitted"], float)
    falls.plot(ends, 0.5 * (ends / ends[0]) ** -2.0, color=style.BLACK, linewidth=0.9, linestyle=(0, (4, 2)))
    note(falls, "elastic: power 2", (ends[0], 0.5), (2, 3))
    style.logarithmic(falls)
    falls.set(xlabel="height / distance of the halves", ylabel="difference on the floor")
    if ends_of:
        falls.set_xlim(right=4.0 * max(x for _, x, *_ in ends_of))
    label_ends(falls, ends_of)
    powers.axhline(2.0, color=style.BLACK, linewidth=0.9, linestyle=(0, (4, 2)))
    zero(powers)
    powers.set_xticks(range(len(cases)), [name for name, _ in cases], rotation=30, ha="right")
    powers.set(ylabel="exponent of the decay")
    titles((falls, powers), ("a force and its two halves", "decay with height"))
    return figure
