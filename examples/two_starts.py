"""A sweep of your own: the effect of the initial lattice on a disordered packing, over many realizations of the radii.

    python examples/two_starts.py --polydispersity 0.01 --realizations 20

Slabs without friction settle from a lattice of two mean radii, on which large disks overlap, or from one on which the
largest just touch. Then a force of 15 mg acts. Tasks run on all cores of this machine. With --checkpoint an
interrupted sweep continues.
"""

import argparse

import numpy as np

import granular_response as gr

STARTS = (2.0, "touching-largest")
FORCE = 15.0
X = np.linspace(-40.0, 40.0, 161)  # from the loaded disk, in mean radii


def measure(task: tuple[gr.Scene, float | str, int]) -> dict[str, np.ndarray | float]:
    """One task: a realization, before and under the force. All random numbers come from its number."""
    base, start, realization = task
    result = gr.solve(
        base.updated({"packing.lattice_constant": start, "packing.realization": realization}), progress=False
    )
    contacts = result.contacts_table(state=0)
    pairs = contacts[contacts["wall"] == ""][["first", "second"]].to_numpy(int)
    x, z = (result.rest.position[pairs[:, 1]] - result.rest.position[pairs[:, 0]]).T
    horizontal = np.abs(z) < np.tan(np.pi / 6.0) * np.abs(x)  # within 30 degrees
    # rows of the lattice have n and n - 1 disks in turn
    layers, row = base.packing.layers, base.packing.disks_per_row
    in_rows = sum(row - 1 - k % 2 for k in range(layers))
    between_rows = 2 * (row - 1) * (layers - 1)
    counted = gr.coordination_number(result).isel(state=0)
    return {
        "coordination number": float(counted["coordination_number"]),
        "coordination number without rattlers": float(counted["without_rattlers"]),
        "horizontal contacts over those of the lattice": horizontal.sum() / in_rows,
        "oblique contacts over those of the lattice": (~horizontal).sum() / between_rows,
        "response": result.response_at(X, smooth=3.0).isel(load=-1).values,
    }


def scene(polydispersity: float, **packing: int) -> gr.Scene:
    """The paper's slab without friction, with settings for a fast fall and a static finish."""
    return gr.Scene().updated(
        {
            "packing.polydispersity": polydispersity,
            **{f"packing.{key}": value for key, value in packing.items()},
            "contact.friction": 0.0,
            "loads": [{"disk": "top-centre", "force": [0.0, -FORCE]}],
            "protocol.integrator": "verlet",
            "protocol.time_step": "auto",
        }
    )


def compare(base: gr.Scene, realizations: int, **sweep) -> dict[float | str, dict[str, tuple[np.ndarray, np.ndarray]]]:
    """Mean over realizations and its standard error of everything measured, for each initial lattice."""
    tasks = [(base, start, realization) for start in STARTS for realization in range(realizations)]
    found = gr.map_tasks(measure, tasks, **sweep)
    table = {}
    for k, start in enumerate(STARTS):
        group = found[k * realizations : (k + 1) * realizations]
        values = {name: np.array([one[name] for one in group]) for name in group[0]}
        table[start] = {
            name: (v.mean(axis=0), v.std(axis=0, ddof=1) / np.sqrt(realizations)) for name, v in values.items()
        }
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--polydispersity", type=float, default=0.01)
    parser.add_argument("--realizations", type=int, default=20)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--checkpoint")
    options = parser.parse_args()
    table = compare(
        scene(options.polydispersity),
        options.realizations,
        workers=options.workers,
        checkpoint=options.checkpoint,
    )
    for start, row in table.items():
        print(f"initial lattice: {start}")
        response, error = row.pop("response")
        for name, (mean, standard_error) in row.items():
            print(f"  {name}: {mean:.3f} +- {standard_error:.3f}")
        for x in (X[response.argmax()], 0.0):
            at = int(np.abs(X - x).argmin())
            print(f"  response at x = {x:g}: {response[at]:.4f} +- {error[at]:.4f}")


if __name__ == "__main__":
    main()
