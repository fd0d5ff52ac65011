"""How a mistake is found in the light of a point: samples of shade(), and what the harness says of them."""

from __future__ import annotations

import secrets

import numpy as np

from mutants.trial import ERROR, Trial, affine, frame
from raylab import description as d
from raylab.jit import njit
from raylab.point import facet_point
from raylab.samplers import Independent, new_counter
from raylab.scene import Scene
from raylab.stats import Verdict, mean_is, variance_is
from raylab.strategies import strategy
from raylab.surface import FRONT
from raylab.vec3 import Vec3
from raylab.view import View

ALPHA, DELTA = 3.3e-9, 0.01


@njit
def fill(scene, strategy, place, sampler, first, out):
    """shade() at x, once for each row of `out`; `place` holds p, n, slack, tilt and V."""
    p, n, slack, tilt, V = place
    x = facet_point(p, n, slack, tilt)
    brdf = scene.materials.at(scene.shapes[0, FRONT], n, (0.5, 0.5))
    for i in range(len(out)):
        rng = sampler.stream(0, 0, first + i)
        scene.motion.set(scene.motion.draw(rng))
        value = strategy.shade(x, V, brdf, n, scene, rng)
        out[i, 0], out[i, 1], out[i, 2] = value.x, value.y, value.z


def scene_of(trial: Trial) -> Scene:
    """The receiver is the first shape, 0.01 wide."""
    turned = affine(frame(trial.n).T @ np.diag([0.01, 0.01, 1.0]), (0, 0, 0))
    receiver = d.Rectangle(to_world=turned, front=trial.material)
    return Scene(
        d.SceneDescription(
            camera=d.Camera(shutter_open=0.0, shutter_close=1.0), shapes=(receiver, *trial.shapes),
            lights=trial.lights, environment=trial.environment,
        )
    )  # fmt: skip


class Draws:
    """draws(n) -> n samples of a trial's shade(), relative to its truth; the seed is fresh, or that of a replay."""

    def __init__(self, trial: Trial, seed: int | None = None) -> None:
        self.trial, self.scene = trial, scene_of(trial)
        self.strategy = strategy(trial.shade, self.scene)
        self.sampler = Independent(secrets.randbits(62) if seed is None else seed, new_counter())
        self.taken = 0
        row = np.array([self.scene.data.planes[0, j] for j in range(8)])
        p, n = self.scene.placement.points(np.zeros((1, 3)))[0].astype(float), row[:3]
        p = p - n * (n @ p - row[3])
        V = n if trial.view is None else np.asarray(trial.view, float)
        self.place = (Vec3(*p), Vec3(*n), float(row[4]), Vec3(*row[5:]), Vec3(*V))

    def raw(self, n: int) -> np.ndarray:
        """(n, 3) radiances."""
        out = np.empty((n, 3))
        fill(self.scene.data, self.strategy, self.place, self.sampler, self.taken, View(out))
        self.taken += n
        return out

    def __call__(self, n: int) -> np.ndarray:
        values = self.raw(n)
        worst = values.min(axis=1)
        # negative light in one channel is not averaged away
        return np.where(worst < 0.0, worst, (values / self.trial.truth).mean(axis=1))


def check_mean(trial: Trial, draws: Draws, cap: int) -> Verdict:
    return mean_is("mean", draws, 1.0, high=trial.high, truth_error=ERROR, delta=DELTA, alpha=ALPHA, cap=cap)


def check_variance(trial: Trial, draws: Draws, cap: int) -> Verdict:
    assert trial.variance is not None
    return variance_is("variance", draws, trial.variance, high=trial.high, alpha=ALPHA, cap=cap)


def growth(values: np.ndarray, high: float) -> float:
    """Largest mean log growth of a bet against the mean 1 (within ERROR) that these observations allow: Kelly's."""
    best = 0.0
    for mean, largest in ((1.0 + ERROR, 1.0 / (1.0 + ERROR)), (1.0 - ERROR, -1.0 / (high - 1.0 + ERROR))):
        for size in 0.9 * 2.0 ** -np.arange(0.0, 14.0, 0.25):
            best = max(best, float(np.log1p(size * largest * (values - mean)).mean()))
    return best
