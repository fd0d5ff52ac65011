"""Make every generated file that the scenes refer to: meshes, textures, the sky.

    python reference_scenes/make_assets.py

Nothing is random: the same files come out each time.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab.io.image_file import write_exr, write_png

Array = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]
Surface = tuple[Array, Faces, Array]
HERE = Path(__file__).parent


def write_obj(path: Path, vertices: npt.ArrayLike, faces: list[list[int]]) -> None:
    """A Wavefront file with all digits of the `vertices`; `faces` count from 0."""
    lines = ["v " + " ".join(repr(float(c)) for c in v) for v in np.asarray(vertices)]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_ply(path: Path, vertices: Array, faces: npt.NDArray[np.integer], normals: Array) -> None:
    """A binary PLY file with vertex normals."""
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces, vertex_normals=normals, process=False)
    path.write_bytes(trimesh.exchange.ply.export_ply(mesh, vertex_normal=True))


# --- Cornell CS667 ---


def cs667() -> None:
    """The triangles of homework 4 with the digits that it gives; the quoted numbers follow from those."""
    receiver = [(0, 0, 5), (4.330, 0, -2.5), (-4.330, 0, -2.5)]
    for name in ("cs667_sphere_normal", "cs667_sphere_grazing", "cs667_triangle_normal"):
        write_obj(HERE / name / "receiver.obj", receiver, [[0, 1, 2]])
    write_obj(
        HERE / "cs667_triangle_normal" / "light.obj",
        [(0, 5, 1), (-0.8660, 5, -0.5), (0.8660, 5, -0.5)],
        [[0, 1, 2]],
    )


# --- the Cornell box ---

BOX_FLOOR = [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]
BOX_BACK = [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]
BOX_CEILING = [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]
BOX_HOLE = [(343, 548.8, 227), (343, 548.8, 332), (213, 548.8, 332), (213, 548.8, 227)]
BOX_RIGHT = [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]
BOX_LEFT = [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]
SHORT_TOP = [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)]
TALL_TOP = [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)]


def cornell_box() -> None:
    """The measured geometry, in millimetres, with the hole in the ceiling that the light fills."""
    folder = HERE / "cornell_box"
    room = [*BOX_FLOOR, *BOX_BACK, *BOX_CEILING, *BOX_HOLE]
    ring = [[8 + i, 8 + (i + 1) % 4, 12 + (i + 1) % 4, 12 + i] for i in range(4)]
    write_obj(folder / "white.obj", room, [[0, 1, 2, 3], [4, 5, 6, 7], *ring])
    write_obj(folder / "green.obj", BOX_RIGHT, [[0, 1, 2, 3]])
    write_obj(folder / "red.obj", BOX_LEFT, [[0, 1, 2, 3]])
    for name, top in (("short_block", SHORT_TOP), ("tall_block", TALL_TOP)):
        sides = [[i, 4 + i, 4 + (i + 1) % 4, (i + 1) % 4] for i in range(4)]
        write_obj(folder / f"{name}.obj", [*top, *((x, 0, z) for x, _, z in top)], [[0, 1, 2, 3], *sides])


# --- turned pieces and a knot ---

# Profiles (radius, height) from the foot to the top, rounded by `smooth`.
PAWN = [
    (0, 0), (0.44, 0), (0.46, 0.02), (0.46, 0.12), (0.40, 0.17), (0.34, 0.20), (0.34, 0.25), (0.24, 0.33),
    (0.16, 0.50), (0.13, 0.70), (0.13, 0.80), (0.25, 0.83), (0.25, 0.88), (0.13, 0.91), (0.20, 0.95),
    (0.27, 1.05), (0.27, 1.18), (0.20, 1.30), (0.08, 1.345), (0, 1.35),
]  # fmt: skip
BISHOP = [
    (0, 0), (0.50, 0), (0.52, 0.02), (0.52, 0.13), (0.46, 0.19), (0.38, 0.23), (0.38, 0.29), (0.26, 0.40),
    (0.17, 0.65), (0.14, 1.05), (0.14, 1.20), (0.30, 1.24), (0.30, 1.29), (0.18, 1.32), (0.18, 1.37),
    (0.25, 1.48), (0.27, 1.62), (0.19, 1.84), (0.08, 1.98), (0.07, 2.00), (0.11, 2.05), (0.11, 2.12),
    (0.05, 2.17), (0, 2.175),
]  # fmt: skip


def smooth(profile: npt.ArrayLike, rounds: int = 3) -> Array:
    """The profile with its corners cut `rounds` times; its ends stay. Source: Chaikin 1974."""
    p = np.asarray(profile, np.float64)
    for _ in range(rounds):
        cut = np.stack([0.75 * p[:-1] + 0.25 * p[1:], 0.25 * p[:-1] + 0.75 * p[1:]], axis=1).reshape(-1, 2)
        p = np.concatenate([p[:1], cut, p[-1:]])
    return p


def turned(profile: Array, segments: int = 64) -> Surface:
    """Vertices, faces and normals of a profile (radius, height) turned about the y axis."""
    phi = 2.0 * np.pi * np.arange(segments) / segments
    around = np.stack([np.cos(phi), np.zeros_like(phi), -np.sin(phi)], axis=1)
    vertices = profile[:, None, :1] * around + profile[:, None, 1:] * np.array([0.0, 1.0, 0.0])
    tangent = np.gradient(profile, axis=0)
    tangent[[0, -1]] = [[1.0, 0.0], [-1.0, 0.0]]  # level at the axis
    normals = tangent[:, None, 1:] * around - tangent[:, None, :1] * np.array([0.0, 1.0, 0.0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return vertices.reshape(-1, 3), grid_faces(len(profile), segments, False), normals.reshape(-1, 3)


def grid_faces(rows: int, columns: int, closed: bool) -> Faces:
    """Two triangles for each cell of a grid of vertices whose columns run in a circle, and its rows if `closed`."""
    i, j = np.meshgrid(np.arange(rows if closed else rows - 1), np.arange(columns), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    c, d = (i + 1) % rows * columns + j, (i + 1) % rows * columns + (j + 1) % columns
    return np.stack([np.stack([a, b, d], axis=-1), np.stack([a, d, c], axis=-1)], axis=-2).reshape(-1, 3)


def drop_flat(vertices: Array, faces: Faces) -> Faces:
    """The faces without those that the axis shrinks to a line."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return faces[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-12]


