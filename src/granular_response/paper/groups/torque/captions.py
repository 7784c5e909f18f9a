"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    18: "Force chains under an oblique force on one disk, for several torques on the same disk and packing.",
}
