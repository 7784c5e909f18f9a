"""Names that keys of a scene, columns of files and scripts for LAMMPS share."""

#: Components of the motion of a disk.
MOTION = ("vx", "vz", "spin")
#: Forces of the walls, by the names that ``fix wall/gran ... contacts`` has in our scripts.
WALL_FIXES = ("floor", "sides")
