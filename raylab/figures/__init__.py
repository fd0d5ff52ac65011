"""The lecture's figures: each is a function that writes one PNG, registered under a name and a slide.

- `registry`: `@figure(name, slide, caption)`, and everything that was registered
- `panels`: what figures are made of: rows of labelled pictures, error maps, plots with fitted slopes
- `gallery`: the page docs/gallery.md
- one module for each topic; every module of this package is imported when figures are asked for
"""
