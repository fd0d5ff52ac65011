"""Slides "Motion blur": keyframes, the pose between them, and chords within their bound."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array, same_bits
from scenes import animation, moved, turned
from scipy.spatial.transform import Rotation

from raylab import keyframes
from raylab.pose import pose_at
from raylab.view import View

U24 = 2.0**-24
DAY = (0.0, 1.0)  # the shutter


# --- keyframes ---


def wild(seed, mirror=False):
    """Keyframes with rotation, translation, stretch and shear."""
    rng = np.random.default_rng(seed)
    matrices = []
    for _ in range(4):
        m = np.eye(4)
        m[:3, :3] = Rotation.random(rng=rng).as_matrix() @ (
            np.diag([-1.0 if mirror else 1.0, 1, 1]) + rng.normal(0, 0.2, (3, 3))
        )
        m[:3, 3] = rng.normal(size=3)
        matrices.append(m)
    return animation(*matrices, times=[-0.2, 0.3, 0.45, 0.8])


@pytest.mark.parametrize("mirror", [False, True])
def test_a_keyframe_is_translation_rotation_and_stretch(mirror):
    for m in wild(1, mirror).matrices:
        t, r, s = keyframes.decompose(m)
        assert np.abs(r @ s - m[:3, :3]).max() <= 32 * U53
        assert np.abs(r @ r.T - np.eye(3)).max() <= 32 * U53
        assert np.linalg.det(r) > 0
        assert np.abs(s - s.T).max() <= 32 * U53
        assert np.array_equal(t, m[:3, 3])


@pytest.mark.parametrize(("degrees", "half"), [(90, 45), (179, 89.5), (-120, -60), (270, -45), (1e-6, 5e-7)])
def test_rotation_takes_the_shorter_way_at_constant_speed(degrees, half):
    """E09 too: an angle of 1e-8 is not lost, though its cosine is 1."""
    m = keyframes.matrix_at(animation(turned(0), turned(degrees)), 0.5)
    assert math.degrees(math.atan2(m[1, 0], m[0, 0])) == pytest.approx(half, rel=1e-8)


def test_outside_its_keyframes_a_shape_stands_still():
    """E08: Embree alone would extrapolate."""
    motion = wild(2)
    assert same_bits(keyframes.matrix_at(motion, -9.0).ravel(), motion.matrices[0].ravel())
    assert same_bits(keyframes.matrix_at(motion, 9.0).ravel(), motion.matrices[-1].ravel())
    for time, m in zip(motion.times, motion.matrices, strict=True):
        assert same_bits(keyframes.matrix_at(motion, time).ravel(), m.ravel())


@pytest.mark.parametrize("mirror", [False, True])
def test_pose_is_the_matrix_at_that_time(mirror):
    """What kernels evaluate, piece by piece, against the whole motion; with a local map and a placement."""
    motion, local = wild(3, mirror), turned(20, (0, 1, 0), (0.3, 0.1, 0.2), (0.5, 2, 1))
    rows = View(keyframes.table(motion, (-0.5, 1.5), local, np.array([1.0, 2, 3]), 0.25))
    for u in np.linspace(0, 1, 41):
        pose = pose_at(rows, 0, len(rows), u)
        want = keyframes.matrix_at(motion, -0.5 + 2 * u) @ local
        got = np.stack([array(pose.x), array(pose.y), array(pose.z)], axis=1)
        assert np.abs(got - want[:3, :3] * 0.25).max() <= 256 * U53
        assert np.abs(array(pose.p) - (want[:3, 3] - [1, 2, 3]) * 0.25).max() <= 256 * U53
        assert np.abs(np.array([[*row] for row in pose.inverse_rows()]) @ got - np.eye(3)).max() <= 1e-12


# --- chords ---


def deviation(motion, points, segments):
    """How far chords stand off the path: at 33 times in each part."""
    ends = keyframes.samples(motion, DAY, segments)
    worst = 0.0
    for k in range(segments):
        for s in np.linspace(0, 1, 33):
            exact = keyframes.matrix_at(motion, (k + s) / segments)
            chord = ends[k] + s * (ends[k + 1] - ends[k])
            off = points @ (chord - exact)[:3, :3].T + (chord - exact)[:3, 3]
            worst = max(worst, float(np.linalg.norm(off, axis=1).max()))
    return worst


POINTS = np.array([[1.0, 0, 0], [0, 0.5, 0.2], [-0.7, 0.1, -0.4]])


@pytest.mark.parametrize("segments", [1, 2, 4, 16])
@pytest.mark.parametrize("seed", [4, 5])
def test_chords_stay_within_their_bound(segments, seed):
    motion = wild(seed)
    assert deviation(motion, POINTS, segments) <= keyframes.chord_error(motion, DAY, POINTS, segments)


def test_the_bound_of_a_rotation_is_r_dtheta_squared_over_8():
    """The sagitta r (1 - cos(dtheta / 2)) = r dtheta^2 / 8 - ...: the bound is sharp, and of order 2."""
    motion = animation(turned(0), turned(90))
    for n in (4, 16):
        step = math.radians(90) / n
        assert keyframes.chord_error(motion, DAY, POINTS, n) == pytest.approx(step**2 / 8, rel=1e-9)  # r = 1
        assert deviation(motion, POINTS, n) == pytest.approx(1 - math.cos(step / 2), rel=1e-9)


def test_straight_motion_needs_one_part_and_is_exact():
    straight = animation(moved(0, 0, 0), moved(3, 1, 2, 2, 2, 2))
    assert keyframes.segments_needed(straight, DAY, POINTS) == (1, 0.0)
    bent = animation(moved(0, 0, 0), moved(3, 1, 2), moved(0, 0, 0))  # a keyframe on a time step costs nothing
    assert keyframes.segments_needed(bent, DAY, POINTS) == (2, 0.0)
