"""Materials of every kind, at the ends of what their numbers may be, plain and with a picture on them."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from raylab import description as d
from strategies.numbers import share, triple

exponent = st.sampled_from((0.0, 5e-324, 0.5, 1.0, 10.0, 1e3, 1e6, 1e9))
ratio = st.sampled_from((1.0, 1.5, 1.33, 1.0 + 2.0**-52, 1e-6, 1e6, 1e-300, 5e-324))
roughness = st.sampled_from((0.1, 0.5, 1.0, 10.0, 1e-3, 1e-6, 1e-300))
distributions = st.sampled_from(("beckmann", "ggx"))
often_ggx = st.sampled_from(("ggx",) * 7 + ("beckmann",))  # whose coat is computed fifty times as fast


@st.composite
def bitmaps(draw: Any) -> d.Bitmap:
    """A picture of few texels, laid over (u, v) as it is, turned, many times, all on one point or far away."""
    height, width = draw(st.integers(1, 3)), draw(st.integers(1, 4))
    pixels = np.array(draw(st.lists(share, min_size=3 * height * width, max_size=3 * height * width)))
    size = draw(st.sampled_from((1.0, 1.0, -1.0, 3.0, 0.0, 1e-300, 1e6, 2.0**31, 1e12, 1e300)))
    shift = draw(st.sampled_from((0.0, 0.5, -1e-300, 1.0 - 2.0**-53, -1e9, 1e300)))
    return d.Bitmap(
        pixels.reshape(height, width, 3),
        filter=draw(st.sampled_from(("bilinear", "nearest"))),
        wrap=draw(st.sampled_from(("repeat", "mirror", "clamp"))),
        to_uv=np.array([[size, draw(st.sampled_from((0.0, 0.0, 1.0, 1e300))), shift], [0.0, size, -shift], [0, 0, 1]]),
    )


diffuse = st.builds(d.Diffuse, triple(share))
phong = st.builds(lambda a, b, n: d.Phong(a * (1.0 - b), b, n), triple(share), triple(share), exponent)
conductors = st.builds(
    d.Conductor,
    triple(st.sampled_from((0.0, 0.2, 1.0, 1e6, 1e-300))),
    triple(st.sampled_from((0.0, 1.0, 4.0, 1e6, 1e-300))),
    triple(share),
)
glass = st.builds(d.Dielectric, ratio, ratio, triple(share), triple(share))
rough_metal = st.builds(
    lambda eta, k, alpha, name: d.RoughConductor(eta, k, alpha_u=alpha, alpha_v=alpha, distribution=name),
    triple(st.sampled_from((0.0, 0.2, 1.0, 1e6))),
    triple(st.sampled_from((0.0, 1.0, 4.0, 1e6))),
    roughness,
    distributions,
)
rough_plastic = st.builds(
    d.RoughPlastic, triple(share) | bitmaps(), triple(share), ratio, ratio, roughness, often_ggx, st.booleans()
)
textured = st.builds(d.Diffuse, bitmaps())
textured_phong = st.builds(lambda k_d, n: d.Phong(k_d, np.zeros(3), n), bitmaps(), exponent)
