"""Scene files with mistakes of every kind: those of `reference_scenes`, of the docs' kinds, cut, mixed and misspelt.

A mutation is (what, where, with): pure data, so that hypothesis can shrink a list of them to the one that matters.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
from broken_scenes import CASES, document
from hypothesis import strategies as st
from scene_text import LAMP_OVER_FLOOR

from raylab.io.image_file import write_exr

REFERENCES = Path(__file__).parent.parent / "reference_scenes"
GOOD = (
    LAMP_OVER_FLOOR,
    *(path.read_text() for path in sorted(REFERENCES.glob("*/*.xml")) if path.stat().st_size < 10_000),
)
BAD = tuple(document(body) for _, body, *_ in CASES)
NUMBERS = (
    "0", "-0", "-1", "1", "2", "0.5", "1e-300", "1e-150", "1e-45", "1e-12", "1e12", "1e45", "1e150", "1e200", "1e308",
    "5e-324", "1e309", "nan", "inf", "-inf", "2147483647", "2147483648", "9223372036854775807", "1" * 400, "180", "90",
    "+.5", "1.", "0x10", "1_0", "٣", "1,5", "1 2 3", "", "-1e-320",
)  # fmt: skip
FRAGMENTS = (
    "<", ">", "/>", '"', "'", "&", "&amp;", "&lt;", "&#0;", "&#xD800;", "&nbsp;", "<!--", "-->", "<![CDATA[", "]]>", "<?x y?>",
    "<!DOCTYPE scene>", '<!DOCTYPE s [<!ENTITY a "b">]>', "$", "$spp", "\\$", "$nobody", "\0", "\x0b", "\ufeff", "é", "𝄞",
    '<shape type="sphere"/>', '<shape type="cube" id="a"/>', '<ref id="a"/>', '<ref id="ivory"/>', '<include filename="test.xml"/>',
    '<include filename="."/>', '<include filename="../"/>', '<include filename=""/>', '<alias id="a" as="b"/>', '<default name="spp" value="$spp"/>',
    '<default name="" value=""/>', '<transform name="to_world"><scale value="0"/></transform>', '<translate x="1e200"/>',
    '<scale value="1e-200"/>', '<scale value="1e200"/>', '<scale x="-1"/>', '<rotate x="1" angle="1e300"/>', '<lookat origin="0,0,0" target="0,0,1"/>',
    '<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"/>', '<emitter type="area"><rgb name="radiance" value="2"/></emitter>',
    '<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>', '<emitter type="point"/>', '<emitter type="constant"/>',
    '<emitter type="directional"/>', '<bsdf type="dielectric"/>', '<bsdf type="conductor"/>', '<bsdf type="roughplastic"/>',
    '<bsdf type="roughconductor"/>', '<bsdf type="phong"/>', '<bsdf type="twosided"/>', '<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>',
    '<bsdf type="bumpmap"/>', '<spectrum name="radiance" value="400:1, 500:2"/>', '<spectrum name="radiance" value="400:"/>',
    '<spectrum name="radiance" filename="white.spd"/>', '<spectrum type="blackbody" name="radiance"/>', '<spectrum type="d65" name="radiance"/>',
    '<rgb name="radiance" value="1e308"/>', '<rgb name="reflectance" value="0"/>', '<float name="radius" value="1e200"/>',
    '<float name="focus_distance" value="inf"/>', '<float name="focus_distance" value="1e-300"/>', '<float name="aperture_radius" value="1e300"/>',
    '<float name="fov" value="179.9999999999"/>', '<float name="exponent" value="1e9"/>', '<float name="alpha" value="1e-300"/>',
    '<float name="near_clip" value="1e-300"/>', '<float name="far_clip" value="1e308"/>', '<integer name="width" value="2147483647"/>',
    '<integer name="sample_count" value="2147483647"/>', '<integer name="max_depth" value="-1"/>', '<boolean name="flip_normals" value="true"/>',
    '<animation name="to_world"><transform time="0"/><transform time="1"><translate x="1"/></transform></animation>',
    '<animation name="to_world"><transform time="0"/><transform time="1e-300"><rotate z="1" angle="180"/></transform></animation>',
    '<texture type="bitmap" name="reflectance"><string name="filename" value="board.png"/></texture>', "twosided", "area", "ply", "obj", "sphere",
    "cylinder", "disk", "thinlens", "perspective", "to_world", "to_uv", "hide_emitters", "filename", "value", "name", "type", "id", "scene", "radiance",
)  # fmt: skip
TOKEN = {
    "number": r"(?<=[\s\",])[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?(?=[\s\",])",
    "value": r'(?<==")[^"]*(?=")',
    "attribute": r'\s[\w:]+="[^"]*"',
    "word": r"[\w]+",
    "tag": r"<[^>]*>",
    "anywhere": r"",
}
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-32", "latin-1", "cp1252")
NAMES = ("utf-8", "UTF-16", "ascii", "latin-1", "ebcdic", "", "utf-7")


def mutation(fragments: tuple[str, ...]) -> st.SearchStrategy[tuple]:
    """What to do, to which token, how far down the file in thousandths, and with what."""
    return st.tuples(
        st.sampled_from(("replace", "replace", "insert", "delete", "copy", "swap", "wrap", "cut")),
        st.sampled_from(tuple(TOKEN)),
        st.integers(0, 999),
        st.one_of(st.sampled_from(NUMBERS), st.sampled_from(fragments), st.integers(0, 999), st.text(max_size=3)),
    )


writing = st.one_of(
    st.just(("utf-8", None, None)),
    st.tuples(
        st.sampled_from(ENCODINGS),
        st.none() | st.sampled_from(NAMES),
        st.none() | st.tuples(st.integers(0, 999), st.binary(min_size=1, max_size=4)),
    ),
)
broken_file = st.tuples(
    st.sampled_from(GOOD) | st.sampled_from(BAD), st.lists(mutation(FRAGMENTS), max_size=5), writing
).map(lambda a: mutated(*a))


def mutated(text: str, mutations: list[tuple], writing: tuple) -> bytes:
    """The file `text` after all mutations, one after the other, as bytes."""
    for what, token, place, payload in mutations:
        spans = [m.span() for m in re.finditer(TOKEN[token], text)]
        if spans:
            start, end = spans[place * len(spans) // 1000]
            other = spans[payload * len(spans) // 1000] if isinstance(payload, int) else (0, 0)
            text = MUTATIONS[what](text, start, end, text[slice(*other)] if isinstance(payload, int) else payload)
    encoding, name, cut_in = writing
    if name is not None:
        text = f'<?xml version="1.0" encoding="{name}"?>\n{text}'
    data = text.encode(encoding, "replace")
    if cut_in is not None:
        place, more = cut_in
        data = data[: place * len(data) // 1000] + more + data[place * len(data) // 1000 :]
    return data


MUTATIONS: dict[str, Callable[[str, int, int, str], str]] = {
    "replace": lambda text, i, j, new: text[:i] + new + text[j:],
    "insert": lambda text, i, j, new: text[:j] + new + text[j:],
    "delete": lambda text, i, j, new: text[:i] + text[j:],
    "copy": lambda text, i, j, new: text[:j] + text[i:j] + text[j:],
    "swap": lambda text, i, j, new: text[:i] + new + text[j:].replace(new, text[i:j], 1) if new else text,
    "wrap": lambda text, i, j, new: f"{text[:i]}{new}{text[i:j]}{new}{text[j:]}",
    "cut": lambda text, i, j, new: text[:i],
}


def fill(folder: Path) -> None:
    """Small files under the names that the scenes refer to."""
    names = [name for seed in GOOD + BAD for name in re.findall(r'"(\w+\.(?:obj|ply|spd|exr|png))"', seed)]
    ply = ["ply", "format ascii 1.0", "element vertex 3", *(f"property float {c}" for c in "xyz")]
    ply += [
        "element face 1",
        "property list uchar int vertex_indices",
        "end_header",
        "0 0 0",
        "1 0 0",
        "0 1 0",
        "3 0 1 2",
    ]
    for name in sorted(set(names)):
        kind = name[-3:]
        if kind in ("exr", "png"):
            source = next(iter(REFERENCES.glob(f"*/{name}")), None)
            if kind == "png":
                (folder / name).write_bytes((REFERENCES / "basic_ray_tracing/checks.png").read_bytes())
            elif source or name in ("sky.exr", "half.exr"):
                write_exr(folder / name, {"": np.full((2, 4, 3), 0.5)}, {})
        elif kind == "spd":
            (folder / name).write_text("".join(f"{x} {y}\n" for x, y in pairwise(range(400, 700, 50))).replace(",", ""))
        else:
            lines = ply if kind == "ply" else ["v 0 0 0", "v 1 0 0", "v 0 1 0", "f 1 2 3"]
            (folder / name).write_text("\n".join(lines) + "\n")
