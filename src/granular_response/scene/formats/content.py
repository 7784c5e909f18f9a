"""What a file is, by what it holds: its name may say something else."""

from __future__ import annotations

#: Bytes of a file by which it is known.
_HEAD = 4096
#: Beginnings of files that hold no table of disks as they are.
_COMPRESSED = {
    b"\x1f\x8b": "gzip", b"\xfd7zXZ\x00": "xz", b"\x28\xb5\x2f\xfd": "zstd", b"\x04\x22\x4d\x18": "lz4",
    b"\x1f\x9d": "compress", b"\x5d\x00\x00": "lzma", **dict.fromkeys((b"x\x01", b"x\x9c", b"x\xda"), "zlib"),
    **dict.fromkeys((b"BZh%d1AY" % k for k in range(1, 10)), "bzip2"),
}  # fmt: skip
_BEGINNINGS = {
    **{beginning: f"is compressed ({kind}), must be unpacked first" for beginning, kind in _COMPRESSED.items()},
    **dict.fromkeys((b"\x80\x04", b"\x80\x05"), "is a pickle of Python; gr.Scene.from_arrays takes arrays"),
    **dict.fromkeys((b"{", b"["), "is JSON or the like, must be a table in CSV"),
    b"Number of particles =": "is a LAMMPS dump of style cfg, must be one of style custom",
    b"PK\x03\x04": "is a zip archive (.zip, .xlsx, .npz), must be unpacked or saved as text first",
    **dict.fromkeys((b"PK\x05\x06", b"PK\x07\x08"), "is a zip archive, must be unpacked first"),
    b"7z\xbc\xaf\x27\x1c": "is a 7z archive, must be unpacked first",
    b"Rar!\x1a\x07": "is a RAR archive, must be unpacked first",
    b"version https://git-lfs": "is a pointer of Git LFS, git lfs pull fetches the file itself",
    **dict.fromkeys((b"<!DOCTYPE", b"<!doctype", b"<html"), "is a web page, not the file that was to be fetched"),
    b"PAR1": "is a table of Parquet, must be saved as CSV",
    b"SQLite format 3": "is a database of SQLite, must be saved as CSV",
    b"MATLAB 5.0": "is a file of MATLAB, must be saved as CSV",
    b"\x89HDF": "is a file of HDF5 or netCDF; a result is continued by granular-response continue",
    **dict.fromkeys((b"CDF\x01", b"CDF\x02", b"CDF\x05"), "is a file of netCDF"),
    b"\x93NUMPY": "is an array of NumPy; gr.Scene.from_arrays takes arrays",
    b"\xd0\xcf\x11\xe0": "is a table of Excel, must be saved as CSV",
    **dict.fromkeys((b"\x89PNG", b"II*\x00", b"MM\x00*", b"\xff\xd8\xff"), "is a picture"),
    b"%PDF": "is a document (PDF)",
    **dict.fromkeys((b"\xff\xfe", b"\xfe\xff"), "is text in UTF-16, must be saved in UTF-8"),
    b"LammpS RestartT": "is a restart file of LAMMPS; write_data and write_dump make files that can be read",
    **dict.fromkeys((b"<?xml", b"<VTKFile"), "is XML; of the files for ParaView none is read"),
    b"# vtk DataFile": "is a file of VTK, which is not read",
}
_GSD = (0x65DF65DF65DF65DF).to_bytes(8, "little")


def foreign(data: bytes) -> str:
    """What a file is that is of none of the formats, and what to do; nothing where it may be of one of them."""
    start = data.removeprefix(b"\xef\xbb\xbf")
    for beginning, said in _BEGINNINGS.items():
        if start.startswith(beginning):
            return said
    if data[257:].startswith(b"ustar"):
        return "is a tar archive, must be unpacked first"
    first, second, *_ = [*_lines(start), "", ""]
    if any(line.startswith(("creator: LAMMPS", "timestep:", "natoms:")) for line in _lines(start)):
        return "is a LAMMPS dump of style yaml, must be one of style custom"
    if first.isdecimal() and ("Lattice=" in second or "Properties=" in second):
        return "is a file of extended XYZ, which is written and not read (.dump, .data and .csv are)"
    if first.isdecimal() and second.startswith("Atoms"):
        return "is a LAMMPS dump of style xyz, must be one of style custom"
    if b"\0" in data[:_HEAD] and not data.startswith(_GSD):
        return "is a binary file, or text in UTF-16, and none that is read"
    return ""


def _lines(data: bytes) -> list[str]:
    """The first lines of a text, without those that are empty."""
    return [line for one in data[:_HEAD].decode("utf-8", "replace").splitlines() if (line := one.strip())]


def recognised(data: bytes) -> str:
    """The format of ``formats.SUFFIXES`` that the content has, nothing where it cannot be told."""
    if data.startswith(_GSD):
        return "gsd"
    lines = _lines(data.removeprefix(b"\xef\xbb\xbf"))
    rows = [line for line in lines if not line.startswith("#")]
    if not rows:
        return ""
    if rows[0].startswith("ITEM:"):
        return "lammps-dump"
    if any(line.split()[1:] == ["atoms"] for line in lines[1:20]):
        return "lammps-data"
    columns = max(rows[0].count(","), rows[0].count(";"))
    return "csv" if columns >= 2 and rows[0].lstrip('"')[0].isalpha() else ""
