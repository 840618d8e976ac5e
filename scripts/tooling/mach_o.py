"""Makes the macOS libraries that zig links the same bytes in every build.

zig's linker leaves the end of the indirect symbol table as it finds the memory: it writes no entries for the GOT's
own symbols but counts them. (Only debuggers read the table.) Here these entries are set, and what depends on them,
the UUID and the code signature's hashes, is computed again. Formats: <mach-o/loader.h> and <kern/cs_blobs.h>.
"""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Iterator
from pathlib import Path

LC_DYSYMTAB, LC_SEGMENT_64, LC_UUID, LC_CODE_SIGNATURE = 0x0B, 0x19, 0x1B, 0x1D
INDIRECT_SYMBOL_LOCAL = 0x80000000
CODE_DIRECTORY = 0xFADE0C02
SHA256 = 2


def commands(file: bytes | bytearray) -> Iterator[tuple[int, int]]:
    """(load command, its offset) of a 64-bit Mach-O file."""
    count, offset = struct.unpack_from("<I", file, 16)[0], 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", file, offset)
        yield command, offset
        offset += size


def section_sizes(file: bytes | bytearray) -> dict[str, int]:
    sizes = {}
    for command, offset in commands(file):
        if command == LC_SEGMENT_64:
            for number in range(struct.unpack_from("<I", file, offset + 64)[0]):
                name, _, _, size = struct.unpack_from("<16s16sQQ", file, offset + 72 + 80 * number)
                sizes[name.rstrip(b"\0").decode()] = size
    return sizes


def set_unwritten_entries(file: bytearray, dysymtab: int) -> None:
    """The table should be stubs, GOT, lazy pointers; the last are for the same symbols as the stubs."""
    start, count = struct.unpack_from("<II", file, dysymtab + 56)
    table = list(struct.unpack_from(f"<{count}I", file, start))
    stubs = section_sizes(file)["__la_symbol_ptr"] // 8
    ends = [end for end in range(2 * stubs, count + 1) if table[end - stubs : end] == table[:stubs]]
    if not ends:
        raise ValueError("the indirect symbol table has another form than zig's")
    table[ends[0] :] = [INDIRECT_SYMBOL_LOCAL] * (count - ends[0])
    struct.pack_into(f"<{count}I", file, start, *table)


def code_hashes(file: bytes | bytearray, signature: int) -> tuple[int, bytes]:
    """Where the signature keeps the hashes of the file's pages, and what they should be."""
    blobs = struct.unpack_from(">I", file, signature + 8)[0]
    offsets = [struct.unpack_from(">II", file, signature + 12 + 8 * n)[1] + signature for n in range(blobs)]
    (directory,) = (o for o in offsets if struct.unpack_from(">I", file, o)[0] == CODE_DIRECTORY)
    hashes, _, _, pages, limit, size, kind, _, page = struct.unpack_from(">IIIIIBBBB", file, directory + 16)
    if (size, kind) != (32, SHA256):
        raise ValueError("the signature's hashes are not SHA-256")
    step = 1 << page
    digests = [hashlib.sha256(file[n * step : min((n + 1) * step, limit)]).digest() for n in range(pages)]
    return directory + hashes, b"".join(digests)


def make_reproducible(library: Path) -> None:
    """Rewrite the file. Raises ValueError, and leaves it alone, if it is not as zig makes it."""
    file = bytearray(library.read_bytes())
    at = dict(commands(file))
    signature = struct.unpack_from("<I", file, at[LC_CODE_SIGNATURE] + 8)[0] if LC_CODE_SIGNATURE in at else None
    if signature:
        place, hashes = code_hashes(file, signature)
        if file[place : place + len(hashes)] != hashes:
            raise ValueError("the signature does not fit the file")
    set_unwritten_entries(file, at[LC_DYSYMTAB])
    uuid = at[LC_UUID] + 8
    file[uuid : uuid + 16] = bytes(16)
    digest = bytearray(hashlib.sha256(file[:signature]).digest()[:16])
    digest[6], digest[8] = digest[6] & 0x0F | 0x80, digest[8] & 0x3F | 0x80  # RFC 9562, version 8: own making
    file[uuid : uuid + 16] = digest
    if signature:
        place, hashes = code_hashes(file, signature)
        file[place : place + len(hashes)] = hashes
    library.write_bytes(file)
