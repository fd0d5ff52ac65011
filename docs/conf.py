"""Sphinx configuration: the Markdown pages of this folder as HTML."""

project = "raylab"
extensions = ["myst_parser"]
exclude_patterns = ["_build"]
html_theme = "alabaster"
