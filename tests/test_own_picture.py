"""raylab render --shade FILE: a student's picture beside the reference; is the difference noise?

Synthetic pictures have noise of a known distribution. False alarms: ALPHA = 1e-6 for each right picture.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

import raylab
from raylab.errors import UserError
from raylab.grading import goal, own, which
from raylab.grading.assignment import NAMES, load
from raylab.grading.begin import stub_of
from raylab.grading.own import Own
from raylab.grading.which import candidates, choose
from raylab.image import Image
from raylab.study.compare import Comparison, Reference, side_of, tile_errors
from raylab.submission.source import read

H, W, SPP = 60, 80, 16
SCENES = [(n, s) for n in NAMES for s in dict.fromkeys(load(n).scenes.values())]
WITHOUT_SHADOW = """
from raylab.lecture import black, dist_sqr, dot, normalize

def shade(x, k_d, N, scene, rng):
    result = black
    for light in scene.lights:
        y, p_y = light.sample(x, rng.square())
        L = normalize(y - x)
        result += light.radiance * k_d * max(0.0, dot(L, N)) * max(0.0, dot(-L, y.n)) / dist_sqr(x, y) / p_y
    return result
"""


def image(samples: np.ndarray) -> Image:
    """What a render makes of (spp, h, w) samples, the same in each channel."""
    spp, h, w = samples.shape
    mean, error = samples.mean(axis=0), samples.std(axis=0, ddof=1) / np.sqrt(spp)
    colour = np.ones(3)
    return Image(mean[..., None] * colour, error[..., None] * colour, np.full((h, w), spp))


def known(truth: np.ndarray, deviation: float = 0.0) -> Reference:
    """A reference without noise; `deviation` is that of one sample."""
    side = side_of(truth.shape[1])
    tiles = tile_errors(np.full((*truth.shape, 3), deviation), side)
    return Reference(truth[..., None] * np.ones(3), 0.0 * tiles, tiles, 0.0, "known")


def normal(seed: int, factor: float = 1.0) -> Comparison:
    rng = np.random.default_rng(seed)
    truth = 1.0 + rng.random((H, W))
    return Comparison(image(factor * truth + 0.5 * rng.normal(size=(SPP, H, W))), known(truth, 0.5))


def test_noise_is_called_noise_and_a_bias_is_not():
    """A tile of 2 x 2 pixels has a standard error of 0.5 / sqrt(64) = 1/16; the picture of 60 * 80 of 0.0018."""
    for seed in range(20):
        assert normal(seed).only_noise
        assert not normal(seed, 1.02).only_noise


def test_ratio_interval_and_rmse_are_those_of_normal_noise():
    """The ratio has the standard error 0.5 / sqrt(16 * 60 * 80) / 1.5; z = 5.2 for 20 pictures at 1e-6 each is 5."""
    expected = 0.5 / np.sqrt(SPP * H * W) / 1.5
    for seed in range(20):
        comparison = normal(seed)
        ratio, error = comparison.ratio
        assert error == pytest.approx(expected, rel=0.05)  # the tiles' own, or that of the technique if it is larger
        assert abs(ratio - 1.0) < 5.2 * error
        rmse, noise = comparison.rmse
        spread = np.sqrt(0.5 / (H * W) + 0.5 / (H * W * (SPP - 1)))  # relative, of a chi-square over pixels, and of SE
        assert abs(rmse / noise - 1.0) < 5.2 * spread


def test_light_that_comes_by_rare_samples_is_noise():
    """One sample in 500 brings light: a tile of 64 samples has 0.128 of them, most tiles have none."""
    rng, share = np.random.default_rng(5), 1.0 / 500.0
    truth = np.ones((H, W))
    rare = image((rng.random((SPP, H, W)) < share) / share)
    spread = float(np.sqrt(share * (1.0 - share))) / share
    assert (tile_errors(rare.standard_error, side_of(W)) == 0.0).mean() > 0.5
    reference = known(truth, spread)
    assert Comparison(rare, reference).only_noise
    missed = reference.deviation * (rng.random(reference.deviation.shape) < 0.9)  # the technique had none here either
    assert Comparison(rare, replace(reference, deviation=missed)).only_noise
    assert not Comparison(rare, known(truth, 0.0)).only_noise  # without the technique's variance it seems too dark


def test_where_it_is_wrong_is_found_and_drawn(tmp_path):
    rng = np.random.default_rng(7)
    samples = 1.0 + 0.2 * rng.normal(size=(SPP, H, W))
    samples[:, 20:24, 50:54] += 1.0
    comparison = Comparison(image(samples), known(np.ones((H, W)), 0.2))
    column, row = comparison.worst
    assert 50 <= column < 54
    assert 20 <= row < 24
    assert comparison.wrong_tiles == 4
    assert "too bright around column 5" in comparison.verdict
    comparison.write(tmp_path / "compared.png", "a title")
    from raylab.io.image_file import read_image

    shown = read_image(tmp_path / "compared.png")
    assert shown.shape[1] > 2000
    json.dumps(comparison.to_dict(), allow_nan=False)


def test_samples_that_are_no_numbers_are_not_noise():
    bad = replace(normal(1).image, invalid_samples=3)
    assert not Comparison(bad, known(np.ones((H, W)))).only_noise
    alone = image(np.ones((2, H, W)))
    alone.standard_error[:] = np.nan
    with pytest.raises(UserError, match="one sample in each pixel"):
        Comparison(alone, known(np.ones((H, W))))


# --- the references that are kept with the assignments ---


@pytest.mark.parametrize(("name", "scene"), SCENES, ids=str)
def test_the_kept_reference_is_of_this_scene(name, scene):
    """Made by `python -m raylab.grading.goal ASSIGNMENT`."""
    assignment = load(name)
    for task in (t for t in assignment.tasks if t.kind == "shade"):
        found = goal.stored(assignment, task, assignment.folder / scene, {"spp"})
        assert found is not None
        assert found.mean.shape == (240, 320, 3)
        assert (found.deviation >= 0.0).all()
        assert goal.stored(assignment, task, assignment.folder / scene, {"width"}) is None


@pytest.mark.certify
@pytest.mark.parametrize("task", [t.id for n in NAMES for t in load(n).tasks if t.kind == "shade"])
def test_right_pictures_are_noise_beside_the_kept_reference(task):
    assignment = load(task.partition(".")[0])
    path = assignment.folder / assignment.scenes[task]
    asked = assignment.task(task)
    reference = goal.stored(assignment, asked, path, set())
    made = raylab.render(raylab.load(path), asked.like, sampler="independent", spp=64, seed=11)
    assert Comparison(made, reference).only_noise


def test_another_scene_has_no_kept_reference(tmp_path):
    assignment = load("a1")
    text = (assignment.folder / "soft_shadow.xml").read_text()
    (tmp_path / "soft_shadow.xml").write_text(text.replace('name="spp" value="64"', 'name="spp" value="8"'))
    assert goal.stored(assignment, assignment.tasks[0], tmp_path / "soft_shadow.xml", set()) is not None
    (tmp_path / "soft_shadow.xml").write_text(text.replace('value="40"', 'value="41"'))
    assert goal.stored(assignment, assignment.tasks[0], tmp_path / "soft_shadow.xml", set()) is None


# --- from the command line ---


@pytest.fixture
def folder(tmp_path):
    """Where a student works on a1, whose answer has no shadows."""
    shutil.copyfile(load("a1").folder / "soft_shadow.xml", tmp_path / "soft_shadow.xml")
    (tmp_path / "shade.py").write_text(WITHOUT_SHADOW)
    return tmp_path


def test_a_wrong_picture_beside_the_right_one(folder, run):
    """Slide "Area source by Monte Carlo (diffuse)", without shadow(x, y). The one kernel that is compiled here."""
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py", "--spp", 4)
    assert done.code == 0
    assert "shade.py:shade (a1.diffuse)" in done.stdout
    assert "More than noise" in done.stdout
    assert "too bright" in done.stdout
    assert (folder / "soft_shadow_shade.png").is_file()
    assert (folder / "soft_shadow_shade_compared.png").is_file()


@pytest.fixture
def quick(monkeypatch):
    """Renders nothing: what `raylab.render` is asked for, and a picture of noise."""
    asked = []

    def render(scene, shade, **named):
        asked.append((shade, named))
        camera = scene.description.camera
        made = image(1.0 + np.random.default_rng(1).normal(size=(4, camera.height, camera.width)))
        made.report.update(seed=3, sampler="independent", threads=1, rays={"camera": 4, "shadow": 0},
                           seconds={"compile": 0.0, "render": 1.0})  # fmt: skip
        return made

    monkeypatch.setattr(raylab, "render", render)
    return asked


def test_another_size_is_compared_with_a_new_reference_of_another_seed(folder, run, quick):
    small = ["-D", "width=40", "-D", "height=30"]
    out = folder / "mine.exr"
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py", *small, "-o", out, "--json")
    assert done.code == 0
    (shade, _), (reference, named) = quick
    assert callable(shade)
    assert (reference, named["spp"], named["seed"]) == ("area_diffuse", 16, 4)
    found = json.loads(done.stdout)["comparison"]
    assert found["reference"] == "area_diffuse, 16 samples per pixel"
    assert out.is_file()
    assert (folder / "mine_compared.png").is_file()


def test_a_course_wheel_has_the_kept_reference_and_no_other(folder, run, quick, tmp_path, monkeypatch):
    wheel = tmp_path / "a1"
    shutil.copytree(load("a1").folder, wheel)
    (wheel / "stub.py").write_text(stub_of(load("a1")))
    for module in (own, which):
        monkeypatch.setattr(module, "assignments", lambda: [load(wheel)])
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py")
    assert "area_solid_angle, 1024 samples per pixel" in done.stdout
    done = run(
        "render", folder / "soft_shadow.xml", "--shade", folder / "shade.py", "-D", "width=40", "-D", "height=30"
    )
    assert done.code == 0
    assert "There is no reference: this raylab has not the solution" in done.stdout
    assert len(quick) == 2


def test_ctrl_c_during_the_reference_keeps_the_picture(folder, run, quick, monkeypatch):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    monkeypatch.setattr(Own, "reference", interrupted)
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py")
    assert done.code == 130
    assert "the picture is kept" in done.stdout
    assert (folder / "soft_shadow_shade.png").is_file()


def test_an_error_somewhere_in_the_picture_is_a_sentence(folder, run, monkeypatch):
    def render(*arguments, **named):
        raise IndexError("index is out of bounds")

    monkeypatch.setattr(raylab, "render", render)
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py")
    assert done.code == 2
    assert "`shade` raises IndexError: index is out of bounds. Which line it is: raylab check a1" in done.stderr


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def shade(x:\n", "shade.py: line 1: Python cannot read this line"),
        ("def other(x):\n    return x\n", "expected a function `shade` or `shade_uniform`"),
        ("def lens_direction(toward, f, px, py):\n    return toward\n", "is a plain function of numbers"),
        (WITHOUT_SHADOW.replace("result = black", "result = 0"), "line 9: This line adds a number and a Vec3."),
        (WITHOUT_SHADOW.replace("k_d,", "V, brdf,"), "The line must be: def shade(x, k_d, N, scene, rng):"),
    ],
)
def test_bad_files_are_sentences(folder, run, text, said):
    (folder / "shade.py").write_text(text)
    done = run("render", folder / "soft_shadow.xml", "--shade", folder / "shade.py")
    assert (done.code, done.stdout) == (2, "")
    assert said in done.stderr
    assert "Traceback" not in done.stderr


def test_bad_words_are_sentences(folder, run):
    scene, file = folder / "soft_shadow.xml", folder / "shade.py"
    (folder / "stub.py").write_text(stub_of(load("a1")))
    for arguments, said in (
        (["--shade", folder / "stub.py"], "not attempted: line"),
        (["--shade", folder / "nowhere.py"], "nowhere.py: expected a folder, a zip archive or a Python file"),
        (["--shade", file, "--task", "a9"], "there is no task 'a9'; expected one of a1.diffuse"),
        (["--shade", file, "--task", "a4"], "expected a function `shade_brdf` or `shade_brightness` (a4)"),
        (["--shade", "area", "--task", "a1"], "expected --shade FILE.py, got --shade area"),
        (["--shade", file, "--spp", "1"], "of one sample the noise is not known"),
    ):
        done = run("render", scene, *arguments)
        assert done.code == 2
        assert said in done.stderr


@pytest.mark.parametrize("name", [n for n in NAMES if load(n).scenes])
def test_the_stub_and_its_scene_tell_the_task(name, tmp_path):
    """All that is asked for in an assignment, and nothing else, unless a student has written one of several."""
    assignment = load(name)
    path, text = tmp_path / "shade.py", stub_of(assignment)
    shades = [t.id for t in assignment.tasks if t.kind == "shade"]
    scene = raylab.load(assignment.folder / assignment.scenes[shades[0]])
    for task in shades:
        source = read(text.replace(f'raise NotImplementedError("{task} is not written yet")', "return N").encode())
        assert choose(candidates(source, path, ""), source, path, scene)[1].id == task
    if len(shades) > 1:
        source = read(text.encode())
        with pytest.raises(UserError, match=f"--task {shades[0]} or --task {shades[1]}"):
            choose(candidates(source, path, ""), source, path, scene)