def knot(tube: float = 0.36, rings: int = 240, sides: int = 40) -> Surface:
    """Vertices, faces and normals of the trefoil, as a (2, 3) torus knot; its tube has one thickness."""
    p, q = 2, 3
    t = 2.0 * np.pi * np.arange(rings) / rings
    r = 2.0 + np.cos(q * t)
    centre = np.stack([r * np.cos(p * t), r * np.sin(p * t), -1.3 * np.sin(q * t)], axis=1)
    forward = np.roll(centre, -1, axis=0) - np.roll(centre, 1, axis=0)
    side = np.cross(forward, centre)
    up = np.cross(side, forward)
    side, up = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (side, up))
    s = 2.0 * np.pi * np.arange(sides) / sides
    normals = side[:, None] * np.cos(s)[:, None] + up[:, None] * np.sin(s)[:, None]
    vertices = centre[:, None] + tube * normals
    return vertices.reshape(-1, 3), grid_faces(rings, sides, True), normals.reshape(-1, 3)


def oriented(vertices: Array, faces: Faces, normals: Array) -> Faces:
    """The faces, turned over if they look against the normals."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    agree = (np.cross(b - a, c - a) * normals[faces].sum(axis=1)).sum()
    return faces if agree > 0.0 else faces[:, ::-1]


def meshes() -> None:
    for folder, name, profile in (
        ("soft_shadows", "pawn", PAWN),
        ("still_life", "pawn", PAWN),
        ("still_life", "bishop", BISHOP),
    ):
        vertices, faces, normals = turned(smooth(profile, 2))
        faces = oriented(vertices, drop_flat(vertices, faces), normals)
        write_ply(HERE / folder / f"{name}.ply", vertices, faces, normals)
    vertices, faces, normals = knot()
    write_ply(HERE / "hdr_sky" / "knot.ply", vertices, oriented(vertices, faces, normals), normals)


# --- a light with twelve corners ---


def setting_sun() -> None:
    """A regular polygon of 12 corners in the plane z = 0, normal +z, as a fan about its centre."""
    phi = 2.0 * np.pi * np.arange(12) / 12
    rim = np.stack([np.cos(phi), np.sin(phi), np.zeros(12)], axis=1)
    fan = [[0, 1 + i, 1 + (i + 1) % 12] for i in range(12)]
    write_obj(HERE / "light_below_horizon" / "light.obj", [(0, 0, 0), *rim], fan)


# --- many lights ---

LAMP_RADIUS, LAMP_HEIGHT = 0.04, 0.6
LAMP_COLOURS = np.array(
    [(1.0, 0.62, 0.25), (1.0, 0.85, 0.60), (0.35, 0.60, 1.0), (0.95, 0.30, 0.35), (0.40, 0.95, 0.55)]
)


def lamps(columns: int = 12, rows: int = 12) -> tuple[Array, Array]:
    """Centres (n, 2) in x and z, and radiances (n, 3): a shaken grid, and Pareto's law of powers with exponent 1.6."""
    i = np.arange(columns * rows)
    u, v, w = (np.mod(0.5 + i * golden, 1.0) for golden in (0.8191725134, 0.6710436067, 0.5497004779))
    x = 1.1 * (i % columns - 0.5 * (columns - 1) + 0.7 * (u - 0.5))
    z = 1.1 * (i // columns - 0.5 * (rows - 1) + 0.7 * (v - 0.5)) - 1.5
    power = 60.0 * (1.0 - 0.98 * w) ** (-1.0 / 1.6)
    radiance = LAMP_COLOURS[(2 * i + 3 * (i // columns)) % len(LAMP_COLOURS)] * power[:, None]
    return np.stack([x, z], axis=1).round(3), radiance.round(2)


def garden() -> None:
    """A disk for each lamp, which faces down; a line of the file each."""
    lines = ["<!-- 144 lamps, by make_assets.py -->", '<scene version="3.0.0">']
    for (x, z), radiance in zip(*lamps(), strict=True):
        colour = ", ".join(f"{c:g}" for c in radiance)
        lines.append(
            '    <shape type="disk"><transform name="to_world">'
            f'<scale value="{LAMP_RADIUS}"/><rotate x="1" angle="90"/>'
            f'<translate x="{x:g}" y="{LAMP_HEIGHT}" z="{z:g}"/>'
            f'</transform><emitter type="area"><rgb name="radiance" value="{colour}"/></emitter></shape>'
        )
    (HERE / "many_lights" / "lamps.xml").write_text("\n".join([*lines, "</scene>"]) + "\n", encoding="ascii")


# --- textures ---


def checks(squares: int, dark: tuple[float, ...], light: tuple[float, ...], texels: int) -> Array:
    """(n, n, 3): a chequered board of `squares` x `squares`, `texels` along a square."""
    i = np.arange(squares * texels) // texels
    odd = (i[:, None] + i[None, :]) % 2 == 1
    return np.where(odd[..., None], np.array(dark), np.array(light))


def board() -> Array:
    """(n, n, 3): a wooden chess board of 8 x 8 squares with a rim, its grain a sum of sines."""
    n, rim = 720, 40
    y, x = np.mgrid[0:n, 0:n] / n
    grain = 0.0
    for k, (a, b, c) in enumerate([(3.0, 61.0, 0.3), (5.0, 97.0, 1.7), (2.0, 23.0, 4.1), (9.0, 181.0, 2.2)]):
        grain = grain + np.sin(2.0 * np.pi * (b * y + 0.35 * np.sin(2.0 * np.pi * (a * x + c)) + c)) / (k + 2.0)
    grain = 1.0 + 0.07 * grain
    cell = (n - 2 * rim) // 8
    i = (np.arange(n) - rim) // cell
    inside = (i >= 0) & (i < 8)
    odd = (i[:, None] + i[None, :]) % 2 == 1
    colour = np.where(odd[..., None], [0.13, 0.045, 0.018], [0.62, 0.43, 0.24])
    colour = np.where((inside[:, None] & inside[None, :])[..., None], colour, [0.075, 0.026, 0.012])
    return np.clip(colour * grain[..., None], 0.0, 1.0)


def textures() -> None:
    write_png(HERE / "basic_ray_tracing" / "checks.png", checks(2, (0.50, 0.05, 0.04), (0.85, 0.75, 0.30), 8))
    write_png(HERE / "mirror_balls" / "checks.png", checks(2, (0.50, 0.05, 0.04), (0.85, 0.75, 0.30), 8))
    write_png(HERE / "still_life" / "board.png", board())


# --- the sky ---

SUN_ELEVATION, SUN_AZIMUTH = 38.0, 292.0  # degrees; the azimuth counts from -z towards +x
SUN_RATIO = 1e5  # the sun's radiance over the mean radiance of the sky above the horizon, in luminance
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def sky(height: int = 128, width: int = 256) -> Array:
    """(h, w, 3): a clear sky over brown earth, mean luminance 1 above the horizon, and one texel of sun.

    Rows stand at theta = pi j / (h - 1) from +y, columns at phi = 2 pi (i + 1/2) / w, as the reader of environments
    has them: direction (sin theta sin phi, cos theta, -sin theta cos phi).
    """
    theta, phi = np.linspace(0.0, np.pi, height), 2.0 * np.pi * (np.arange(width) + 0.5) / width
    y = np.cos(theta)[:, None]
    east, south = np.outer(np.sin(theta), np.sin(phi)), np.outer(np.sin(theta), -np.cos(phi))
    direction = np.stack([east, np.broadcast_to(y, east.shape), south], axis=-1)
    row = round((90.0 - SUN_ELEVATION) / 180.0 * (height - 1))
    column = int(SUN_AZIMUTH / 360.0 * width)
    to_sun = np.clip(direction @ direction[row, column], -1.0, 1.0)[..., None]
    up = np.maximum(y, 0.0)[..., None]
    haze = np.exp(-up / 0.16)
    blue = np.array([0.16, 0.36, 0.86]) * (0.75 + 0.25 * to_sun**2)
    white = np.array([1.05, 1.15, 1.22])
    angle = np.arccos(to_sun)
    glow = np.array([1.0, 0.80, 0.52]) * (1.6 * np.exp(-angle / 0.16) + 0.35 * np.exp(-angle / 0.6))
    above = blue * (1.0 - haze) + white * haze + glow
    mist = np.exp(np.minimum(y, 0.0) / 0.04)[..., None]
    earth = np.array([0.30, 0.23, 0.17]) * (1.0 - mist) + white * mist
    pixels = np.where(y[..., None] >= 0.0, above, earth)
    weights = np.where(y >= 0.0, np.sin(theta)[:, None], 0.0) * np.ones(width)
    pixels = pixels / (((pixels @ LUMINANCE) * weights).sum() / weights.sum())
    colour = np.array([1.0, 0.93, 0.80])
    pixels[row, column] = SUN_RATIO * colour / (colour @ LUMINANCE)
    return pixels


def main() -> None:
    cs667()
    cornell_box()
    meshes()
    setting_sun()
    garden()
    textures()
    write_exr(HERE / "hdr_sky" / "sky.exr", {"": sky()}, {})
    for path in sorted(HERE.glob("*/*")):
        if path.suffix in (".obj", ".ply", ".png", ".exr") or path.name == "lamps.xml":
            print(f"{path.relative_to(HERE)}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
