"""Embree in the kernel agrees with two independent intersectors, and rays that cannot be traced are refused."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest
import trimesh
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh

from raylab import description as d
from raylab.embree import EmbreeScene, blocked, trace
from raylab.jit import njit
from raylab.packet import LANES, new_packet, trace_packet
from raylab.scene import Scene
from raylab.surface import INVALID_RAYS, intersect
from raylab.vec3 import Vec3, vec3_at
from raylab.view import View

RAYS = 20_000


@pytest.fixture(scope="module")
def knot() -> trimesh.Trimesh:
    """A ball with a bumpy surface: a closed mesh that is not convex."""
    ball = trimesh.creation.icosphere(subdivisions=4)
    radius = 0.6 + 0.1 * np.sin(9 * ball.vertices[:, 0]) * np.cos(7 * ball.vertices[:, 1])
    return trimesh.Trimesh(ball.vertices * radius[:, None], ball.faces, process=False)


@pytest.fixture(scope="module")
def rays() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4620)
    origins = rng.uniform(-1, 1, (RAYS, 3)).astype(np.float32)
    directions = rng.normal(size=(RAYS, 3)).astype(np.float32)
    return origins, directions


@njit
def trace_all(handle, origins, directions, found, blocks):
    for i in range(len(found)):
        o, direction = vec3_at(origins, i), vec3_at(directions, i)
        geometry, primitive = trace(handle, o, direction, 0.0, math.inf)
        found[i] = primitive if geometry >= 0 else -1
        blocks[i] = blocked(handle, o, direction, math.inf)


@njit
def trace_in_packets(handle, packet, origins, directions, off, found):
    for first in range(0, len(found), LANES):
        lanes = min(LANES, len(found) - first)
        for lane in range(LANES):
            i = min(first + lane, len(found) - 1)
            packet.put(lane, vec3_at(origins, i), vec3_at(directions, i), math.inf, 0.0, off[i] != 1)
        packet.clear(lanes)
        trace_packet(handle, packet)
        for lane in range(lanes):
            geometry, primitive = packet.hit(lane)
            found[first + lane] = primitive if geometry >= 0 else -1


def kernel_answers(mesh: trimesh.Trimesh, rays) -> tuple[np.ndarray, np.ndarray]:
    vertices = np.concatenate([mesh.vertices, np.zeros((1, 3))]).astype(np.float32)
    scene = EmbreeScene()
    scene.add_mesh(vertices[:-1], mesh.faces.astype(np.uint32))
    scene.commit()
    found, blocks = np.zeros(RAYS, np.int64), np.zeros(RAYS, np.int64)
    trace_all(np.uint64(scene.handle), View(rays[0]), View(rays[1]), View(found), View(blocks))
    return found, blocks


def test_kernel_agrees_with_embreex(knot, rays):
    found, blocks = kernel_answers(knot, rays)
    reference = rtcore_scene.EmbreeScene()
    TriangleMesh(reference, knot.vertices.astype(np.float32), knot.faces.astype(np.int32))
    expected = reference.run(rays[0].copy(), rays[1].copy(), query="INTERSECT")
    assert 0.2 < (expected >= 0).mean() < 0.95  # the test has hits and misses to tell apart
    np.testing.assert_array_equal(found, expected)
    np.testing.assert_array_equal(blocks == 1, expected >= 0)


@pytest.mark.parametrize("quadrics", [False, True], ids=["triangles", "with spheres and disks"])
def test_packets_agree_with_single_rays(knot, rays, quadrics):
    """Every third lane is switched off and must not be touched; the last packet is not full."""
    shapes: list[d.Shape] = [d.Mesh(vertices=knot.vertices, faces=knot.faces)]
    if quadrics:
        shapes += [d.Sphere(center=np.array([0.5, 0.5, 0.5]), radius=0.6), d.Disk(), d.Cylinder(radius=0.3)]
    scene = Scene(d.SceneDescription(shapes=tuple(shapes)))
    handle, some = np.uint64(scene.embree.handle), RAYS - 5
    single, packed, blocks = np.zeros(some, np.int64), np.zeros(some, np.int64), np.zeros(some, np.int64)
    off = (np.arange(some) % 3 == 1).astype(np.int64)
    origins, directions = View(rays[0] / 2), View(rays[1])  # more of them among the shapes
    trace_all(handle, origins, directions, View(single), View(blocks))
    trace_in_packets(handle, new_packet(), origins, directions, View(off), View(packed))
    assert 0.2 < (single >= 0).mean() < 0.95
    np.testing.assert_array_equal(packed, np.where(off == 1, -1, single))


def test_kernel_agrees_with_trimesh(knot, rays):
    """trimesh's own intersector works in float64: it may differ only where a ray passes an edge within rounding."""
    some = slice(0, 2000)
    found, _ = kernel_answers(knot, rays)
    intersector = trimesh.ray.ray_triangle.RayMeshIntersector(knot)
    locations, index_ray, index_tri = intersector.intersects_location(rays[0][some], rays[1][some])
    distance = np.linalg.norm(locations - rays[0][some][index_ray], axis=1)
    first = np.full(2000, -1)
    for k in np.argsort(-distance):  # the nearest is written last
        first[index_ray[k]] = index_tri[k]
    differ = np.flatnonzero(first != found[some])
    for i in differ:
        if first[i] < 0 or found[i] < 0:
            pytest.fail(f"ray {i}: trimesh meets {first[i]}, the kernel {found[i]}")
        shared = set(knot.faces[first[i]]) & set(knot.faces[found[i]])
        assert len(shared) >= 1, f"ray {i}: triangles {first[i]} and {found[i]} do not touch"
    assert len(differ) <= 2  # 2000 rays, edges 1e-7 wide


