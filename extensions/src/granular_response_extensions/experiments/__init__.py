#: Direction of the lattice below the horizontal, in degrees.
LATTICE = 60.0
