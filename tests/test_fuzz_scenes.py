"""Random scenes with planted extremes: each is refused in a sentence, or its picture is made of light and counted."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st
from patience import within
from strategies import FAMILIES, MAY_BE_INFINITE, NOT_READ, Family, leaves, poisoned

from raylab import description as d
from raylab.errors import UserError
from raylab.render import render
from raylab.scene import Scene

FEW, MANY = 30, int(os.environ.get("RAYLAB_FUZZED_SCENES", "20000"))
SOON = 30.0  # seconds: a thousand times what a scene takes, and once what a kernel takes to compile
SPP = 4
IN_TEST = FAMILIES[:1]  # whose kernel other tests compile as well


def fuzz(examples: int):
    """Few examples are the same ones in every run of `make test`; many are new ones each time."""
    return settings(
        max_examples=examples, deadline=None, database=None, print_blob=True, derandomize=examples <= 3 * FEW,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )  # fmt: skip


def rendered(family: Family, described: d.SceneDescription) -> bool:
    """Whether there is a picture; it holds no NaN and nothing negative, and says what it left out."""
    try:
        with within(SOON):
            scene = Scene(described)
            image = render(scene, family.shade, sampler=family.sampler, spp=SPP, seed=1, threads=1)
    except UserError as error:
        note(f"refused: {error}")
        return False
    note(f"warned: {scene.warnings}")
    assert np.isfinite(image.mean[image.samples > 0]).all()
    assert (image.mean[image.samples > 0] >= 0.0).all()
    assert not np.isnan(image.standard_error[image.samples == SPP]).any()
    assert image.samples.sum() + image.invalid_samples == SPP * image.samples.size
    return True


def counted(family: Family, examples: int) -> list[bool]:
    """Which of so many scenes of a family were rendered."""
    done: list[bool] = []

    @fuzz(examples)
    @given(described=family.scenes)
    def one(described: d.SceneDescription) -> None:
        done.append(rendered(family, described))

    one()
    return done


@pytest.mark.parametrize("family", IN_TEST, ids=lambda family: family.name)
def test_a_random_scene_is_rendered_or_refused(family: Family) -> None:
    assert any(counted(family, FEW))


@pytest.mark.certify
@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_many_random_scenes_are_rendered_or_refused(family: Family) -> None:
    """20,000 scenes in all; at least a tenth of them are rendered."""
    done = counted(family, max(1, MANY // len(FAMILIES)))
    print(f"{family.name}: {sum(done)} of {len(done)} scenes rendered, the others refused")
    assert sum(done) > len(done) / 10


def refused(described: d.SceneDescription, data: st.DataObject, bad: float) -> None:
    """With `bad` for one of its numbers, the scene is refused."""
    found = [path for path in leaves(described) if path[-1] not in NOT_READ]
    path = data.draw(st.sampled_from(found))
    if path[-1] in MAY_BE_INFINITE and bad > 0.0:
        return
    broken = poisoned(described, path, data.draw(st.integers(0, 15)), bad)
    with pytest.raises(UserError) as caught:
        Scene(broken)
    assert str(caught.value)


no_number = st.sampled_from((np.nan, np.inf, -np.inf))


@fuzz(3 * FEW)
@given(family=st.sampled_from(FAMILIES), data=st.data(), bad=no_number)
def test_what_is_no_number_is_refused(family: Family, data: st.DataObject, bad: float) -> None:
    refused(data.draw(family.scenes), data, bad)


@pytest.mark.certify
@fuzz(MANY // 4)
@given(family=st.sampled_from(FAMILIES), data=st.data(), bad=no_number)
def test_whatever_is_no_number_is_refused(family: Family, data: st.DataObject, bad: float) -> None:
    refused(data.draw(family.scenes), data, bad)
