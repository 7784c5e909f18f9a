"""What YADE runs for `yade_dem.py`: `yade -n -x -j1 yade_slab.py` in a folder with `scene.json` writes `answer.json`.

With a load, all motion stops before the second stage, in which the load grows.
"""


def main():
    import json
    import math
    import time

    from yade import (
        Bo1_Sphere_Aabb,
        Bo1_Wall_Aabb,
        ForceResetter,
        Ig2_Sphere_Sphere_ScGeom,
        Ig2_Wall_Sphere_ScGeom,
        InsertionSortCollider,
        InteractionLoop,
        InterpolatingDirectedForceEngine,
        Ip2_ViscElMat_ViscElMat_ViscElPhys,
        Law2_ScGeom_ViscElPhys_Basic,
        NewtonIntegrator,
        O,
        ViscElMat,
        utils,
    )  # fmt: skip

    with open("scene.json") as file:
        scene = json.load(file)
    disk, wall = ViscElMat(density=1.0, **scene["disk"]), ViscElMat(density=1.0, **scene["wall"])
    O.materials.append([disk, wall])
    disks = []
    for (x, z), radius, mass in zip(scene["x"], scene["radius"], scene["mass"], strict=True):
        body = utils.sphere((x, z, 0), radius, material=disk)
        body.state.mass, body.state.inertia = mass, (0.5 * mass * radius**2,) * 3
        body.state.blockedDOFs = "zXY"
        disks.append(O.bodies.append(body))
    for axis, at in ((1, 0.0), (0, 0.0), (0, scene["width"])):
        O.bodies.append(utils.wall(at, axis=axis, material=wall))
    # half the skin that the others keep: it is added to each disk
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()], verletDist=0.15),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
            [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
            [Law2_ScGeom_ViscElPhys_Basic()],
        ),
        NewtonIntegrator(damping=0.0, gravity=(0.0, -1.0, 0.0)),
    ]
    O.dt = scene["time_step"]
    stages, heights = [], []
    for number, steps in enumerate(scene["stages"]):
        if scene["load"] and number == 1:
            for i in disks:
                O.bodies[i].state.vel = O.bodies[i].state.angVel = (0.0, 0.0, 0.0)
            load, now = scene["load"], O.time
            push = InterpolatingDirectedForceEngine(
                ids=[disks[load["disk"]]], direction=(0.0, -1.0, 0.0),
                times=[now, now + load["ramp"], math.inf], magnitudes=[0.0, load["force"], load["force"]],
            )  # fmt: skip
            O.engines = [O.engines[0], push, *O.engines[1:]]
        wall_clock, processor = time.perf_counter(), time.process_time()
        O.run(steps, True)
        stages.append([steps, time.perf_counter() - wall_clock, time.process_time() - processor])
        heights.append([O.bodies[i].state.pos[1] for i in disks])
    with open("/proc/self/status") as file:
        peak = next(int(line.split()[1]) / 1024 for line in file if line.startswith("VmHWM"))
    answer = {"stages": stages, "heights": heights, "peak_mebibytes": peak}
    with open("answer.json", "w") as file:
        json.dump(answer, file)


if __name__ == "__main__":
    main()
