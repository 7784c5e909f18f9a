"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    22: "Crossover force from one peak to two against friction, for each polydispersity and two smoothing widths "
    "(broken line: the lattice, its last point a bound). "
    "Thick and thin bars hold 68 % and 95 % of the bootstrap draws over realizations, "
    "with an arrow head where an end lies beyond every simulated force; open circles with an arrow are bounds of "
    "the crossover itself. Dark: two peaks, light: one, white: not simulated.",
    "five_realizations": "How often the mean response of five slabs has as many peaks as that of twenty, against "
    "the force over the crossover force, for each polydispersity, smoothing width and coefficient of friction.",
}
