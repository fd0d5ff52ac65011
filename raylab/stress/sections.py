"""Sections: the modules that hold the cases."""

from __future__ import annotations

import importlib

MODULES = (
    "self_shadows",
    "shadow_rays",
    "small_pictures",
    "odd_rays",
    "meshes",
    "watertight",
    "cameras",
    "poses",
    "semantics",
    "solid_angles",
    "cones",
    "rectangles",
    "nearness",
    "stiff_lights",
    "stiff_estimators",
    "stiff_foot",
    "stiff_lobes",
    "stiff_pixels",
    "choices",
    "lobes",
    "reflection",
    "boundaries",
    "frames",
    "skies",
    "randomness",
    "accumulation",
    "doubts",
    "colours",
)


def load() -> None:
    """Import them, which enters their cases."""
    for name in MODULES:
        importlib.import_module(f"raylab.stress.{name}")
