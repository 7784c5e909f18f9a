"""What must be done to an HDF5 file made in memory before it can be a file on disk with reproducible bytes.

netCDF's in-memory files differ from those it makes on disk in two ways: they are padded, and the object
header of the root group holds the time of its creation. ``plain_bytes`` removes both. Numbers in brackets are
sections of the HDF5 file format specification, version 3.

A file that netCDF makes on disk has the same bytes every time too, so a temporary file and a rename would do but for a
full disk: HDF5 then says "HDF error" without a reason and keeps the file open until the process ends, so that the space
of a file that has been removed is not given back and the next write meets a lock (``tests/unit/test_store.py`` shows
it). Plain writes of bytes from memory fail with a reason and leave nothing behind.
"""

from __future__ import annotations

_MASK = 0xFFFFFFFF


def plain_bytes(image: bytes | bytearray | memoryview) -> bytes:
    """The file inside ``image``: cut at its end, with the times of the root group zero.

    Raises
    ------
    ValueError
        If the image has another layout than netCDF gives it.
    """
    data = bytearray(image)
    if data[:8] != b"\x89HDF\r\n\x1a\n" or data[8] not in (2, 3):
        raise ValueError("not an HDF5 file with a superblock of version 2 or 3")
    end, root = _integer(data, 28, 8), _integer(data, 36, 8)  # [II.A]
    del data[end:]
    if data[root : root + 4] != b"OHDR":
        raise ValueError("the root group has no object header of version 2")
    flags = data[root + 5]  # [IV.A.1.b]
    if flags & 0x20:
        data[root + 6 : root + 22] = bytes(16)
        before = root + 22 + (4 if flags & 0x10 else 0)
        width = 1 << (flags & 3)
        checksum = before + width + _integer(data, before, width)
        data[checksum : checksum + 4] = lookup3(data[root:checksum]).to_bytes(4, "little")
    return bytes(data)


def is_complete(data: bytes) -> bool:
    """Whether an HDF5 file with a superblock of version 2 or 3 is as long as it says; True for other files."""
    if data[8:9] not in (b"\2", b"\3"):
        return len(data) > 8
    return len(data) >= 36 and len(data) >= _integer(data, 28, 8)  # [II.A]


def _integer(data: bytes | bytearray, start: int, width: int) -> int:
    return int.from_bytes(data[start : start + width], "little")


def lookup3(data: bytes | bytearray) -> int:
    """Jenkins' hash of 32 bits, by which HDF5 protects its metadata."""

    def turn(value: int, by: int) -> int:
        return ((value << by) | (value >> (32 - by))) & _MASK

    a = b = c = (0xDEADBEEF + len(data)) & _MASK
    if not data:
        return c
    blocks = [data[start : start + 12] for start in range(0, len(data), 12)]
    for number, block in enumerate(blocks):
        a = (a + _integer(block, 0, 4)) & _MASK
        b = (b + _integer(block, 4, 4)) & _MASK
        c = (c + _integer(block, 8, 4)) & _MASK
        if number < len(blocks) - 1:
            a = ((a - c) & _MASK) ^ turn(c, 4)
            c = (c + b) & _MASK
            b = ((b - a) & _MASK) ^ turn(a, 6)
            a = (a + c) & _MASK
            c = ((c - b) & _MASK) ^ turn(b, 8)
            b = (b + a) & _MASK
            a = ((a - c) & _MASK) ^ turn(c, 16)
            c = (c + b) & _MASK
            b = ((b - a) & _MASK) ^ turn(a, 19)
            a = (a + c) & _MASK
            c = ((c - b) & _MASK) ^ turn(b, 4)
            b = (b + a) & _MASK
    c = ((c ^ b) - turn(b, 14)) & _MASK
    a = ((a ^ c) - turn(c, 11)) & _MASK
    b = ((b ^ a) - turn(a, 25)) & _MASK
    c = ((c ^ b) - turn(b, 16)) & _MASK
    a = ((a ^ c) - turn(c, 4)) & _MASK
    b = ((b ^ a) - turn(a, 14)) & _MASK
    return ((c ^ b) - turn(b, 24)) & _MASK
