"""Planted mistakes: small patches of raylab's own code, and the trials that must see them.

In reading order: `patch` (what a mutant is, and how it comes to life), `trials` (scenes whose truth is known), `kills`
(what the harness says of one), `maps`, `loops`, the tables `*_mutants`, `corpus` and `run` (a process for each).
"""
