"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    "numerics": "What the paper says about its numerics: the error of floor forces against the kinetic energy at "
    "which a run stops, the kinetic energy of statically finished states put back into the dynamics, and the "
    "time to rest against the damping of a contact.",
}