@njit
def hit_distance(scene, o, direction):
    hit = intersect(scene, o, direction, 0.0, math.inf)
    return hit.found, hit.x.p


@pytest.mark.parametrize(
    ("origin", "direction"),
    [
        ((math.nan, 0, 0), (0, 0, 1)), ((0, 0, math.inf), (0, 0, -1)), ((0, 0, 0), (math.nan, 0, 1)),
        ((0, 0, 0), (0, -math.inf, 0)), ((0, 0, 0), (0, 0, 0)),
    ],
)  # fmt: skip
def test_invalid_rays_are_counted_and_not_traced(origin, direction):
    scene = Scene(d.SceneDescription(shapes=(d.Rectangle(),)))
    found, _ = hit_distance(scene.data, Vec3(*origin), Vec3(*direction))
    assert not found
    assert scene.data.tally[INVALID_RAYS] == 1


def test_hit_is_recomputed_in_float64():
    """On a tilted triangle the hit lies on its plane to 1e-15, which Embree's own float32 t cannot give."""
    corners = np.array([[-1.0, -1, 0.3], [1, -0.7, -0.2], [0.1, 1, 0.4]])
    scene = Scene(d.SceneDescription(shapes=(d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]])),)))
    stored = np.array([scene.placement.points(corner) for corner in corners])
    n = np.cross(stored[1] - stored[0], stored[2] - stored[0])
    n /= np.linalg.norm(n)
    rng = np.random.default_rng(7)
    for target in rng.dirichlet([2, 2, 2], 200) @ stored:
        origin = np.float32([0.3, 0.2, 1.0]).astype(float)
        direction = np.float32(target - origin).astype(float)
        found, p = hit_distance(scene.data, Vec3(*origin), Vec3(*direction))
        assert found
        assert abs((np.array(tuple(p)) - stored[0]) @ n) < 8 * 2.0**-53


def test_rays_are_aligned_for_embree():
    """Embree needs RTCRay at a multiple of 16 bytes; plain Python takes care of that as the compiler does."""
    from raylab.embree import _python_ray

    for _ in range(50):
        words = _python_ray(Vec3(0, 0, 0), Vec3(0, 0, 1), 0.0, 1.0)
        assert words.ctypes.data % 16 == 0
        assert words.nbytes == 96
        assert ctypes.c_uint32.from_address(words.ctypes.data + 36).value == 0xFFFFFFFF  # the mask
