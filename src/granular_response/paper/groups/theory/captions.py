"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    1: "Two theories of the pressure on the floor below a force. Elliptic: an elastic slab on a rough or a smooth "
    "floor, and a half plane at the same depth. Hyperbolic: two rays that spread diffusively, for two depths.",
}
