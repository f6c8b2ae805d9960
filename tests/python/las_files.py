# SPDX-License-Identifier: GPL-3.0-or-later

"""LAS files, written after the specification of LAS 1.4, without a library."""

import struct

SIZES = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
COLORS = {2: 20, 3: 28, 5: 28, 7: 30, 8: 30, 10: 30}
SCALES, OFFSETS = (0.001, 0.01, 0.5), (500_000.0, 5_000_000.0, -10.0)


def las(points, point_format, *, extra=(), padding=0, records=(), mark=0):
    """The bytes of a LAS file.

    Args:
        points: A dictionary for each: x, y, z in steps, and perhaps intensity, number, of, class,
            color and the names of extra dimensions.
        point_format: 0 to 10.
        extra: (name, kind, code of struct, scale, offset) of extra dimensions.
        padding: Undescribed bytes after each point.
        records: (user, number, contents), written before the record of the extra dimensions.
        mark: Bits that are added to the format.
    """
    described = b"".join(
        struct.pack(
            "<2xBB32s4x72s3d3d32x",
            kind,
            (8 if scale != 1.0 else 0) | (16 if offset else 0),
            name.encode(),
            b"",
            *(scale, 0.0, 0.0),
            *(offset, 0.0, 0.0),
        )
        for name, kind, _, scale, offset in extra
    )
    records = [*records, *([(b"LASF_Spec", 4, described)] if extra else [])]
    listed = b"".join(
        struct.pack("<2x16sHH32x", user, number, len(contents)) + contents
        for user, number, contents in records
    )
    code = "".join(each[2] for each in extra)
    length = SIZES[point_format] + struct.calcsize(f"<{code}") + padding
    minor, head_size = (4, 375) if point_format > 5 else (2, 227)
    head = bytearray(head_size)
    head[:4] = b"LASF"
    head[24:26] = bytes([1, minor])
    struct.pack_into("<HII", head, 94, head_size, head_size + len(listed), len(records))
    count = 0 if minor == 4 else len(points)
    struct.pack_into("<BHI", head, 104, point_format | mark, length, count)
    struct.pack_into("<6d", head, 131, *SCALES, *OFFSETS)
    if minor == 4:
        struct.pack_into("<Q", head, 247, len(points))
    return bytes(head) + listed + b"".join(_record(p, point_format, length, extra) for p in points)


def _record(point, point_format, length, extra):
    data = bytearray(length)
    struct.pack_into("<3iH", data, 0, *point["xyz"], point.get("intensity", 0))
    number, of, kind = point.get("number", 1), point.get("of", 1), point.get("class", 0)
    if point_format < 6:
        data[14] = number | of << 3 | 0x40  # a flag beside them
        data[15] = kind | 0x80  # likewise
    else:
        data[14] = number | of << 4
        data[15], data[16] = 0xFF, kind
    if point_format in COLORS:
        struct.pack_into("<3H", data, COLORS[point_format], *point["color"])
    place = SIZES[point_format]
    for name, _, code, _, _ in extra:
        struct.pack_into(f"<{code}", data, place, point[name])
        place += struct.calcsize(f"<{code}")
    data[place:] = b"\xee" * (length - place)
    return bytes(data)
