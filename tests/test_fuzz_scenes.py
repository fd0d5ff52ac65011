"""Random scenes with planted extremes: each is refused in a sentence, or its picture is made of light and counted."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st
from patience import within
from strategies.families import FAMILIES, Family
from strategies.poison import spoilt

from raylab import description as d
from raylab.errors import UserError
from raylab.image import Image
from raylab.render import render
from raylab.scene import Scene

FEW, MANY = 30, int(os.environ.get("RAYLAB_FUZZED_SCENES", "20000"))
SOON = 30.0  # seconds: a thousand times what a scene takes, and once what a kernel takes to compile
SPP = 4
IN_TEST = FAMILIES[:1]  # whose kernel other tests compile as well


def fuzz(examples: int) -> Callable[[Any], Any]:
    """Few examples are the same ones in every run of `make test`; many are new ones each time."""
    return settings(
        max_examples=examples, deadline=None, database=None, print_blob=True, derandomize=examples <= 3 * FEW,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )  # fmt: skip


def rendered(family: Family, described: d.SceneDescription) -> Image | None:
    """The picture of a scene, or None where it is refused."""
    try:
        with within(SOON):
            scene = Scene(described)
            image = render(scene, family.shade, sampler=family.sampler, spp=SPP, seed=1, threads=1)
    except UserError as error:
        note(f"refused: {error}")
        return None
    note(f"warned: {scene.warnings}")
    return image


def is_light(image: Image) -> bool:
    """No NaN and nothing negative."""
    found = image.mean[image.samples > 0]
    return bool(np.isfinite(found).all() and (found >= 0.0).all())


def is_counted(image: Image) -> bool:
    """Each sample is in the mean or among the invalid ones, and where all are in it the error is a number."""
    errors = image.standard_error[image.samples == SPP]
    whole = image.samples.sum() + image.invalid_samples == SPP * image.samples.size
    return bool(whole and not np.isnan(errors).any())


@pytest.mark.parametrize("family", IN_TEST, ids=lambda family: family.name)
def test_a_random_scene_is_rendered_or_refused(family: Family) -> None:
    pictures = []

    @fuzz(FEW)
    @given(described=family.scenes)
    def one(described: d.SceneDescription) -> None:
        image = rendered(family, described)
        assert image is None or is_light(image)
        assert image is None or is_counted(image)
        pictures.append(image)

    one()
    assert any(image is not None for image in pictures)


@pytest.mark.certify
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_many_random_scenes_are_rendered_or_refused(family: Family) -> None:
    """20,000 scenes in all; at least a tenth of them are rendered."""
    done = []

    @fuzz(max(1, MANY // len(FAMILIES)))
    @given(described=family.scenes)
    def one(described: d.SceneDescription) -> None:
        image = rendered(family, described)
        assert image is None or is_light(image)
        assert image is None or is_counted(image)
        done.append(image is not None)

    one()
    print(f"{family.name}: {sum(done)} of {len(done)} scenes rendered, the others refused")
    assert sum(done) > len(done) / 10


@fuzz(3 * FEW)
@given(described=st.sampled_from(FAMILIES).flatmap(lambda family: spoilt(family.scenes)))
def test_what_is_no_number_is_refused(described: d.SceneDescription) -> None:
    with pytest.raises(UserError, match=r"\w"):
        Scene(described)


@pytest.mark.certify
@fuzz(MANY // 4)
@given(described=st.sampled_from(FAMILIES).flatmap(lambda family: spoilt(family.scenes)))
def test_whatever_is_no_number_is_refused(described: d.SceneDescription) -> None:
    with pytest.raises(UserError, match=r"\w"):
        Scene(described)
