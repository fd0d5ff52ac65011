"""The command line: what it prints and writes, how it fails, how it stops."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import Done

import raylab
from raylab.progress import Bar, Progress

SCENE = """<scene version="3.0.0">
<default name="size" value="6"/> <default name="radiance" value="2"/>
<integrator type="direct"/>
<sensor type="perspective">
  <transform name="to_world"><lookat origin="0,2,4" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm">
    <integer name="width" value="$size"/><integer name="height" value="4"/><rfilter type="box"/></film>
  <sampler type="independent"><integer name="sample_count" value="2"/></sampler>
</sensor>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform></shape>
<shape type="rectangle">
  <transform name="to_world"><rotate x="1" angle="90"/><translate y="2"/></transform>
  <emitter type="area"><rgb name="radiance" value="$radiance"/></emitter>
</shape>
</scene>
"""
ROOT = Path(__file__).parents[1]
KEYS = {
    "scene", "shade", "sampler", "spp", "seed", "threads", "width", "height", "mean", "standard_error", "seconds",
    "samples_per_second", "rays", "invalid_samples", "left_out",
}  # fmt: skip
COMMAND = [sys.executable, "-m", "raylab.cli"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


@pytest.fixture
def scene(tmp_path) -> Path:
    path = tmp_path / "scene.xml"
    path.write_text(SCENE)
    return path


def run_process(*arguments: object) -> Done:
    command = [*COMMAND, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT, timeout=120, check=False)
    return Done(done.returncode, done.stdout, done.stderr)


def test_json_is_one_object_with_these_keys(scene, run):
    done = run("render", scene, "--json", "-D", "size=5", "--seed", 3, "--threads", 1)
    assert (done.code, done.stderr) == (0, "")
    result = json.loads(done.stdout)
    assert set(result) >= KEYS
    assert (result["shade"], result["sampler"], result["spp"], result["seed"]) == ("direct", "independent", 2, 3)
    assert (result["width"], result["height"], result["threads"]) == (5, 4, 1)
    assert set(result["seconds"]) == {"load", "compile", "render"}
    assert result["rays"]["camera"] == 5 * 4 * 2
    assert 0 < result["rays"]["shadow"] <= 5 * 4 * 2
    for name in ("mean", "standard_error"):
        assert len(result[name]) == 3
        assert all(isinstance(value, float) for value in result[name])
    assert result["invalid_samples"] == 0
    assert result["complete"] is True
    assert "environment" in result["left_out"]["features"]
    assert "area lights" not in result["left_out"]["features"]


def test_one_sample_has_no_error_and_json_says_null(scene, run):
    result = json.loads(run("render", scene, "--json", "--spp", 1).stdout)
    assert result["standard_error"] == [None, None, None]
    assert result["relative_error"] is None


def test_parameters_reach_the_scene(scene, run):
    dim, bright = (json.loads(run("render", scene, "--json", "-D", f"radiance={r}").stdout) for r in (1, 4))
    np.testing.assert_allclose(bright["mean"], 4.0 * np.array(dim["mean"]), rtol=8 * np.finfo(float).eps)


def test_same_as_from_python(scene, run):
    result = json.loads(
        run("render", scene, "--json", "--spp", 8, "--sampler", "independent", "--shade", "direct").stdout
    )
    image = raylab.render(raylab.load(scene), spp=8)
    assert result["mean"] == image.image_mean.tolist()


def test_files_sentences_and_no_module_that_is_not_needed(scene, tmp_path):
    code = (
        "import sys; from raylab import cli\n"
        f"sys.argv = ['raylab', 'render', {str(scene)!r}, '-o', {str(tmp_path / 'a.npz')!r}, '--explain']\n"
        "try:\n    cli.main()\n"
        "finally:\n    print(*(m for m in ('colour', 'skimage', 'matplotlib', 'OpenImageIO', 'trimesh', 'jinja2')"
        " if m in sys.modules), file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=ENVIRONMENT, check=True)
    assert done.stderr.strip() == ""
    assert "+ area lights: it chooses points on the area lights." in done.stdout
    assert "- environment: the scene has no environment." in done.stdout
    assert "- matplotlib, for plots." in done.stdout
    assert "Mean radiance (R, G, B) and its standard error:" in done.stdout
    with np.load(tmp_path / "a.npz") as arrays:
        assert arrays["mean"].shape == (4, 6, 3)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--spp", "4", "--seconds", "1"], "expected one of spp, seconds and relative_error, got spp and seconds"),
        (["--spp", "4", "--relative-error", "0.1"], "got spp and relative_error"),
        (["--spp", "0"], "spp must be positive, got 0"),
        (["--seconds", "nan"], "seconds must be positive, got nan"),
        (["--shade", "aera"], "unknown shade 'aera'"),
        (["--shade", "env_cosine"], "needs environment, but the scene has area lights"),
        (["--sampler", "halton"], "unknown sampler 'halton'"),
        (["-D", "size"], 'expected NAME=VALUE, got "size"'),
        (["-o", "picture.jpeg"], "expected a name that ends in .png, .exr or .npz"),
        (["-o", "no/such/folder/a.png"], "there is no folder"),
        (["--threads", "0"], "--threads"),
        (["--bogus"], "--bogus"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_2(scene, run, arguments, said):
    done = run("render", scene, *arguments)
    assert (done.code, done.stdout) == (2, "")
    assert done.stderr.startswith("raylab: error: ")
    assert done.stderr.count("\n") == 1
    assert said in done.stderr


def test_scene_errors_and_warnings(scene, run, tmp_path):
    missing = run_process("render", tmp_path / "none.xml")
    assert (missing.code, missing.stdout) == (2, "")
    assert missing.stderr.startswith("raylab: error: ")
    assert "Traceback" not in missing.stderr
    scene.write_text(SCENE.replace('type="direct"', 'type="path"'))
    warned = run("render", scene, "--json")
    assert warned.stderr.count("raylab: warning: ") == 1
    assert json.loads(warned.stdout)["warnings"]


def test_ctrl_c_keeps_what_is_done(scene, tmp_path):
    outputs = [tmp_path / "a.npz", tmp_path / "a.png"]
    arguments = ["render", scene, "--seconds", 100, "--json", "--progress", "-o", outputs[0], "-o", outputs[1]]
    process = subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=ENVIRONMENT,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # a job in the background ignores Ctrl-C
    )
    assert process.stderr is not None
    seen = ""
    while "Mrays/s" not in seen:  # the bar is there: samples are being taken
        letter = process.stderr.read(1)
        assert letter, seen
        seen += letter
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    out, error = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "stopped by Ctrl-C; what is done is kept" in error
    assert "Traceback" not in error
    assert json.loads(out)["complete"] is False
    assert all(path.is_file() for path in outputs)
    with np.load(outputs[0]) as arrays:
        assert arrays["samples"].min() >= 1.0
        assert json.loads(str(arrays["report"]))["complete"] is False


def test_shades_lists_those_that_make_sense(scene, run):
    lines = run("shades", scene).stdout.splitlines()
    by_light = ["area_diffuse", "area", "area_solid_angle", "mis_balance", "mis_power"]
    assert [line.split()[0] for line in lines] == ["direct", "basic", *by_light, "one_light_uniform", "one_light_power"]


def test_version_and_help(run):
    assert run("--version").stdout == f"raylab {raylab.__version__}\n"
    assert "render" in run("--help").stdout


def test_bar_shows_speed_and_error():
    with Bar(shown=False, relative_error=0.01) as bar:
        text = bar.text(Progress(done=1, total=None, rays=30_000_000, seconds=2.0, relative_error=0.034))
        assert text == "15.0 Mrays/s, error 3.4 % (until 1 %)"
        assert bar.text(Progress()) == "0.0 Mrays/s"
