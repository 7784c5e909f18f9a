"""Every kernel in every form that the package asks for: `python benchmarks/all_kernels.py` compiles and keeps them."""

from granular_response.kernels.integrators import INTEGRATORS
from granular_response.scene import Scene
from granular_response.solvers.dynamics import Dynamics, Stop, relax
from granular_response.solvers.problem import Problem
from granular_response.solvers.solution import solve_scene

PACKING = {"kind": "slab", "layers": 4, "disks_per_row": 26}
LOADS = [{"disk": "top-centre", "force": [0.0, -2.0]}]


def main() -> None:
    for friction, wall in ((0.0, 0.0), (0.2, 0.0), (0.2, 0.3), (0.0, 0.3)):
        for law in ("cut", "literal"):
            changes = {"contact": {"friction": friction}, "wall": {"friction": wall}, "protocol": {"friction_law": law}}
            problem = Problem.from_scene(Scene.from_dict({"packing": PACKING, "loads": LOADS, **changes}))
            for name in INTEGRATORS:
                Dynamics(problem, problem.bare_state(), name, 2e-4).advance(1)
        relax(Dynamics(problem, problem.bare_state(), time_step=2e-4), Stop(maximum_steps=100))
    rough = {**PACKING, "polydispersity": 0.2}
    for changes in ({"contact": {"friction": 0.0}}, {"contact": {"friction": 0.2}}, {"packing": rough}):
        solve_scene(Scene.from_dict({"packing": PACKING, "loads": LOADS, **changes}))


if __name__ == "__main__":
    main()
