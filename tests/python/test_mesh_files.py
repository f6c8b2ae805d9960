# SPDX-License-Identifier: GPL-3.0-or-later

"""Mesh files read by the command: polygons, UVs of corners, and glTF's accessors."""

import base64
import json
import math
import struct

import numpy as np
import pytest
from prefilter.workflows import mesh_files

U = [(1, 1), (1, 3), (0, 3), (0, 0), (3, 0), (3, 3), (2, 3), (2, 1)]
"""The outline of a letter; its area is 3 x 3 less 1 x 2."""


def prism():
    """Returns the vertices and the polygons of a letter of depth 1, closed."""
    points = [(x, y, z) for z in (0, 1) for x, y in U]
    count = len(U)
    sides = [(k, (k + 1) % count, count + (k + 1) % count, count + k) for k in range(count)]
    return points, [tuple(range(count))[::-1], tuple(range(count, 2 * count)), *sides]


def obj(points, faces):
    lines = ["v {} {} {}".format(*point) for point in points]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    return "\n".join(lines).encode() + b"\n"


def off(points, faces):
    lines = ["OFF # a letter", "", f"{len(points)} {len(faces)} 0"]
    lines += ["{} {} {}".format(*point) for point in points]
    lines += [f"{len(face)} {' '.join(map(str, face))} 255 0 0" for face in faces]
    return "\n".join(lines).encode()


def ply(points, faces, kind="ascii", uvs=None):
    count = "uchar" if kind == "ascii" else "uint8"
    header = f"ply\nformat {kind} 1.0\nelement vertex {len(points)}\n"
    header += "".join(f"property float {axis}\n" for axis in "xyz")
    header += f"element face {len(faces)}\nproperty list {count} int vertex_indices\n"
    header += "property list uchar float texcoord\n" if uvs is not None else ""
    header = f"{header}end_header\n".encode()
    order = ">" if "big" in kind else "<"
    rows = []
    for point in points:
        rows.append((f"{order}3f", *point))
    for number, face in enumerate(faces):
        row = [f"{order}B{len(face)}i", len(face), *face]
        if uvs is not None:
            row[0] += f"B{2 * len(face)}f"
            row += [2 * len(face), *np.ravel(uvs[number])]
        rows.append(tuple(row))
    if kind == "ascii":
        return header + "\n".join(" ".join(map(str, row[1:])) for row in rows).encode() + b"\n"
    return header + b"".join(struct.pack(*row) for row in rows)


def read(tmp_path, name, data):
    path = tmp_path / name
    path.write_bytes(data)
    return mesh_files.read("FILE", [str(path)])


def volume(part):
    a, b, c = (part.positions[part.triangles[:, k]] for k in range(3))
    return (a * np.cross(b, c)).sum() / 6


@pytest.mark.parametrize(
    ("name", "write"),
    [
        ("u.obj", obj),
        ("u.off", off),
        ("u.ply", ply),
        ("little.ply", lambda *mesh: ply(*mesh, "binary_little_endian")),
        ("big.ply", lambda *mesh: ply(*mesh, "binary_big_endian")),
    ],
)
def test_concave_polygons_are_cut_inside(tmp_path, name, write):
    (part,) = read(tmp_path, name, write(*prism()))
    assert part.name == name[:-4]
    assert len(part.triangles) == 28
    assert volume(part) == pytest.approx(7)
    a, b, c = (part.positions[part.triangles[:, k]] for k in range(3))
    # Split into fans, the polygons at the ends would get overlapping triangles.
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(2 * 7 + 16)


def mean_uv(part):
    """Returns the mean of the UVs over the surface."""
    triangles, uvs = part.mapped()
    a, b, c = (part.positions[triangles[:, k]] for k in range(3))
    weights = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return (uvs.mean(axis=1) * weights[:, None]).sum(axis=0) / weights.sum()


def test_corners_keep_their_uvs(tmp_path):
    """UVs equal positions, so their mean is the letter's centroid: (9 * 1.5 - 2 * 2) / 7 up."""
    points = [(x, y, 0) for x, y in U]
    lines = obj(points, []).decode() + "".join(f"vt {x} {y}\n" for x, y in U[::-1])
    lines += "f " + " ".join(f"{k + 1}/{8 - k}" for k in range(8))
    parts = read(tmp_path, "a.obj", lines.encode())
    parts += read(tmp_path, "b.ply", ply(points, [range(8)], uvs=[U]))
    parts += read(tmp_path, "c.ply", ply(points, [range(8)], "binary_big_endian", [U]))
    off_lines = ["STOFF", "8 1 0", *(f"{x} {y} 0 {x} {y}" for x, y in U), "8 0 1 2 3 4 5 6 7"]
    parts += read(tmp_path, "d.off", "\n".join(off_lines).encode())
    for part in parts:
        np.testing.assert_allclose(mean_uv(part), [1.5, 9.5 / 7], atol=1e-6)
        np.testing.assert_array_equal(part.uvs, part.positions[part.triangles][..., :2])


