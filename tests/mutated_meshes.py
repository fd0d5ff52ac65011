"""Mesh files with mistakes of every kind: OBJ, and PLY as text and in both orders of bytes, cut, mixed and misspelt."""

from __future__ import annotations

import struct

from hypothesis import strategies as st
from mutated_files import mutated, mutation

CORNERS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.5), (0.0, 1.0, 0.0))
OBJ = (
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "# two\nmtllib a.mtl\no one\nv 0 0 0\nv 1 0 0\nv 1 1 .5\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl red\ns 1\n"
    "g half\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/2/1\n",
    "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nvn 0 0 1\r\nf 1//1 2//1 3//1 4//1\r\n",
    "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nf -3/-3 -2/-2 -1/-1\nv 2 2 2\nf -1/1 -2/2 -3/3\n",
)
HEADER = "ply\nformat {form} 1.0\ncomment fuzz\nelement vertex 4\n{vertex}element face {faces}\n{face}end_header\n"
PLACE = "property float x\nproperty float y\nproperty float z\n"
MORE = "property float nx\nproperty float ny\nproperty float nz\nproperty double u\nproperty double v\nproperty uchar red\n"
LIST = "property list uchar int vertex_indices\n"


def text(faces: tuple[tuple[int, ...], ...], more: bool) -> str:
    """A PLY file in ASCII."""
    rows = [
        " ".join(map(str, (*corner, *((0, 0, 1, corner[0], corner[1], 255) if more else ())))) for corner in CORNERS
    ]
    rows += [" ".join(map(str, (len(face), *face))) for face in faces]
    head = HEADER.format(form="ascii", vertex=PLACE + MORE * more, faces=len(faces), face=LIST)
    return head + "\n".join(rows) + "\n"


def binary(faces: tuple[tuple[int, ...], ...], more: bool, order: str) -> str:
    """A binary PLY file, its bytes as characters of Latin-1."""
    data = b"".join(
        struct.pack(f"{order}3f", *corner) + (struct.pack(f"{order}3f2dB", 0, 0, 1, *corner[:2], 9) if more else b"")
        for corner in CORNERS
    )
    data += b"".join(struct.pack(f"{order}B{len(face)}i", len(face), *face) for face in faces)
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    head = HEADER.format(form=form, vertex=PLACE + MORE * more, faces=len(faces), face=LIST)
    return head + data.decode("latin-1")


TRIANGLES, SQUARE = ((0, 1, 2), (0, 2, 3)), ((0, 1, 2, 3),)
PLY = (
    *(text(faces, more) for faces in (TRIANGLES, SQUARE, (*SQUARE, (0, 1, 2))) for more in (False, True)),
    *(binary(faces, more, order) for faces in (TRIANGLES, SQUARE) for more in (False, True) for order in "<>"),
)
FRAGMENTS = (
    "\n", " ", "\r", "\t", "\\\n", "\0", "#", "f", "v", "vn", "vt", "/", "//", "-", "f 1 2 3\n", "f 1 2 3 4 5\n", "f -1 -2 -3\n",
    "f 1//1 2//1 3//1\n", "f 1/1 2/2 3/3\n", "f 1 2\n", "f 0 0 0\n", "f 1 1 1\n", "f 99 98 97\n", "f\n", "vn 0 0 0\n", "vn 1 2\n",
    "vn nan 0 1\n", "vt 1e39 -1e300\n", "vt 0 0 0\n", "vt nan 0\n", "v 1 2\n", "v 1 2 3 4\n", "v inf 0 0\n", "v 1e200 1e200 0\n",
    "o a\n", "g b\n", "usemtl c\n", "s off\n", "l 1 2\n", "p 1\n", "call x.obj\n",
    "ply\n", "end_header\n", "format ascii 1.0\n", "format binary_little_endian 1.0\n", "format binary_big_endian 1.0\n",
    "element vertex 0\n", "element vertex 2147483647\n", "element vertex -1\n", "element face 0\n", "element face 99999999\n",
    "element edge 2\n", "property float x\n", "property double w\n", "property int nx\n", "property float s\n", "property float t\n",
    "property list uchar int vertex_indices\n", "property list int double vertex_index\n", "property list uchar float texcoord\n",
    "property list\n", "property uchar\n", "comment TextureFile a.png\n", "obj_info x\n", "3 0 1 2\n", "4 0 1 2 3\n", "3 0 1 9\n",
    "3 0 0 0\n", "0\n", "2 0 1\n", "255 0\n", "\xff\xff\xff\xff", "\x00\x00\x80\x7f", "\x00\x00\xc0\x7f", "\x7f\x80\x00\x00",
    "\xff\xff\x7f\x7f", "\x01\x00\x00\x00",
)  # fmt: skip
cut_in = st.none() | st.tuples(st.integers(0, 999), st.binary(min_size=1, max_size=8))


def broken(files: tuple[str, ...]) -> st.SearchStrategy[bytes]:
    writing = cut_in.map(lambda cut: ("latin-1", None, cut))
    return st.tuples(st.sampled_from(files), st.lists(mutation(FRAGMENTS), max_size=5), writing).map(
        lambda a: mutated(*a)
    )


SHAPE = """<shape type="{kind}"><string name="filename" value="mesh.{kind}"/><boolean name="face_normals" value="{flat}"/>
{inside}</shape>"""
INSIDE = (
    '<bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="board.png"/></texture></bsdf>',
    '<transform name="to_world"><scale value="1e-3" y="-2"/><rotate x="1" angle="30"/></transform>',
    '<emitter type="area"><rgb name="radiance" value="2"/></emitter>',
)
shapes = st.builds(
    lambda kind, flat, inside: (kind, SHAPE.format(kind=kind, flat=str(flat).lower(), inside=inside)),
    st.sampled_from(("obj", "ply", "ply")),
    st.booleans(),
    st.sampled_from(INSIDE),
)
broken_mesh = shapes.flatmap(lambda a: st.tuples(st.just(a), broken(OBJ if a[0] == "obj" else PLY)))
