"""Strategies: a shade() as a record, so that each is a type of its own and gets a kernel of its own.

The built-in ones can be found by name, here and by the kernel cache; any other function, such as a student's, is
wrapped by `strategy` and compiled afresh.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, NamedTuple

from raylab import beyond, glossy
from raylab import shade as slides
from raylab.basic import basic
from raylab.direct import direct
from raylab.errors import UserError
from raylab.jit import njit
from raylab.record import record
from raylab.scene import Scene
from raylab.vec3 import black

_DIFFUSE, _ANY = ("x", "k_d", "N", "scene", "rng"), ("x", "V", "brdf", "N", "scene", "rng")
BUILT_IN: dict[str, tuple[Any, str]] = {
    "direct": (direct, ""),
    "basic": (basic, ""),
    "point_light": (slides.point_light, "point lights"),
    "area_diffuse": (slides.area_diffuse, "area lights"),
    "area": (slides.area, "area lights"),
    "area_solid_angle": (slides.area_solid_angle, "area lights"),
    "directional_light": (slides.directional_light, "directional lights"),
    "env_uniform": (slides.env_uniform, "environment"),
    "env_cosine": (slides.env_cosine, "environment"),
    "env_brightness": (slides.env_brightness, "environment"),
    "env_brdf": (slides.env_brdf, "environment"),
    "glossy_jitter": (glossy.glossy_jitter, "glossy BRDF"),
    "glossy_phong": (glossy.glossy_phong, "glossy BRDF"),
    "glossy_normal": (glossy.glossy_normal, "glossy BRDF"),
    "mis_balance": (beyond.mis_balance, "area lights or environment"),
    "mis_power": (beyond.mis_power, "area lights or environment"),
    "one_light_uniform": (beyond.one_light_uniform, "area lights"),
    "one_light_power": (beyond.one_light_power, "area lights"),
}
NAMES = tuple(BUILT_IN)


def signature(name: str) -> tuple[str, ...]:
    """The names of the arguments of a built-in shade()."""
    return _parameters(BUILT_IN[name][0])


def _parameters(function: Any) -> tuple[str, ...]:
    return tuple(inspect.signature(getattr(function, "py_func", function)).parameters)


class Strategy(NamedTuple):
    """What all strategies hold; a subclass adds shade() and visible()."""

    hide_emitters: bool


def _make(name: str, function: Any, cached: bool) -> type:
    parameters = _parameters(function)
    if parameters == _DIFFUSE:

        def shade(self, x, V, brdf, N, scene, rng):
            return function(x, brdf.k_d, N, scene, rng)

    elif parameters == _ANY:

        def shade(self, x, V, brdf, N, scene, rng):
            return function(x, V, brdf, N, scene, rng)

    else:
        raise UserError(
            f"shade function {name!r}: expected the arguments ({', '.join(_ANY)}) or ({', '.join(_DIFFUSE)}), "
            f"got ({', '.join(parameters)})"
        )

    def visible(self, light):
        return black if self.hide_emitters else light

    members = {"shade": shade, "visible": visible, "cached": cached, "__module__": __name__, "__slots__": ()}
    cls: Any = type(f"Strategy_{name}", (Strategy,), members)
    return record(cls)


_CLASSES = {name: _make(name, function, True) for name, (function, _) in BUILT_IN.items()}
globals().update({cls.__name__: cls for cls in _CLASSES.values()})  # where pickle looks for them


@functools.lru_cache(maxsize=64)
def _own(shade: Callable[..., Any]) -> type:
    """The strategy class of a function, made once, so that its kernel is compiled once."""
    function = shade if hasattr(shade, "py_func") else njit(shade)
    return _make(getattr(shade, "__name__", "shade"), function, False)


def strategy(shade: str | Callable[..., Any], scene: Scene) -> Any:
    """The record that renders `scene` with a built-in shade() by name or with a function.

    Raises UserError when the name is unknown or the scene has not the light that the function is about.
    """
    hide = scene.description.hide_emitters
    if callable(shade):
        return _own(shade)(hide)
    if shade not in BUILT_IN:
        raise UserError(f"unknown shade {shade!r}; expected one of {', '.join(NAMES)}")
    needs, diffuse = BUILT_IN[shade][1], shade in ("area_diffuse", "env_uniform", "env_cosine")
    if needs and scene.features.isdisjoint(needs.split(" or ")):
        there = ", ".join(sorted(scene.features)) or "nothing of the kind"
        raise UserError(f"shade {shade!r} needs {needs}, but the scene has {there}")
    if diffuse and "glossy BRDF" in scene.features:
        other = {"area_diffuse": "area", "env_uniform": "env_brdf", "env_cosine": "env_brdf"}[shade]
        raise UserError(f"shade {shade!r} is for diffuse surfaces, but the scene has a glossy BRDF; try {other!r}")
    if shade == "env_brightness" and getattr(scene.description.environment, "mis_compensation", False):
        raise UserError(
            "shade 'env_brightness' would miss what mis_compensation leaves to the BRDF's samples; use mis_balance, "
            "mis_power or direct, or set mis_compensation to false"
        )
    return _CLASSES[shade](hide)


def available(scene: Scene) -> list[str]:
    """The names of the built-in shades that make sense for a scene."""
    found = []
    for name in NAMES:
        try:
            strategy(name, scene)
        except UserError:
            continue
        found.append(name)
    return found
