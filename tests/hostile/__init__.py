"""Hostile and broken submissions, numbered 1 to 64; an honest one would get 10 points."""
