"""A render that is killed at any moment goes on from its checkpoint, and ends with the same picture, bit by bit."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from test_render import room

from raylab import checkpoint as module
from raylab.checkpoint import Checkpoint, fingerprint
from raylab.errors import UserError
from raylab.render import render

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


def test_kill_9(tmp_path):
    """The command line, killed three times wherever it stands; then it ends, writes, and takes the checkpoint away."""
    kept, picture, whole = tmp_path / "kept.npz", tmp_path / "p.npz", tmp_path / "whole.npz"
    driver = "import raylab.checkpoint as c; c.INTERVAL = 0.05; import raylab.render as r; r.INTERVAL = 0.05; from raylab.cli import main; main()"  # noqa: E501
    command = [sys.executable, "-c", driver, "render", str(SCENE), "--spp", "256", "--seed", "3", "--no-progress"]

    def start(*more):
        return subprocess.Popen([*command, *map(str, more)], stdout=subprocess.DEVNULL)

    assert start("-o", whole).wait() == 0
    rng = np.random.default_rng()
    killed = 0
    for _ in range(3):
        running, size = start("-o", picture, "--checkpoint", kept), kept.stat().st_mtime_ns if kept.exists() else 0
        while running.poll() is None and (not kept.exists() or kept.stat().st_mtime_ns == size):
            time.sleep(0.01)
        time.sleep(rng.uniform(0.0, 0.2))
        os.kill(running.pid, signal.SIGKILL)
        killed += running.wait() == -signal.SIGKILL
    assert killed > 0
    assert start("-o", picture, "--checkpoint", kept).wait() == 0
    assert not kept.exists()
    with np.load(whole) as a, np.load(picture) as b:
        np.testing.assert_array_equal(a["mean"], b["mean"])
