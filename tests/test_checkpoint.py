"""A render that is killed at any moment goes on from its checkpoint, and ends with the same picture, bit by bit."""

from __future__ import annotations

import errno
import json
import math
import os
import resource
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from test_cli import SCENE as SMALL
from test_render import room

from raylab import checkpoint as module
from raylab import schedule
from raylab.checkpoint import Checkpoint, fingerprint
from raylab.errors import InvalidSampleError, UserError
from raylab.render import render
from raylab.vec3 import Vec3

SCENE = Path(__file__).parents[1] / "reference_scenes" / "soft_shadows" / "scene.xml"


class StoppedError(Exception):
    pass


def stopping_after(n):
    """A progress callback that ends the render in its n-th call, as a kill would."""
    seen = []

    def progress(state):
        seen.append(state)
        if len(seen) == n:
            raise StoppedError

    return progress


@pytest.fixture
def always(monkeypatch):
    """Every pass is kept, and is short."""
    monkeypatch.setattr(module.Checkpoint, "due", lambda self, left: True)


@pytest.mark.parametrize("how", [{"spp": 256}, {"relative_error": 0.01}], ids=str)
@pytest.mark.parametrize("sampler", ["sobol", "independent", "stratified"])
def test_a_stopped_render_ends_with_the_same_picture(how, sampler, tmp_path, always):
    scene, path = room(16), tmp_path / "kept.npz"
    whole = render(scene, "area", sampler=sampler, seed=5, **how)
    for _ in range(3):  # each gets a pass further
        with pytest.raises(StoppedError):
            render(scene, "area", sampler=sampler, seed=5, checkpoint=path, progress=stopping_after(2), **how)
    again = render(scene, "area", sampler=sampler, seed=5, checkpoint=path, **how)
    for name in ("mean", "standard_error", "samples"):
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))
    assert again.report["rays"] == whole.report["rays"]


def test_ctrl_c_keeps_the_checkpoint_beside_the_picture(tmp_path, always):
    scene, path = room(16), tmp_path / "kept.npz"
    whole = render(scene, "area", sampler="sobol", relative_error=0.01)

    def interrupted(state):
        if state.done > 64:
            raise KeyboardInterrupt

    part = render(scene, "area", sampler="sobol", relative_error=0.01, checkpoint=path, progress=interrupted)
    assert not part.complete
    assert 0 < part.samples.min() < whole.samples.min()
    again = render(scene, "area", sampler="sobol", relative_error=0.01, checkpoint=path)
    assert again.complete
    np.testing.assert_array_equal(again.mean, whole.mean)


def test_a_finished_render_is_not_done_again(tmp_path):
    path, calls = tmp_path / "kept.npz", []
    first = render(room(8), "area", spp=16, checkpoint=path)
    second = render(room(8), "area", spp=16, checkpoint=path, progress=calls.append)
    np.testing.assert_array_equal(first.mean, second.mean)
    assert calls == []


@pytest.mark.parametrize("other", [{"seed": 1}, {"spp": 32}, {"sampler": "sobol"}, {"shade": "direct"}], ids=str)
def test_the_checkpoint_of_another_render_is_refused(other, tmp_path):
    path, own = tmp_path / "kept.npz", {"shade": "area", "sampler": "independent", "spp": 16, "seed": 0}
    render(room(8), **own, checkpoint=path)
    before = path.read_bytes()
    with pytest.raises(UserError, match=r"kept.npz is the checkpoint of another render"):
        render(room(8), **(own | other), checkpoint=path)
    assert path.read_bytes() == before


def test_another_scene_is_another_render():
    assert fingerprint(room(8).description) == fingerprint(room(8).description)
    assert fingerprint(room(8).description) != fingerprint(room(9).description)


@pytest.mark.parametrize("content", [b"", b"text", b"PK\x03\x04 half of an archive"])
def test_a_file_that_is_no_checkpoint_is_refused_and_kept(content, tmp_path):
    path = tmp_path / "notes.npz"
    path.write_bytes(content)
    with pytest.raises(UserError, match=r"notes.npz cannot be read as a checkpoint"):
        Checkpoint(path, 1).load()
    assert path.read_bytes() == content


