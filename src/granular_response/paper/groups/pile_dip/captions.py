"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    17: "A pile under gravity without and with friction: contact forces, vertical stress, and contact network.",
}
