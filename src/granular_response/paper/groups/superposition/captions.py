"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    23: "Two loads of 0.2 mg on a slightly disordered slab: the response to both and the sum of the responses to "
    "each, disk by disk, for several distances d.",
    24: "The same with 1 mg. Then the difference of the two, root mean square relative to both: against the force, "
    "for the floor and for all contacts, and against depth. Means of the realizations with standard errors. "
    "Dotted: change of the contact forces per force under a single load, relative to the smallest. Shaded: "
    "where the linear range of the middle half of the realizations ends; broken line: its median.",
}
