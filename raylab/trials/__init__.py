"""Trials: scenes without blind spots, made anew for each seed, in which the right answer is known in closed form.

A trial says, for each technique (a built-in shade() by name), what one sample must be on average, and how large it can
be at most. Any other function that claims the same technique can be put to the same trial. Everything stands at a
random place in a random orientation, colours differ by channel, lights are unequal, tilted, partly below the horizon,
partly hidden, some face away; so no mistake hides behind a symmetry or a factor of 1.

- `lights`: points, suns, polygons and round lights
- `skies`: a gradient, an image, a ball before the sky, glossy surfaces
- `motion`: a light that rises, an edge that crosses a pixel
- `lens`: a strip out of focus, through one pixel
- `lessons`: what the assignments ask, one thing at a time
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from raylab.errors import UserError
from raylab.trials.lens import through_a_lens
from raylab.trials.lessons import LESSONS
from raylab.trials.lights import everything, glossy_polygons, points_and_suns, polygons, round_lights
from raylab.trials.motion import crossing_edge, rising_light
from raylab.trials.skies import ball_before_sky, glossy_gradient, glossy_sky, gradient_sky, image_sky
from raylab.trials.trial import Answer, Trial

CATALOGUE: dict[str, Callable[[np.random.Generator], Trial]] = {
    "points_and_suns": points_and_suns,
    "glossy_points_and_suns": lambda rng: points_and_suns(rng, glossy=True),
    "polygons": polygons,
    "round_lights": round_lights,
    "glossy_polygons": glossy_polygons,
    "everything": everything,
    "gradient_sky": gradient_sky,
    "ball_before_sky": ball_before_sky,
    "image_sky": image_sky,
    "glossy_sky": glossy_sky,
    "glossy_gradient": glossy_gradient,
    "rising_light": rising_light,
    "crossing_edge": crossing_edge,
    "lens_before_focus": lambda rng: through_a_lens(rng, before=True),
    "lens_behind_focus": lambda rng: through_a_lens(rng, before=False),
}
NAMES = tuple(CATALOGUE)


def make(name: str, seed: int) -> Trial:
    """The trial called `name` with the numbers of `seed`; UserError if there is none of that name."""
    known = CATALOGUE | LESSONS
    if name not in known:
        raise UserError(f"unknown trial {name!r}; expected one of {', '.join(NAMES)}")
    return known[name](np.random.default_rng(seed))


__all__ = ["CATALOGUE", "LESSONS", "NAMES", "Answer", "Trial", "make"]
