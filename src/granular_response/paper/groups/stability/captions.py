"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    "stability_motion": "Undamped systems, energy change per kinetic energy at first: a kicked slab without "
    "friction, with a twentieth of the largest stable time step, and the same with friction 0.2, which only "
    "takes energy. Collisions without dashpots, largest of all spins and coefficients of friction: the default "
    "rule of friction never gives energy, the paper's equation for the spring taken literally does. Disks set "
    "on the floor with a velocity and a spin, which slide until they roll: lines simulated, symbols in closed "
    "form.",
    "stability_scenes": "What became of random scenes: blue have a result, orange an error of one line, and wrong "
    "would be a result that its positions contradict or an error that nobody understands. The largest "
    "unbalanced force of certified results, computed from positions alone (broken line: 1e-9; beyond are stiff "
    "scenes, where the last digit of a position is worth that much). Relative change of a floor response when "
    "the rest state is displaced by 1e-12 of a radius (broken line).",
    "stability_steps": "What becomes of a kicked slab at rest in raw dynamics, for time steps in units of the "
    "predicted limit. One property of the scene is changed in each column.",
}
