"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    "preparation": "The same slab prepared in several ways: forces between which each event comes, against friction. "
    "An arrow: not up to there. Rough: the walls have the friction of the disks; all others are smooth.",
}
