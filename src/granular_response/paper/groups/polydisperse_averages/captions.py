"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    2: "Contact forces in a disordered packing, polydispersity 0.25: under gravity, and what a force on top adds. "
    "Marks on the disks show how far they have turned.",
    19: "Slightly disordered slabs without and with friction: single realizations thin, their mean thick. Above, "
    "the largest disks touch at the start, which gives the paper's peaks; below, the start is the lattice that "
    "its text names, of constant two mean radii.",
    20: "Response at x = 0 per applied force in one slightly disordered slab, for several coefficients of friction, "
    "beside the lattice, and where their linear ranges end (arrows: beyond the largest force).",
    21: "Mean floor response of 20 disordered slabs, with its standard error, for several polydispersities, "
    "coefficients of friction and forces. A number in brackets is that of the slabs at rest, where some "
    "collapsed.",
    "packings": "Packings at rest: directions of their contacts without friction for both starts, contacts of a "
    "disk away from the boundaries (bars: standard deviation), and the part that does not collapse under a "
    "force (colours as before).",
}
