"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    10: "Floor response at friction 10 for several ratios of tangential to normal stiffness: two peaks at small ones.",
    11: "The spring model: a triangular lattice with normal and tangential springs, horizontal and oblique ones apart.",
}