@contextmanager
def disk_with_room_for(size):
    """No file may grow beyond so many bytes: writing more fails as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_where_nothing_can_be_written_no_sample_is_taken(tmp_path, monkeypatch):
    calls, scene = [], room(8)
    with pytest.raises(UserError, match=r'cannot write ".*none/kept.npz": No such file or directory'):
        render(scene, "area", spp=16, checkpoint=tmp_path / "none" / "kept.npz", progress=calls.append)
    with (
        disk_with_room_for(1000),
        pytest.raises(UserError, match=r'cannot write ".*kept.npz": File too large'),
    ):
        render(scene, "area", spp=16, checkpoint=tmp_path / "kept.npz", progress=calls.append)

    def refused(*_, **__):
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(Path, "touch", refused)  # what a folder says to those who may only read it, root may write
    with pytest.raises(UserError, match=r'cannot write ".*kept.npz": Permission denied'):
        render(scene, "area", spp=16, checkpoint=tmp_path / "kept.npz", progress=calls.append)
    assert calls == []
    assert list(tmp_path.iterdir()) == []


def test_when_the_disk_is_full_the_last_checkpoint_stays(tmp_path, always, monkeypatch):
    monkeypatch.setattr(schedule, "SHORT", 1e-9)  # passes end at 16, 32, 64, ...
    scene, path, seen = room(16), tmp_path / "kept.npz", []
    whole = render(scene, "area", spp=256)

    def fills_up(state):
        seen.append((state.done, path.stat().st_mtime_ns))
        if state.done > 64:
            resource.setrlimit(resource.RLIMIT_FSIZE, (1000, resource.RLIM_INFINITY))

    with disk_with_room_for(resource.RLIM_INFINITY), pytest.raises(UserError, match="File too large"):
        render(scene, "area", spp=256, checkpoint=path, progress=fills_up)
    assert 64 < seen[-1][0] < 256
    assert path.stat().st_mtime_ns == seen[-1][1]
    assert list(tmp_path.iterdir()) == [path]
    np.testing.assert_array_equal(render(scene, "area", spp=256, checkpoint=path).mean, whole.mean)


def test_a_picture_that_cannot_be_written_is_kept(tmp_path, run):
    """The same command writes it later, without a new sample."""
    scene, kept, picture = tmp_path / "scene.xml", tmp_path / "kept.npz", tmp_path / "picture.npz"
    scene.write_text(SMALL)
    whole = tmp_path / "whole.npz"
    assert run("render", scene, "-o", whole).code == 0
    with disk_with_room_for(whole.stat().st_size - 200):  # of so few pixels the checkpoint is smaller
        done = run("render", scene, "-o", picture, "--checkpoint", kept)
    assert (done.code, done.stdout) == (2, "")
    assert done.stderr == f'raylab: error: cannot write "{picture}": File too large\n'
    assert not picture.exists()
    again = json.loads(run("render", scene, "-o", picture, "--checkpoint", kept, "--json").stdout)
    assert not kept.exists()
    with np.load(whole) as a, np.load(picture) as b:
        np.testing.assert_array_equal(a["mean"], b["mean"])
    assert again["complete"]


def test_a_strict_render_finds_the_same_sample_after_a_kill(tmp_path, always, monkeypatch):
    """One of 50,000 is not finite; passes end at powers of two, of which the first two are kept."""

    def shade(x, V, brdf, N, scene, rng):
        return Vec3(math.nan if rng.number() < 2e-5 else 1.0, 1.0, 1.0)

    monkeypatch.setattr(schedule, "SHORT", 1e-9)
    scene, path, how = room(8), tmp_path / "kept.npz", {"spp": 1 << 16, "seed": 7, "strict": True, "band_rows": 8}
    with pytest.raises(InvalidSampleError) as whole:
        render(scene, shade, **how)
    with pytest.raises(StoppedError):
        render(scene, shade, checkpoint=path, progress=stopping_after(3), **how)
    for _ in range(2):  # a sample that is not finite is never kept
        with pytest.raises(InvalidSampleError) as again:
            render(scene, shade, checkpoint=path, **how)
        assert str(again.value) == str(whole.value)


def test_kill_9(tmp_path):
    """The command line, killed three times wherever it stands; then it ends, writes, and takes the checkpoint away."""
    kept, picture, whole = tmp_path / "kept.npz", tmp_path / "p.npz", tmp_path / "whole.npz"
    driver = "from raylab.checkpoint import Checkpoint as C; C.interval = 0.05; from raylab.cli import main; main()"
    command = [sys.executable, "-c", driver, "render", str(SCENE), "-D", "width=96", "-D", "height=72",
               "--spp", "2048", "--seed", "3", "--no-progress"]  # fmt: skip

    def start(*more):
        return subprocess.Popen([*command, *map(str, more)], stdout=subprocess.DEVNULL)

    def stamp():
        return kept.stat().st_mtime_ns if kept.exists() else None

    assert start("-o", whole).wait() == 0
    rng = np.random.default_rng()
    killed = 0
    for _ in range(3):
        running, stamps = start("-o", picture, "--checkpoint", kept), {stamp()}
        while running.poll() is None and len(stamps) < 3:
            time.sleep(0.002)
            stamps.add(stamp())  # written at the beginning, and then after a pass
        time.sleep(rng.uniform(0.0, 0.2))
        os.kill(running.pid, signal.SIGKILL)
        killed += running.wait() == -signal.SIGKILL
    assert killed > 0
    assert start("-o", picture, "--checkpoint", kept).wait() == 0
    assert not kept.exists()
    with np.load(whole) as a, np.load(picture) as b:
        np.testing.assert_array_equal(a["mean"], b["mean"])
