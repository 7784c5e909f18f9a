"""
Crossover from one peak to two
==============================

``gr.find_event`` finds an event along the load by bisection. Here it is the force at which the response is no longer
largest below the load, without friction (Sec. IV of the paper).
"""

import granular_response as gr

LAYERS, DISKS, LOW, HIGH = 9, 31, 0.5, 8.0

scene = gr.Scene().updated(
    {
        "packing.layers": LAYERS,
        "packing.disks_per_row": DISKS,
        "contact.friction": 0.0,
        "loads.0.force": [0.0, -1.0],
    }
)


def two_peaks(result: gr.Result) -> bool:
    """Whether the response is largest beside the loaded disk."""
    last = result.floor_response.isel(load=-1)
    return abs(float(last["x"][int(last.values.argmax())])) > 1.0


bracket = gr.find_event(scene, two_peaks, LOW, HIGH, tolerance=0.01)
print(f"one peak at {bracket.low:.3f} mg, two at {bracket.high:.3f}")

# %%
# The response on both sides of the crossover.

result = gr.solve(scene, load_factors=[bracket.low, bracket.high, 2.0 * bracket.high])
gr.plot.response(result)
