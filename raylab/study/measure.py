"""The experiment: each estimator at each number of samples, repeated, interleaved, timed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import samplers as all_samplers
from raylab.errors import UserError
from raylab.image import Image
from raylab.render import default_threads, render
from raylab.scene import Scene
from raylab.stats.intervals import crowding
from raylab.strategies import BUILT_IN, strategy
from raylab.study import truth as truths
from raylab.study.results import Estimator, Row, Study
from raylab.study.truth import Truth
from raylab.study.watch import watch

LIGHTS = ("area lights", "point lights", "directional lights", "environment")
REFERENCE = 1 << 20  # spawn key of the reference's seed: no estimator has this number
Step = Callable[[int, int, str], None]


def study(
    scene: Scene,
    shades: Sequence[str | Callable[..., Any]],
    *,
    samplers: Sequence[str] = ("independent",),
    spp: Sequence[int] = (1, 4, 16, 64, 256),
    repeats: int = 20,
    seed: int = 0,
    threads: int | None = None,
    truth: Truth | None = None,
    progress: Step | None = None,
) -> Study:
    """Measure every shade with every sampler at every number of samples, `repeats` times with different seeds.

    One block is one repeat of all estimators; their order is reversed in every other block (ABBA), so that a slow
    spell of the machine meets all of them. Compilation comes before and is not in the times. `truth`, such as
    `find_truth(scene)`, is what errors are measured against; without one that fits, a reference is rendered first.
    Ctrl-C keeps the measurements so far.

    Raises UserError for names that do not exist or estimators that compute different things.
    """
    estimators = [_estimator(scene, shade, sampler) for shade in shades for sampler in samplers]
    levels = _check(estimators, spp, repeats)
    whole = _same_light(scene, estimators)
    threads = default_threads() if threads is None else threads
    step = progress or (lambda done, total, what: None)
    result = Study.empty(scene, estimators, levels, repeats, seed, threads)
    try:
        for e in estimators:
            step(0, 1, f"compiling {e.label}")
            result.compile_seconds[e] = _render(result, e, 1, _seed(seed, REFERENCE, 1, 0)).report["seconds"]["compile"]
        for e in estimators:
            step(0, 1, f"watching {e.label}")
            _watch(result, e)
        result.truth = truth if whole or not (truth and truth.all_light) else None
        if result.truth is None:
            result.truth = _reference(result, whole, step)
        total, done = sum(levels) * repeats * len(estimators), 0
        for level, n in enumerate(levels):
            done = _measure(result, level, n, done, total, step)
    except KeyboardInterrupt:
        result.complete = False
    return result


def _estimator(scene: Scene, shade: str | Callable[..., Any], sampler: str) -> Estimator:
    strategy(shade, scene)
    if sampler not in all_samplers.NAMES:
        raise UserError(f"unknown sampler {sampler!r}; expected one of {', '.join(all_samplers.NAMES)}")
    return Estimator(shade, sampler)


def _check(estimators: list[Estimator], spp: Sequence[int], repeats: int) -> list[int]:
    if not estimators:
        raise UserError("expected at least one shade and one sampler")
    if len(set(estimators)) < len(estimators):
        raise UserError(f"expected different estimators, got {', '.join(e.label for e in estimators)}")
    if not spp or any(n < 1 for n in spp):
        raise UserError(f"spp: expected one or more positive numbers of samples, got {list(spp)}")
    if repeats < 2:
        raise UserError(f"repeats must be at least 2, got {repeats}")
    return sorted(set(spp))


def _same_light(scene: Scene, estimators: list[Estimator]) -> bool:
    """Whether the estimators compute all the light of the scene; UserError if they compute different light."""
    present = frozenset(LIGHTS) & scene.features
    kinds = {e: _kinds(e) & present for e in estimators}
    if len(set(kinds.values())) > 1:
        said = "; ".join(f"{e.label}: {', '.join(sorted(k))}" for e, k in kinds.items())
        raise UserError(f"these estimators compute different light, so their errors cannot be compared ({said})")
    return next(iter(kinds.values())) == present


def _kinds(estimator: Estimator) -> frozenset[str]:
    needs = BUILT_IN[estimator.shade][1] if isinstance(estimator.shade, str) else ""
    return frozenset(needs.split(" or ") if needs else LIGHTS)


def _seed(seed: int, *key: int) -> int:
    """A seed for one render, unrelated to those of all other keys."""
    return int(np.random.SeedSequence(seed, spawn_key=key).generate_state(1, np.uint64)[0] >> np.uint64(1))


def _render(result: Study, estimator: Estimator, spp: int, seed: int) -> Image:
    image = render(result.scene, estimator.shade, sampler=estimator.sampler, spp=spp, seed=seed, threads=result.threads)
    if not image.complete:
        raise KeyboardInterrupt
    return image


def _watch(result: Study, e: Estimator) -> bool:
    """Whether the estimator has a variance; if not, the result knows why."""
    seeds = _seed(result.seed, REFERENCE, 2, 0), _seed(result.seed, REFERENCE, 2, 1)
    if e not in result.infinite:
        result.infinite[e] = watch(result.scene, e.shade, e.sampler, seeds, result.threads)
    return not result.infinite[e]


def _reference(result: Study, whole: bool, step: Step) -> Truth:
    """A reference by `direct`, if it has a variance, or by the first estimator that has."""
    spp = max(256, 8 * max(result.levels))
    step(0, 1, f"rendering a reference with {spp} samples per pixel")
    direct = [Estimator("direct", "sobol")] if whole else []
    candidates = [*direct, *result.estimators]
    chosen = next((e for e in candidates if _watch(result, e)), candidates[0])
    result.reference_doubt = result.infinite[chosen]
    return truths.compute(result.scene, chosen.shade, spp, _seed(result.seed, REFERENCE), result.threads)


def _measure(result: Study, level: int, n: int, done: int, total: int, step: Step) -> int:
    """All blocks of one number of samples; whatever was measured goes into the result, also after Ctrl-C."""
    assert result.truth is not None
    vectors: dict[Estimator, list[npt.NDArray[np.float32]]] = {e: [] for e in result.estimators}
    rows: list[Row] = []
    try:
        for repeat in range(result.repeats):
            numbered = list(enumerate(result.estimators))
            for place, (number, e) in enumerate(numbered if repeat % 2 == 0 else numbered[::-1]):
                step(done, total, f"{e.label}, {n} samples, repeat {repeat + 1}")
                seed = _seed(result.seed, number, level, repeat)
                image = _render(result, e, n, seed)
                vector = result.truth.quantity(image)
                rows.append(_row(e, n, repeat, place, seed, image, vector, result.truth))
                vectors[e].append(vector.astype(np.float32))
                done += n
        step(done, total, "")
    finally:
        _close_level(result, n, rows, vectors)
    return done


def _row(
    e: Estimator,
    n: int,
    repeat: int,
    place: int,
    seed: int,
    image: Image,
    vector: npt.NDArray[np.float64],
    truth: Truth,
) -> Row:
    error = float(np.mean((vector - truth.value.ravel()) ** 2))
    red, green, blue = (float(m) for m in image.image_mean)
    rays, seconds = image.report["rays"], image.report["seconds"]["render"]
    return Row(
        e.label, e.name, e.sampler, n, repeat, place, seed, seconds, error, float("nan"), red, green, blue,
        rays["camera"], rays["shadow"], image.invalid_samples,
    )  # fmt: skip


def _close_level(
    result: Study, n: int, rows: list[Row], vectors: dict[Estimator, list[npt.NDArray[np.float32]]]
) -> None:
    """Each repeat's squared deviation from the mean of all repeats, R / (R - 1) |v_r - mean|^2 / size.

    Its mean over the repeats is the unbiased sample variance, averaged over the pixels and channels.
    """
    for e, all_of_e in vectors.items():
        own = [row for row in rows if row.estimator == e.label]
        repeats = len(all_of_e)
        if repeats > 1:
            mean = np.mean(all_of_e, axis=0, dtype=np.float64)
            spread = np.zeros_like(mean)
            for row, vector in zip(own, all_of_e, strict=True):
                squares = (vector - mean) ** 2 * (repeats / (repeats - 1.0))
                row.deviation = float(np.mean(squares))
                spread += squares
            result.crowding[e, n] = crowding(spread.reshape(-1, 3).sum(axis=1))
    result.rows += rows