def test_uvs_of_ply_vertices(tmp_path):
    header = "ply\nformat ascii 1.0\nelement vertex 3\n"
    header += "".join(f"property float {name}\n" for name in ("x", "y", "z", "s", "t"))
    header += "element face 1\nproperty list uchar int vertex_index\nend_header\n"
    data = f"{header}0 0 0 .5 .25\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"
    (part,) = read(tmp_path, "a.ply", data.encode())
    np.testing.assert_array_equal(part.uvs, [[(0.5, 0.25), (1, 0), (0, 1)]])


SQUARE = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"


@pytest.mark.parametrize(
    "faces",
    [
        b"f 1/1 2/2 3/3 4/4",
        b"f 1/1/1 2/2/1 3/3/1 4/4/1 # the front",
        b"f -4/-4 -3/-3/-1 \\\n3/-2 4/4/1",
        b"usemtl a\r\nf 1/1 2/2 3/3\r\nusemtl b\r\ng other\r\nf 1/1/1 3/3/1 4/4/1\r\n",
    ],
)
def test_ways_to_write_faces_in_obj_files(tmp_path, faces):
    (part,) = read(tmp_path, "a.obj", SQUARE + faces)
    np.testing.assert_array_equal(part.triangles, [(0, 1, 2), (0, 2, 3)])
    np.testing.assert_array_equal(part.uvs, part.positions[part.triangles][..., :2])


def test_faces_without_uvs_are_named(tmp_path):
    (part,) = read(tmp_path, "a.obj", SQUARE + b"f 1/1 2/2 3/3\nf 1//1 3//1 4//1\n")
    surfaces, names, told = mesh_files.surfaces([part])
    assert surfaces[0].triangle_count == 1
    assert names == ["a"]
    assert told == ["mesh 'a': left out 1 triangle without UVs"]
    assert len(part.triangles) == 2
    (bare,) = read(tmp_path, "b.obj", SQUARE + b"f 1 2 3 4\n")
    assert bare.uvs is None


def test_objects_of_obj_files(tmp_path):
    data = SQUARE + b"o Second one\nf 1 2 3\no First\nf 1 3 4\no Empty\no Second one\nf 2 3 4\n"
    parts = read(tmp_path, "a.obj", data)
    assert [part.name for part in parts] == ["First", "Second one"]
    assert [len(part.triangles) for part in parts] == [1, 2]
    assert len(parts[0].positions) == 3


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("a.obj", SQUARE + b"f 1 2 5", "a face names vertex 5; there are 4, from 1"),
        ("a.obj", SQUARE + b"f 1 2 0", "a face names vertex 0; there are 4, from 1"),
        ("a.obj", SQUARE + b"f 1/1 2/2 3/9", "a face names UV 9; there are 4, from 1"),
        ("a.obj", SQUARE + b"f 1 2 -5", "a face names vertex 0"),
        ("a.obj", SQUARE + b"f 1 2 x", "found 'x' in a line 'f'"),
        ("a.obj", b"v 0 0\nf 1 1 1\n", "a line 'v' has other than 3 numbers"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "names vertex 3; there are 3"),
        ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", "it ends too early"),
        ("a.off", b"3 1 0\n", "its first line is not OFF"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement face 0\nend_header\n", "no list 'vertex_ind"),
    ],
)
def test_damaged_files(tmp_path, name, data, words):
    with pytest.raises(OSError, match="cannot be read as a mesh: .*" + words):
        read(tmp_path, name, data)


def test_files_without_triangles(tmp_path):
    for name, data in {"a.obj": SQUARE + b"f 1 2\nl 1 2\n", "a.off": b"OFF 0 0 0\n"}.items():
        with pytest.raises(ValueError, match="there is no triangle in"):
            read(tmp_path, name, data)


class Gltf:
    """A glTF file of one mesh, built part by part."""

    def __init__(self):
        self.data = b""
        self.tree = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": []}
        self.primitives = []
        self.node = {"mesh": 0, "name": "Node"}

    def view(self, data, **more):
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data), **more}
        self.tree["bufferViews"].append(view)
        self.data += data + b"\0" * (-len(data) % 4)
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values, kind, **more):
        values = np.array(values, kind)
        types = {"f4": 5126, "u1": 5121, "i1": 5120, "u2": 5123, "u4": 5125, "i2": 5122}
        shape = values.reshape(len(values), -1).shape
        found = {
            "bufferView": self.view(values.tobytes()),
            "componentType": types[kind],
            "count": shape[0],
            "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[shape[1]],
            **more,
        }
        self.tree["accessors"].append(found)
        return len(self.tree["accessors"]) - 1

    def add(self, attributes, indices=None, **more):
        primitive = {"attributes": attributes, **more}
        if indices is not None:
            primitive["indices"] = self.accessor(indices, "u2")
        self.primitives.append(primitive)

    def write(self, path):
        binary = path.suffix == ".glb"
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        buffer = {"byteLength": len(self.data)} | ({} if binary else {"uri": uri})
        tree = {
            **self.tree,
            "nodes": [self.node],
            "meshes": [{"name": "Mesh", "primitives": self.primitives}],
            "buffers": [buffer],
        }
        text = json.dumps(tree).encode()
        if binary:
            text += b" " * (-len(text) % 4)
            chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
            chunks += struct.pack("<II", len(self.data), 0x004E4942) + self.data
            text = b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks
        path.write_bytes(text)
        return mesh_files.read("FILE", [str(path)])


CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
UVS = [(0, 1), (1, 1), (1, 0), (0, 0)]
"""v points down in glTF files, so these UVs are the corners' positions."""


@pytest.mark.parametrize("name", ["a.gltf", "a.glb"])
def test_gltf_meshes_without_a_material_have_uvs(tmp_path, name):
    file = Gltf()
    attributes = {"POSITION": file.accessor(CORNERS, "f4"), "TEXCOORD_0": file.accessor(UVS, "f4")}
    file.add(attributes, [0, 1, 2, 0, 2, 3])
    (part,) = file.write(tmp_path / name)
    assert part.name == "Mesh"
    np.testing.assert_array_equal(part.uvs, part.positions[part.triangles][..., :2])


def test_gltf_strips_fans_and_several_materials(tmp_path):
    """All parts become one mesh, as their author sees them."""
    file = Gltf()
    places, uvs = file.accessor(CORNERS, "f4"), file.accessor(UVS, "f4")
    attributes = {"POSITION": places, "TEXCOORD_0": uvs}
    file.add(attributes, [0, 1, 3, 2], mode=5, material=0)
    file.add(attributes, [0, 1, 2, 3], mode=6, material=1)
    file.add(attributes, mode=6)
    file.add({"POSITION": places}, [0, 1, 2])
    file.add({"POSITION": places}, [0, 1], mode=1)
    file.tree["materials"] = [{}, {}]
    (part,) = file.write(tmp_path / "a.glb")
    a, b, c = (part.positions[part.triangles[:, k]] for k in range(3))
    np.testing.assert_array_equal(np.cross(b - a, c - a), [(0, 0, 1)] * 7)
    triangles, found = part.mapped()
    assert len(triangles) == 6
    np.testing.assert_array_equal(found, part.positions[triangles][..., :2])


def test_gltf_numbers_of_other_types(tmp_path):
    """Normalized whole numbers are fractions; sparse accessors change some; views have strides."""
    file = Gltf()
    rows = b"".join(struct.pack("<3fI", *corner, 7) for corner in CORNERS)
    places = file.accessor(CORNERS, "f4", bufferView=file.view(rows, byteStride=16))
    file.tree["accessors"][places]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": file.view(b"\2"), "componentType": 5121},
        "values": {"bufferView": file.view(struct.pack("<3f", 2, 2, 0))},
    }
    whole = [(65535 * u, 65535 * v) for u, v in UVS]
    uvs = file.accessor(whole, "u2", normalized=True)
    file.add({"POSITION": places, "TEXCOORD_0": uvs}, [0, 1, 2, 0, 2, 3])
    (part,) = file.write(tmp_path / "a.gltf")
    np.testing.assert_array_equal(part.positions[2], [2, 2, 0])
    np.testing.assert_array_equal(part.uvs[0], [(0, 0), (1, 0), (1, 1)])


def test_gltf_places_of_nodes(tmp_path):
    half = math.sqrt(0.5)
    file = Gltf()
    file.add({"POSITION": file.accessor(CORNERS, "f4")}, [0, 1, 2, 0, 2, 3])
    file.node |= {"translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [-2, 2, 2]}
    (part,) = file.write(tmp_path / "a.gltf")
    # Mirrored and made larger, then turned by a right angle from x to y, then moved.
    np.testing.assert_allclose(
        part.positions, [(1, 2, 3), (1, 0, 3), (-1, 0, 3), (-1, 2, 3)], atol=1e-9
    )
    a, b, c = part.positions[part.triangles[0]]
    assert np.cross(b - a, c - a)[2] == pytest.approx(4)


def test_gltf_files_that_are_compressed_are_refused(tmp_path):
    file = Gltf()
    file.add({"POSITION": file.accessor(CORNERS, "f4")}, [0, 1, 2])
    file.tree["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    with pytest.raises(OSError, match="compressed by KHR_draco_mesh_compression; export it"):
        file.write(tmp_path / "a.gltf")
    del file.tree["extensionsRequired"], file.tree["accessors"][0]["bufferView"]
    with pytest.raises(OSError, match="accessor 0 has no values; is the file compressed"):
        file.write(tmp_path / "a.gltf")
