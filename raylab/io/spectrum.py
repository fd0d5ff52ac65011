"""Spectra as linear RGB with sRGB primaries, with the numbers that Mitsuba 3's RGB variants give."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab.errors import UserError

Array = npt.NDArray[np.float64]

FIRST, LAST = 360.0, 830.0  # nm, the range of the CIE 1931 colour matching functions
STEPS = 1000  # quadrature nodes, as in Mitsuba 3 (spectrum_list_to_srgb in src/core/spectrum.cpp)

# XYZ to linear RGB, primaries of ITU-R BT.709 and a D65 white, with the digits that Mitsuba 3 has
XYZ_TO_RGB = np.array(
    [[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]]
)

# Mitsuba 3's power of D65 at luminance one (MI_CIE_D65_NORMALIZATION). With its quadrature a white
# reflectance becomes 0.9989, not 1: kept, so that the pictures agree.
D65_SCALE = 98.99741751876255


def wavelengths() -> Array:
    """The quadrature nodes, (1000,) nm."""
    return np.linspace(FIRST, LAST, STEPS)


def integrate(values: Array, illuminant: Array | None = None) -> Array:
    """RGB of spectral `values` (1000,) at `wavelengths`: M sum(values x illuminant x cmf) / sum(y).

    The colour matching functions are the CIE 1931 2 degree observer, linear between nodes 5 nm apart.
    A reflectance needs the illuminant that lights it (`d65`), an emitter has none. Colours out of gamut have
    negative components.
    """
    functions = _matching_functions()
    lit = values if illuminant is None else values * illuminant
    rgb: Array = XYZ_TO_RGB @ (lit @ functions / functions[:, 1].sum())
    return rgb


def uniform(value: float) -> Array:
    """RGB of an emitter of the same power at all wavelengths: value M (1, 1, 1), pinkish beside D65."""
    rgb: Array = value * XYZ_TO_RGB.sum(axis=1)
    return rgb


def tabulated(nodes: Array, values: Array) -> Array:
    """(1000,) values between the `nodes` in nm, linearly interpolated, zero outside."""
    return np.interp(wavelengths(), nodes, values, left=0.0, right=0.0)


def blackbody(temperature: float, first: float = FIRST, last: float = LAST) -> Array:
    """(1000,) radiance of a black body (Planck), W/(m^2 sr nm), zero outside `first` to `last` in nm."""
    from colour.colorimetry import planck_law
    from scipy.constants import c, h, k, pi

    nodes = wavelengths()
    with np.errstate(over="ignore", divide="ignore"):  # exp(inf) of cold bodies: they are black
        radiance = 1e-9 * np.asarray(
            planck_law(nodes * 1e-9, temperature, 2 * pi * h * c**2, h * c / k), dtype=np.float64
        )
    return np.where((nodes >= first) & (nodes <= last), radiance, 0.0)


@cache
def d65() -> Array:
    """(1000,) power of the CIE standard illuminant D65 over `D65_SCALE`, linear between nodes 5 nm apart."""
    import colour

    daylight = colour.SDS_ILLUMINANTS["D65"]  # up to 780 nm; the CIE's daylight formula goes on from there
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    formula = colour.sd_CIE_illuminant_D_series(white)
    power = [daylight[w] if w <= daylight.shape.end else formula[w] for w in _nodes()]
    return np.interp(wavelengths(), _nodes(), np.asarray(power, dtype=np.float64)) / D65_SCALE


def _nodes() -> Array:
    return np.arange(FIRST, LAST + 1, 5.0)


@cache
def _matching_functions() -> Array:
    """(1000, 3) x, y, z bar at `wavelengths`."""
    import colour

    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    table = np.array([observer[w] for w in _nodes()])
    return np.column_stack([np.interp(wavelengths(), _nodes(), column) for column in table.T])


def parse_pairs(text: str) -> tuple[Array, Array]:
    """Wavelengths in nm and values from "400:0.1, 500:0.2"."""
    pairs = [word for word in re.split(r"[\s,]+", text) if word]
    return _table([pair.split(":") for pair in pairs], pairs)


def read_spd(path: Path) -> tuple[Array, Array]:
    """Wavelengths in nm and values from a text file with one pair in each line; lines with # are comments."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f'cannot read the spectrum "{path}": {error}') from None
    lines = [line for line in lines if line.strip() and not line.startswith("#")]
    try:
        return _table([line.split() for line in lines], lines)
    except UserError as error:
        raise UserError(f'in the spectrum "{path}": {error}') from None


def _table(rows: list[list[str]], texts: list[str]) -> tuple[Array, Array]:
    for row, text in zip(rows, texts, strict=True):
        if len(row) != 2 or not all(_is_finite(word) for word in row):
            raise UserError(f'expected a wavelength and a value, got "{text.strip()}"')
    if len(rows) < 2:
        raise UserError(f"a spectrum needs at least two wavelengths, got {len(rows)}")
    table = np.array(rows, dtype=np.float64)
    if (np.diff(table[:, 0]) <= 0).any():
        at = int(np.argmax(np.diff(table[:, 0]) <= 0))
        raise UserError(f"wavelengths must increase, got {table[at + 1, 0]:g} nm after {table[at, 0]:g} nm")
    return table[:, 0], table[:, 1]


def _is_finite(word: str) -> bool:
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False
