"""What the figures of this group show: by number of the paper's figure, or by file of a further one."""

CAPTIONS: dict[int | str, str] = {
    13: "What a force adds at the contacts of a slab, for three coefficients of friction; width by magnitude.",
    14: "The vertical stress of these forces, coarse-grained with a Gaussian, beside that of a harmonic lattice.",
    15: "Magnitude of the added contact forces against position at several depths under a large force.",
}
