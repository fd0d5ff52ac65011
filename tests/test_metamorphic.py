"""Metamorphic relations: every built-in shade() keeps them, and mistakes break the relation that should see them.

Random numbers are fresh in each run; RAYLAB_ENTROPY=token replays one. False alarms: at most 1e-6 for the file.
"""

from __future__ import annotations

import os

import numpy as np
import pytest
import students
from scenes import outdoors, room

from raylab import description as d
from raylab import trials
from raylab.errors import UserError
from raylab.metamorphic import RELATIONS, relate
from raylab.probe import Pixel, Place, Probe
from raylab.scene import Scene
from raylab.stats import Budget
from raylab.testing import Examiner

pytestmark = pytest.mark.compiled(reason="a hundred thousand samples each")
TOKEN = os.environ.get("RAYLAB_ENTROPY")
EXAMINER = Examiner(Budget.replay(TOKEN) if TOKEN else Budget(tests=1000))


def applicable(name):
    described = trials.make(name, 0).description
    return [relation for relation in RELATIONS if relate(relation, described, 0) is not None]


QUICK = [("polygons", "area_diffuse"), ("image_sky", "env_brightness"), ("points_and_suns", "point_light")]
ALL = [(trial, technique) for trial in trials.NAMES for technique in trials.make(trial, 0).answers]


@pytest.mark.parametrize(("trial", "technique", "relation"), [(t, s, r) for t, s in QUICK for r in applicable(t)])
def test_built_in_shades_keep_the_relations(trial, technique, relation):
    report = EXAMINER.relation(relation, technique, trial=trial, delta=0.03)
    assert report.outcome == "PASS", report


@pytest.mark.certify
@pytest.mark.parametrize(("trial", "technique"), [case for case in ALL if case not in QUICK])
def test_every_built_in_shade_keeps_every_relation(trial, technique):
    reports = [EXAMINER.relation(relation, technique, trial=trial, delta=0.03) for relation in applicable(trial)]
    reports.append(EXAMINER.more_rays(technique, trial=trial, delta=0.03))
    assert not [report for report in reports if report.outcome != "PASS"]


def test_the_mean_of_two_calls_and_another_strategy_agree():
    assert EXAMINER.more_rays("area_diffuse", trial="polygons", delta=0.03).outcome == "PASS"
    assert EXAMINER.same_mean("area_diffuse", "direct", trial="polygons", delta=0.03).outcome == "PASS"


# --- mistakes ---


@pytest.mark.parametrize(
    ("shade", "technique", "trial", "relation"),
    [
        (students.one_over_r, "area_diffuse", "polygons", "times_3"),
        (students.no_area, "area_diffuse", "polygons", "times_3"),
        (students.first_light, "area_diffuse", "polygons", "light_order"),
        (students.flipped_sky, "env_cosine", "image_sky", "rotated"),
        (students.flipped_sky, "env_cosine", "image_sky", "sky_rolled"),
        (students.flipped_sky, "env_cosine", "image_sky", "mirrored"),
        (students.clamped, "env_cosine", "image_sky", "exposure_4"),
    ],
)
def test_mistakes_break_the_relation_that_should_see_them(shade, technique, trial, relation):
    report = EXAMINER.relation(relation, technique, shade, trial=trial)
    assert report.outcome == "FAIL", report


def test_scenes_without_a_trial_have_relations_as_well():
    """A floor, a cube and a lamp; a sky: any scene, at a point and through a pixel, and no truth."""
    for scene, shade, names in (
        (room(8), "area_diffuse", ("times_8", "translated", "mirrored", "exposure_4")),
        (outdoors(d.GradientEnvironment(np.ones(3), 0.3 * np.eye(3)), 8), "env_cosine", ("rotated", "times_3")),
    ):
        places = (Place.seen((0, -5, 3), (0.9, -0.7, 0)), Pixel(2, 6))
        for name in names:
            for place in places if name in ("mirrored", "rotated") else places[:1]:
                share = EXAMINER.budget.test(f"{name} {shade} {place}")
                relation = relate(name, scene.description, share.child(0))
                report = EXAMINER.related(share, Probe(scene, shade, place), relation, delta=0.03)
                assert report.outcome == "PASS", report


def test_relations_that_do_not_apply_are_named():
    with pytest.raises(UserError, match="does not apply"):
        EXAMINER.relation("sky_rolled", "area_diffuse", trial="polygons")
    with pytest.raises(ValueError, match="unknown relation 'nothing'"):
        relate("nothing", room(8).description, 1)
    share = EXAMINER.budget.test("a bound is needed")
    scene = room(8)
    probe = Probe(scene, "area_diffuse", Place.seen((0, -5, 3), (0.9, -0.7, 0)))
    with pytest.raises(UserError, match="bound of the samples"):
        EXAMINER.related(share, probe, relate("light_split", scene.description, 1))
    assert isinstance(Scene(relate("light_split", scene.description, 1).description), Scene)
