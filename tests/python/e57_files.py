# SPDX-License-Identifier: GPL-3.0-or-later

"""E57 files, written bit by bit after ASTM E2807."""

import struct
from dataclasses import dataclass

CONTENTS = 1020
NORMALS = "http://www.libe57.org/E57_NOR_surface_normals.txt"


@dataclass
class Number:
    """Whole numbers of as few bits as their limits need, optionally scaled."""

    values: list[int]
    low: int
    high: int
    scale: float | None = None
    offset: float = 0.0

    def xml(self, name: str) -> str:
        kind = "Integer" if self.scale is None else "ScaledInteger"
        more = "" if self.scale is None else f' scale="{self.scale}" offset="{self.offset}"'
        return f'<{name} type="{kind}" minimum="{self.low}" maximum="{self.high}"{more}/>'

    def stream(self) -> bytes:
        width = (self.high - self.low).bit_length()
        whole = 0
        for k, value in enumerate(self.values):
            whole |= (value - self.low) << (k * width)
        return whole.to_bytes((len(self.values) * width + 7) // 8, "little")


@dataclass
class Floating:
    """Floating-point numbers, of single or double precision."""

    values: list[float]
    precision: str = "double"

    def xml(self, name: str) -> str:
        return f'<{name} type="Float" precision="{self.precision}"/>'

    def stream(self) -> bytes:
        code = "f" if self.precision == "single" else "d"
        return struct.pack(f"<{len(self.values)}{code}", *self.values)


def checksum(page: bytes) -> bytes:
    """CRC-32C, bit by bit."""
    found = 0xFFFFFFFF
    for byte in page:
        found ^= byte
        for _ in range(8):
            found = (found >> 1) ^ (0x82F63B78 if found & 1 else 0)
    return (found ^ 0xFFFFFFFF).to_bytes(4, "big")


def physical(place: int) -> int:
    return place // CONTENTS * (CONTENTS + 4) + place % CONTENTS


def paged(contents: bytes) -> bytes:
    starts = range(0, len(contents), CONTENTS)
    pages = (contents[k : k + CONTENTS].ljust(CONTENTS, b"\0") for k in starts)
    return b"".join(page + checksum(page) for page in pages)


def pose_xml(rotation, translation) -> str:
    turn = "".join(f'<{n} type="Float">{v}</{n}>' for n, v in zip("wxyz", rotation, strict=True))
    # A number that is 0 may have no text.
    place = "".join(
        f'<{n} type="Float">{v}</{n}>' if v else f'<{n} type="Float"/>'
        for n, v in zip("xyz", translation, strict=True)
    )
    return (
        f'<pose type="Structure"><rotation type="Structure">{turn}</rotation>'
        f'<translation type="Structure">{place}</translation></pose>'
    )


def section(fields, begin: int, per_packet: int) -> bytes:
    """Points as a section that begins there; packets end anywhere within numbers."""
    streams = [field.stream() for field in fields.values()]
    packets = [bytes([2, 0, 3, 0])]  # an empty one
    while any(streams):
        parts = [stream[:per_packet] for stream in streams]
        streams = [stream[per_packet:] for stream in streams]
        body = struct.pack("<H", len(parts)) + struct.pack(f"<{len(parts)}H", *map(len, parts))
        body += b"".join(parts)
        body += bytes(-(len(body) + 4) % 4)
        packets.append(struct.pack("<BBH", 1, 0, len(body) + 3) + body)
    data = b"".join(packets)
    head = struct.pack("<B7xQQQ", 1, 32 + len(data), physical(begin + 32), 0)
    return head + data


def e57(scans, *, per_packet: int = 700) -> bytes:
    """The bytes of a file of scans.

    Args:
        scans: For each its fields by name; and XML that comes before its points.
        per_packet: How many bytes of each field are in a packet.
    """
    contents, described = bytes(48), ""
    for fields, more in scans:
        contents += bytes(-len(contents) % 4)
        begin = len(contents)
        contents += section(fields, begin, per_packet)
        count = max(len(field.values) for field in fields.values())
        prototype = "".join(field.xml(name) for name, field in fields.items())
        described += (
            f'<vectorChild type="Structure">{more}<points type="CompressedVector" '
            f'fileOffset="{physical(begin)}" recordCount="{count}"><prototype type="Structure">'
            f'{prototype}</prototype><codecs type="Vector"/></points></vectorChild>'
        )
    text = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<e57Root type="Structure" '
        'xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0" '
        f'xmlns:nor="{NORMALS}"><data3D type="Vector">{described}</data3D></e57Root>'
    ).encode()
    begin = len(contents)
    contents += text
    size = -(-len(contents) // CONTENTS) * (CONTENTS + 4)
    head = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, size, physical(begin), len(text), 1024)
    return paged(head + contents[48:])
