"""The scene reader under a fuzzer: whatever stands in a file, it is a scene or a sentence, and soon."""

from __future__ import annotations

import os
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from mutated_files import REFERENCES, broken_file, fill
from mutated_meshes import broken_mesh
from patience import within

from raylab.description import SceneDescription
from raylab.errors import SceneError
from raylab.io.mitsuba_xml import read
from raylab.render import render
from raylab.scene import Scene

FEW, MANY = 150, int(os.environ.get("RAYLAB_FUZZED_FILES", "200000"))
ROUND = 5000  # examples that one search of hypothesis remembers
SOON = 5.0  # seconds: a hundred times what a file takes


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("files")
    fill(made)
    return made


def described(path: Path) -> SceneDescription | str:
    """What a file describes, or the sentence with which it is refused."""
    try:
        with within(SOON):
            return read(path)
    except SceneError as error:
        return str(error)


def built(description: SceneDescription) -> Scene | str:
    try:
        with within(SOON):
            return Scene(description)
    except SceneError as error:
        return str(error)


def is_sentence(refusal: Any, folder: Path | None = None) -> bool:
    """Words, not too many, that begin with the file."""
    return isinstance(refusal, str) and 0 < len(refusal) < 10_000 and refusal.startswith(str(folder or ""))


def fuzz(examples: int) -> Callable[[Any], Any]:
    """Few examples are the same ones in every run of `make test`; many are new ones each time."""
    return settings(
        max_examples=examples,
        derandomize=examples <= FEW,
        deadline=None,
        database=None,
        print_blob=True,
        suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
    )


def in_rounds(test: Callable[[], None], count: Counter[str]) -> None:
    """The test until it has had MANY files; then what was counted is printed, with the processor time."""
    begun = time.process_time()
    while count["files"] < MANY:
        test()
        print(dict(count), f"{time.process_time() - begun:.0f} s of processor time", flush=True)


@fuzz(FEW)
@given(data=broken_file)
def test_a_mutated_file_is_a_description_or_a_sentence(data: bytes, folder: Path) -> None:
    (folder / "test.xml").write_bytes(data)
    found = described(folder / "test.xml")
    assert isinstance(found, SceneDescription) or is_sentence(found, folder)


@pytest.fixture(scope="module")
def compiled() -> None:
    """What moves needs compiled code before it is rendered."""
    Scene(read(REFERENCES / "motion_blur/scene.xml"))


@pytest.mark.certify
def test_many_mutated_files_are_scenes_or_sentences(folder: Path, compiled: None) -> None:
    count: Counter[str] = Counter()

    @fuzz(min(MANY, ROUND))
    @given(data=broken_file)
    def one(data: bytes) -> None:
        (folder / "test.xml").write_bytes(data)
        found = described(folder / "test.xml")
        scene = built(found) if isinstance(found, SceneDescription) else found
        assert isinstance(scene, Scene) or is_sentence(scene, folder if scene is found else None)
        count["files"] += 1
        count["scenes"] += isinstance(scene, Scene)

    in_rounds(one, count)
    assert count["scenes"] > count["files"] / 100


# --- what stands in a mesh file ---

ROOM = """<scene version="3.0.0"><integrator type="direct"/>
<sensor type="perspective">
  <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="2"/><integer name="height" value="2"/><rfilter type="box"/></film>
</sensor>
<shape type="rectangle">
  <bsdf type="diffuse">
    <texture type="bitmap" name="reflectance"><string name="filename" value="board.png"/></texture>
  </bsdf>
</shape>
<shape type="rectangle">
  <transform name="to_world"><translate z="-4"/><rotate x="1" angle="180"/></transform>
  <emitter type="area"><rgb name="radiance" value="2"/></emitter>
</shape>
{mesh}
</scene>"""


def with_mesh(folder: Path, kind: str, shape: str, data: bytes) -> SceneDescription | str:
    """A scene with a shape from a mesh file."""
    (folder / f"mesh.{kind}").write_bytes(data)
    (folder / "test.xml").write_text(ROOM.format(mesh=shape))
    return described(folder / "test.xml")


@fuzz(FEW)
@given(mesh=broken_mesh)
def test_a_scene_with_a_mutated_mesh_is_a_description_or_a_sentence(mesh: Any, folder: Path) -> None:
    (kind, shape), data = mesh
    found = with_mesh(folder, kind, shape, data)
    assert isinstance(found, SceneDescription) or is_sentence(found, folder)


@pytest.mark.certify
def test_many_mutated_meshes_are_rendered_or_sentences(folder: Path) -> None:
    count: Counter[str] = Counter()

    @fuzz(min(MANY, ROUND))
    @given(mesh=broken_mesh)
    def one(mesh: Any) -> None:
        (kind, shape), data = mesh
        found = with_mesh(folder, kind, shape, data)
        scene = built(found) if isinstance(found, SceneDescription) else found
        assert isinstance(scene, Scene) or is_sentence(scene, folder if scene is found else None)
        count["files"] += 1
        if isinstance(scene, Scene):
            count["rendered"] += 1
            image = render(scene, "area", spp=2, seed=1, threads=1)
            assert np.isfinite(image.mean[image.samples > 0]).all()
            assert image.mean[image.samples > 0].min(initial=0.0) >= 0.0

    in_rounds(one, count)
    assert count["rendered"] > count["files"] / 20
