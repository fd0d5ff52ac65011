"""A render that was given a time ends within 2 % of it, whatever the machine does, and looks at the clock alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scenes import lamp, room

from raylab import checkpoint, schedule
from raylab.render import render
from raylab.run import Run
from raylab.scene import Scene

TIME, ROWS = 10.0, 16


class Machine:
    """A clock that goes on only while samples are taken; `speed(t)` of them, of the whole picture, in a second."""

    def __init__(self, speed) -> None:
        self.now, self.speed = 0.0, speed
        self.counts = np.zeros(ROWS)  # samples of each stream, by row

    def patch(self, monkeypatch) -> None:
        take = Run.band

        def band(run, rows, samples):
            n = samples[1] - samples[0]
            self.counts[slice(*rows)] += n
            self.now += (rows[1] - rows[0]) / ROWS * n / self.speed(self.now)
            return take(run, rows, samples)

        monkeypatch.setattr(schedule, "clock", lambda: self.now)
        monkeypatch.setattr(Run, "band", band)


def steady(per_second):
    return lambda t: per_second


def slower(after):
    """By other work: four times slower from some time on."""
    return lambda per_second: lambda t: per_second * (0.25 if t > after else 1.0)


def uneven(per_second):
    """Another speed from one work item to the next."""
    rng = np.random.default_rng(1)
    return lambda t: per_second * rng.uniform(0.25, 1.0)


@pytest.mark.parametrize("per_second", [2.0, 2.3, 20.0, 300.0])
@pytest.mark.parametrize(
    "speed",
    [steady, uneven, *map(slower, (2.0, 3.0, 4.0, 7.0, 9.5))],
    ids=["steady", "uneven", *(f"slower after {t} s" for t in (2, 3, 4, 7, 9.5))],
)
def test_seconds_are_kept(monkeypatch, per_second, speed):
    """Overshoot is less than 2 % or a row, which is not divided; each pixel says how many samples it has."""
    machine = Machine(speed(per_second))
    machine.patch(monkeypatch)
    image = render(room(ROWS), "area", sampler="independent", seconds=TIME, threads=1)
    row = 1.0 / ROWS / (0.25 * per_second)
    assert image.report["seconds"]["render"] == machine.now
    assert TIME <= machine.now <= TIME + max(0.02 * TIME, row)
    np.testing.assert_array_equal(image.samples, np.repeat(machine.counts[:, None], ROWS, 1) * image.report["streams"])
    assert image.complete


def test_rows_differ_by_one_sample_where_the_speed_is_steady(monkeypatch):
    machine = Machine(steady(77.0))
    machine.patch(monkeypatch)
    image = render(room(ROWS), "area", sampler="independent", seconds=TIME, threads=1)
    assert np.ptp(image.samples) <= 1
    assert 77 * TIME <= image.samples.max() <= 1.02 * 77 * TIME


def test_every_pixel_has_a_sample_of_each_stream_however_short_the_time(monkeypatch):
    machine = Machine(steady(0.01))
    machine.patch(monkeypatch)
    image = render(room(ROWS), "area", sampler="sobol", seconds=TIME, threads=1)
    assert (machine.counts == 1).all()
    assert np.isfinite(image.standard_error).all()


def test_values_do_not_change_how_many_samples_there_are(monkeypatch):
    counts = []
    for radiance in (0.0, 8.0, 8e12):
        machine = Machine(steady(33.0))
        with monkeypatch.context() as patch:
            machine.patch(patch)
            described = room(ROWS).description
            bright = Scene(replace(described, shapes=(*described.shapes[:2], lamp(radiance=radiance or 1e-300))))
            counts.append(render(bright, "area", sampler="independent", seconds=TIME, threads=1).samples)
    np.testing.assert_array_equal(counts[0], counts[1])
    np.testing.assert_array_equal(counts[0], counts[2])


class StoppedError(Exception):
    pass


def killed_after(seconds, machine):
    """A progress callback that ends the render, as a kill would."""

    def progress(_):
        if machine.now > seconds:
            raise StoppedError

    return progress


def test_the_time_goes_on_after_a_kill(monkeypatch, tmp_path):
    """The seconds of both parts add up to those asked; every sample is there once: as without a stop, bit by bit."""
    monkeypatch.setattr(checkpoint.Checkpoint, "due", lambda self, left: True)
    pictures, kept = [], tmp_path / "kept.npz"
    for stops in (0, 3):
        machine = Machine(steady(16.0))
        with monkeypatch.context() as patch:
            machine.patch(patch)
            for stop in range(stops):
                with pytest.raises(StoppedError):
                    render(room(ROWS), "area", sampler="independent", seconds=TIME, checkpoint=kept, threads=1,
                           progress=killed_after(3.0 * (stop + 1), machine))  # fmt: skip
            image = render(room(ROWS), "area", sampler="independent", seconds=TIME, threads=1,
                           checkpoint=kept if stops else None)  # fmt: skip
        assert TIME <= image.report["seconds"]["render"] <= 1.02 * TIME
        pictures.append(image)
    whole = render(room(ROWS), "area", sampler="independent", spp=int(pictures[0].samples.min()))
    for image in pictures:
        common = image.samples == whole.samples
        assert common.any()
        np.testing.assert_array_equal(image.mean[common], whole.mean[common])


@pytest.mark.certify
@pytest.mark.parametrize("seconds", [1.0, 3.0])
def test_seconds_are_kept_on_this_machine(seconds):
    """By the wall clock; fails where other work keeps the processors for longer than 2 % of the time."""
    image = render(room(128), "area", seconds=seconds)
    assert seconds <= image.report["seconds"]["render"] <= 1.02 * seconds
