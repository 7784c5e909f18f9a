"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    22: "Crossover force from one peak to two against friction, for each polydispersity and two smoothing widths. "
    "Thick and thin bars hold 68 % and 95 % of the bootstrap draws over realizations; open triangles are "
    "bounds.",
    "five_realizations": "How often the mean response of five slabs has as many peaks as that of twenty, against "
    "the force over the crossover force; one line for each polydispersity and coefficient of friction.",
}
