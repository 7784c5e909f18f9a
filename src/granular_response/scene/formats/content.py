"""What a file is, by what it holds: its name may say something else."""

from __future__ import annotations

import re

#: Beginnings of files that hold no table of disks as they are.
_BEGINNINGS = {
    b"\x1f\x8b": "is compressed (gzip), must be unpacked first",
    **dict.fromkeys((b"BZh%d1AY" % k for k in range(1, 10)), "is compressed (bzip2), must be unpacked first"),
    b"\xfd7zXZ\x00": "is compressed (xz), must be unpacked first",
    b"\x28\xb5\x2f\xfd": "is compressed (zstd), must be unpacked first",
    b"\x04\x22\x4d\x18": "is compressed (lz4), must be unpacked first",
    b"\x1f\x9d": "is compressed (compress), must be unpacked first",
    b"PK\x03\x04": "is a zip archive (.zip, .xlsx, .npz), must be unpacked or saved as text first",
    b"7z\xbc\xaf\x27\x1c": "is a 7z archive, must be unpacked first",
    b"\x89HDF": "is a file of HDF5 or netCDF; a result is continued by granular-response continue",
    **dict.fromkeys((b"CDF\x01", b"CDF\x02", b"CDF\x05"), "is a file of netCDF"),
    b"\x93NUMPY": "is an array of NumPy; gr.Scene.from_arrays takes arrays",
    b"\xd0\xcf\x11\xe0": "is a table of Excel, must be saved as CSV",
    b"\x89PNG": "is a picture",
    b"II*\x00": "is a picture",
    b"MM\x00*": "is a picture",
    b"\xff\xd8\xff": "is a picture",
    b"%PDF": "is a document (PDF)",
    b"\xff\xfe": "is text in UTF-16, must be saved in UTF-8",
    b"\xfe\xff": "is text in UTF-16, must be saved in UTF-8",
    b"LammpS RestartT": "is a restart file of LAMMPS; write_data and write_dump make files that can be read",
    b"<?xml": "is XML; of the files for ParaView none is read",
    b"<VTKFile": "is XML; of the files for ParaView none is read",
    b"# vtk DataFile": "is a file of VTK, which is not read",
}
_GSD = (0x65DF65DF65DF65DF).to_bytes(8, "little")
#: Place and mark within the first block of an archive.
_TAR = (257, b"ustar")
_YAML_DUMP = re.compile(rb"\A(?:---\s*\n)?(?:[^\n]*\n){0,3}creator:\s*LAMMPS|\A---\s*\n(?:time|timestep|natoms):")
_DATA = re.compile(rb"\A[^\n]*\n(?:\s*(?:#[^\n]*)?\n)*\s*\d+\s+atoms\b")
_XYZ = re.compile(rb"\A\s*\d+\s*\n[^\n]*(?:Lattice|Properties)=")
_SPHERES = re.compile(rb"\A(?:#[^\n]*\n|\s*\n)*(?:\s*[-+.\deE]+){4,}\s*(?:\n|\Z)")
_HEADER = re.compile(rb"\A(?:#[^\n]*\n|\s*\n)*\s*\"?[A-Za-z][^\n]*[,;][^\n]*[,;][^\n]*")


def foreign(data: bytes) -> str:
    """What a file is that is of none of the formats, and what to do; nothing where it may be of one of them."""
    start = data.removeprefix(b"\xef\xbb\xbf")
    for beginning, said in _BEGINNINGS.items():
        if start.startswith(beginning):
            return said
    at, mark = _TAR
    if data[at : at + len(mark)] == mark:
        return "is a tar archive, must be unpacked first"
    head = start[:4096].replace(b"\r\n", b"\n")
    if _YAML_DUMP.search(head):
        return "is a LAMMPS dump of style yaml, must be one of style custom"
    if _XYZ.search(head):
        return "is a file of extended XYZ, which is written and not read (.dump, .data and .csv are)"
    return ""


def recognised(data: bytes) -> str:
    """The format of ``formats.SUFFIXES`` that the content has, nothing where it cannot be told."""
    start = data[:4096].removeprefix(b"\xef\xbb\xbf").replace(b"\r\n", b"\n")
    if start.startswith(_GSD):
        return "gsd"
    if start.startswith(b"ITEM:"):
        return "lammps-dump"
    if _DATA.search(start):
        return "lammps-data"
    if start.startswith(b"#format") or _SPHERES.search(start):
        return "yade"
    return "csv" if _HEADER.search(start) else ""
