# SPDX-License-Identifier: GPL-3.0-or-later

"""Writers of scan files, independent of the library, and sample data for them."""

import struct
from pathlib import Path

import numpy as np
import prefilter

TYPES = {
    "char": "b",
    "int8": "b",
    "uchar": "B",
    "uint8": "B",
    "short": "h",
    "int16": "h",
    "ushort": "H",
    "uint16": "H",
    "int": "i",
    "int32": "i",
    "uint": "I",
    "uint32": "I",
    "float": "f",
    "float32": "f",
    "double": "d",
    "float64": "d",
}
POINTS = np.array([(0.0, 0.5, 1.0), (1.0, 0.25, -2.0), (3.0, 4.0, 5.5)])
NORMALS = np.array([(0.0, 0.6, -0.8), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])
COLORS = np.array([(0, 10, 255), (1, 1, 1), (200, 0, 3)])
INTENSITY = np.array([-2048.0, 0.5, 2047.0])
FORMATS = ("ascii", "binary_little_endian", "binary_big_endian")


def lines(*columns, separator=" "):
    """Rows of numbers."""
    return "".join(
        separator.join(map(str, row)) + "\n" for row in np.column_stack(columns).tolist()
    )


def whole(text):
    """Rows of numbers, with whole numbers written without a point."""
    return text.replace(".0 ", " ").replace(".0\n", "\n")


def ply(form, elements, *, lines=(), newline="\n"):
    """The bytes of a PLY file.

    `elements` are (name, properties, rows); a property is (type, name), or (type of the length,
    type, name) of a list; a row has a value, or a list, for each.
    """
    header = ["ply", f"format {form} 1.0", *lines]
    body = []
    order = ">" if form == "binary_big_endian" else "<"
    for name, properties, rows in elements:
        header.append(f"element {name} {len(rows)}")
        for each in properties:
            header.append("property " + ("list " if len(each) == 3 else "") + " ".join(each))
        for row in rows:
            words = []
            for each, value in zip(properties, row, strict=True):
                if len(each) == 3:
                    words += [(each[0], len(value)), *((each[1], one) for one in value)]
                else:
                    words.append((each[0], value))
            if form == "ascii":
                body.append(" ".join(repr(value) for _, value in words).encode() + newline.encode())
            else:
                body += [struct.pack(order + TYPES[kind], value) for kind, value in words]
    header.append("end_header")
    return "".join(line + newline for line in header).encode() + b"".join(body)


def write(folder: Path, name: str, contents: bytes) -> Path:
    path = folder / name
    path.write_bytes(contents)
    return path


def random_rows(types, count, seed=0):
    """Rows of values that each of the types holds exactly."""
    random = np.random.default_rng(seed)
    columns = []
    for kind in types:
        code = np.dtype(TYPES[kind])
        if code.kind == "f":
            columns.append(random.normal(size=count).astype(code).tolist())
        else:
            info = np.iinfo(code)
            columns.append(random.integers(info.min, info.max, count, endpoint=True).tolist())
    return list(zip(*columns, strict=True))


def pcd(data, fields, rows, *, lines=None):
    """The bytes of a PCD file; a field is (name, type of numpy, count)."""
    kinds = [np.dtype(kind) for _, kind, _ in fields]
    header = {
        "VERSION": "0.7",
        "FIELDS": " ".join(name for name, _, _ in fields),
        "SIZE": " ".join(str(kind.itemsize) for kind in kinds),
        "TYPE": " ".join({"f": "F", "i": "I", "u": "U"}[kind.kind] for kind in kinds),
        "COUNT": " ".join(str(count) for _, _, count in fields),
        "WIDTH": str(len(rows)),
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": str(len(rows)),
        "DATA": data,
        **(lines or {}),
    }
    text = "# .PCD v0.7 - Point Cloud Data file format\n"
    text += "".join(f"{key} {value}\n" for key, value in header.items() if value is not None)
    layout = np.dtype([(f"f{k}", kind, (n,)) for k, (_, kind, n) in enumerate(fields)])
    table = np.array([tuple(np.atleast_1d(value) for value in row) for row in rows], layout)
    if data == "binary":
        body = table.tobytes()
    elif data == "binary_compressed":
        plain = b"".join(table[name].tobytes() for name in layout.names)
        packed = lzf(plain)
        body = struct.pack("<II", len(packed), len(plain)) + packed
    else:
        words = (" ".join(str(v) for part in row for v in part.tolist()) for row in table)
        body = "".join(line + "\n" for line in words).encode()
    return text.encode() + body


def lzf(plain):
    """Compresses as LibLZF does, but searches longer for repetitions."""
    packed, literals, seen, at = bytearray(), bytearray(), {}, 0

    def flush():
        for k in range(0, len(literals), 32):
            some = literals[k : k + 32]
            packed.append(len(some) - 1)
            packed.extend(some)
        literals.clear()

    while at < len(plain):
        key = plain[at : at + 3]
        start = seen.get(key)
        seen[key] = at
        if start is None or len(key) < 3 or at - start > 8192:
            literals.append(plain[at])
            at += 1
            continue
        flush()
        length = 3
        while (
            length < 264
            and at + length < len(plain)
            and (plain[start + length] == plain[at + length])
        ):
            length += 1
        back = at - start - 1
        if length - 2 < 7:
            packed.append(((length - 2) << 5) | (back >> 8))
        else:
            packed += bytes([(7 << 5) | (back >> 8), length - 2 - 7])
        packed.append(back & 255)
        at += length
    flush()
    return bytes(packed)


def garble(random, contents):
    """Truncates a file, or changes, repeats or removes some of its bytes."""
    garbled = bytearray(contents)
    for _ in range(random.integers(1, 4)):
        at, length = random.integers(0, len(garbled) + 1), random.integers(1, 9)
        kind = random.integers(5)
        if kind == 0:
            del garbled[at:]
        elif kind == 1:
            del garbled[at : at + length]
        elif kind == 2:
            garbled[at:at] = garbled[max(at - length, 0) : at]
        elif kind == 3:
            garbled[at : at + length] = random.bytes(length)
        else:
            garbled[at : at + 1] = random.choice([b"9", b"-", b" ", b"\n", b"\xff", b"e"])
    return bytes(garbled)


def garbled_are_refused(folder, name, contents):
    """Asserts that damaged files are read, or refused with their names."""
    random = np.random.default_rng(5)
    prefilter.read_points(write(folder, name, contents))
    messages = []
    for _ in range(200):
        try:
            points = prefilter.read_points(write(folder, name, garble(random, contents)))
        except ValueError as error:
            messages.append(str(error))
        else:
            assert len(points.positions) < 100
    assert len(messages) > 20
    assert all(name in message for message in messages)
