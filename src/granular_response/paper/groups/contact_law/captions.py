"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    "contact_law": "Not in the paper: Sec. III.B says that measurements on its disks gave a force that grows as the "
    "overlap to the power 3/2, and that a linear law describes it well. Floor response with the linear law (lines) and "
    "with the 3/2 law (symbols), whose force is the same at the mean overlap of the slab at rest. Without friction the "
    "disks of a row of the 3/2 slab bear almost nothing along x: it has several equilibria, and little decides which "
    "one is met.",
}
