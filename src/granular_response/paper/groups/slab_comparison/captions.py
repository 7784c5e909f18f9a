"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    1: "Not in the paper: simulated responses to a force of 0.01 mg beside the elastic slab with their moduli and "
    "floor, and the largest distance of the two as the number of layers grows (8 wide: eight disks of a row for "
    "each layer; slow: gravity grows slowly). Two things keep packings from it: beside smooth walls gravity "
    "opens contacts, which is felt in a narrow slab of any depth, and a sudden fall on a rough floor can open a "
    "row in the middle, as with 15 layers.",
}
