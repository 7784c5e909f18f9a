"""Statistics of contact networks: forces, and coordination against the isostatic value."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from granular_response.plot import style
from granular_response_extensions.panels import GUIDE
from granular_response_paper.captions import Caption, Datasets, of_group, of_scene
from granular_response_paper.panels import DASHED, DOTTED, among, family, label_ends, note, packing, titles

from .parameters import Parameters

#: Friction of the distributions of forces, and the rate of the exponential that they are compared with.
FRICTION, EXPONENTIAL = 0.2, 1.0


def draw(datasets: Datasets) -> dict[str, Figure]:
    data = datasets["statistics"]
    rest = data.sel(state="rest")
    mu = among(data["friction"], [FRICTION])[0]
    figure, ((forces, contacts),) = style.figure(1, 2, height=3.0)
    ends = []
    for value, look in family(data["polydispersity"].values, of="polydispersity"):
        by = rest.sel(polydispersity=value)
        density = by["force_density"].sel(friction=mu).mean("realization")
        forces.plot(by["force"], density.where(density > 0.0), label=packing(value), **look | {"markersize": 2.5})
        number = by["coordination_number"]
        mean = number.mean("realization")
        bars = np.abs(np.stack([number.min("realization") - mean, number.max("realization") - mean]))
        contacts.errorbar(number["friction"], mean, bars, capsize=2, **look | {"markersize": 3.5})
        ends.append((packing(value), float(number["friction"][-1]), float(mean[-1]), look["color"]))
    x = np.linspace(0.0, 5.5, 56)
    for name, curve, at in (
        ("exponential", EXPONENTIAL * np.exp(-EXPONENTIAL * x), 4.2),
        ("Gaussian", 2.0 / np.pi * np.exp(-(x**2) / np.pi), 2.9),  # both of mean 1
    ):
        forces.plot(x, curve, linestyle=DASHED if name == "Gaussian" else DOTTED, **GUIDE)
        note(forces, name, (at, float(np.interp(at, x, curve))), (4.0, 2.0), fontsize=8)
    forces.set(yscale="log", ylim=(2e-4, 2.0), xlim=(0.0, 5.5))
    forces.set(xlabel="normal force / mean", ylabel="probability density")
    forces.legend(loc="lower left")
    for value, text in ((3.0, "isostatic with friction"), (4.0, "isostatic without friction")):
        contacts.axhline(value, linestyle=DOTTED, **GUIDE)
        note(contacts, text, (1.0, value), (0.0, 2.0), fontsize=8, ha="right", xycoords=contacts.get_yaxis_transform())
    contacts.set(xlabel=f"friction ${style.FRICTION}$", ylabel="coordination number $z$, no rattlers", ylim=(2.9, 4.5))
    contacts.set_xlim(right=1.25 * float(data["friction"].max()))
    label_ends(contacts, ends)
    titles((forces, contacts), (f"normal forces, {style.equals(style.FRICTION, mu)}", ""))
    return {"network_statistics": figure}


def captions(datasets: Datasets, parameters: Parameters) -> dict[str, Caption]:
    said = of_scene(
        parameters.base, friction=None, wall_friction=None, polydispersity=None,
        realizations=parameters.realizations,
    )  # fmt: skip
    rest = datasets["statistics"].sel(state="rest")
    one = rest.sel(polydispersity=rest["polydispersity"].max(), friction=among(rest["friction"], [FRICTION])[0])
    density = one["force_density"].mean("realization")
    large = (one["force"].values > 1.0) & (density.values > 0.0)
    slope = np.polyfit(one["force"].values[large], np.log(density.values[large]), 1)[0] if large.sum() > 1 else np.nan
    z = rest["coordination_number"].mean("realization")
    least, most = float(z.isel(friction=-1).min()), float(z.isel(friction=-1).max())
    finding = (
        f"Above the mean the density of normal forces falls on average like exp({slope:.2g} f); the coordination "
        f"number is {least:.2f} to {most:.2f} at the largest friction."
    )
    return of_group("network", {"network_statistics": said}, {"network_statistics": finding})
