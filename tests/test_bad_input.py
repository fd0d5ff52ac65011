"""Bad input on the command line: one sentence with file and line on standard error, exit code 2, nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from broken_scenes import animated, document, key, texture, thin_lens, to_world

from raylab.io.image_file import write_exr


def rough(kind: str, *floats: str) -> str:
    values = "".join(f'<float name="{name}" value="{value}"/>' for name, value in map(str.split, floats))
    return f'<bsdf type="{kind}">\n{values}</bsdf>'


LENS, SHUTTER = "float aperture_radius 0.1", "float shutter_open 1"
FLAT = '<scale x="0" y="1"/>'
CASES = {  # line, body of the file from line 2 on, and what was expected or came
    "focus 0": (4, thin_lens(LENS, "float focus_distance 0"), "must be greater than 0, got 0"),
    "focus -2": (4, thin_lens(LENS, "float focus_distance -2"), "must be greater than 0, got -2"),
    "reversed shutter": (
        5,
        thin_lens(LENS, SHUTTER, "float shutter_close 0.5"),
        "shutter_open is 1, shutter_close 0.5",
    ),
    "keyframes out of order": (5, animated(key(0), key(2), key(1)), "must increase, got 1 after 2"),
    "two keyframes at one time": (4, animated(key(1), key(1)), "must increase, got 1 after 1"),
    "singular transform": (3, to_world(FLAT), "singular"),
    "singular keyframe": (4, animated(key(0), key(1, FLAT)), "singular"),
    "roughness -0.1": (3, rough("roughconductor", "alpha -0.1"), "must be greater than 0, at most 10, got -0.1"),
    "roughness 0": (3, rough("roughplastic", "alpha 0"), "must be greater than 0, at most 10, got 0"),
    "roughness -1 across": (3, rough("roughconductor", "alpha_u 0.1", "alpha_v -1"), 'roughness "alpha_v"'),
    "exponent -2": (2, '<bsdf type="phong"><float name="exponent" value="-2"/></bsdf>', "must not be negative, got -2"),
    "texture of two channels": (2, texture("", "two.exr"), "must have channels R, G, B or Y, got B, A"),
    "texture cut off": (2, texture("", "cut.exr"), "cannot read the image"),
    "moving point light": (2, animated(key(0), key(1), kind='emitter type="point"'), "cannot move"),
    "moving sky": (2, animated(key(0), key(1), kind='emitter type="constant"'), "cannot move"),
    "moving material": (2, animated(key(0), key(1), kind='bsdf type="diffuse"'), 'no parameter "to_world"'),
    "ball that becomes an egg": (2, animated(key(0), key(1, '<scale x="2"/>'), kind='shape type="sphere"'), "equally"),
}


@pytest.mark.parametrize("case", CASES)
def test_bad_input_is_one_sentence_with_file_and_line_and_exit_code_2(case, run, tmp_path):
    line, body, words = CASES[case]
    write_exr(tmp_path / "two.exr", {"A": np.ones((2, 2)), "B": np.ones((2, 2))}, {})
    write_exr(tmp_path / "whole.exr", {"": np.ones((16, 16, 3))}, {})
    (tmp_path / "cut.exr").write_bytes((tmp_path / "whole.exr").read_bytes()[:-200])
    scene = tmp_path / "scene.xml"
    scene.write_text(document(body))
    done = run("render", scene, "-o", tmp_path / "picture.png")
    assert (done.code, done.stdout) == (2, "")
    assert done.stderr.startswith(f"raylab: error: {scene}:{line}: ")
    assert done.stderr.count("\n") == 1
    assert words in done.stderr
    assert not (tmp_path / "picture.png").exists()
