"""The scene reader under a fuzzer: whatever stands in a file, it is a scene or a sentence, and soon."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from mutated_files import REFERENCES, broken_file, fill
from patience import within

from raylab.description import SceneDescription
from raylab.errors import SceneError
from raylab.io.mitsuba_xml import read
from raylab.scene import Scene

FEW, MANY = 150, int(os.environ.get("RAYLAB_FUZZED_FILES", "200000"))
SOON = 5.0  # seconds: a hundred times what a file takes


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("files")
    fill(made)
    return made


def description(data: bytes, folder: Path) -> SceneDescription | None:
    """What a file with these bytes describes; None if it was refused in a sentence that names a file."""
    path = folder / "test.xml"
    path.write_bytes(data)
    try:
        with within(SOON):
            return read(path)
    except SceneError as error:
        message = str(error)
        assert message.startswith(str(folder)), message
        assert len(message) < 10_000
        return None


def fuzz(examples: int):
    """Few examples are the same ones in every run of `make test`; many are new ones each time."""
    return settings(
        max_examples=examples,
        derandomize=examples <= FEW,
        deadline=None,
        database=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
    )


@fuzz(FEW)
@given(data=broken_file)
def test_a_mutated_file_is_a_description_or_a_sentence(data: bytes, folder: Path) -> None:
    described = description(data, folder)
    assert described is None or isinstance(described, SceneDescription)


@pytest.fixture(scope="module")
def compiled() -> None:
    """What moves needs compiled code before it is rendered."""
    Scene(read(REFERENCES / "motion_blur/scene.xml"))


@pytest.mark.certify
@fuzz(MANY)
@given(data=broken_file)
def test_many_mutated_files_are_scenes_or_sentences(data: bytes, folder: Path, compiled: None) -> None:
    described = description(data, folder)
    if described is not None:
        with contextlib.suppress(SceneError), within(SOON):
            Scene(described)
