"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    3: "Ordered slab without friction: floor response per applied force. One peak splits into two as the force grows.",
    4: "Contacts that the force opens in the same slab. They are horizontal, and their region grows downwards.",
    5: "Depth and largest width of that region against the force, for slabs of several depths, and what the "
    "stiffness of the disks changes.",
}
