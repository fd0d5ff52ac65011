"""Spectra become the RGB that published tables and Mitsuba 3 give."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from raylab.errors import UserError
from raylab.io import spectrum

SIX_DIGITS = 0.5e-5  # it prints six significant digits


def test_matching_functions_are_those_of_the_cie() -> None:
    # CIE 018:2019, table of the 1931 standard observer
    functions = spectrum._matching_functions()
    at_600 = [np.interp(600.0, spectrum.wavelengths(), column) for column in functions.T]
    # 600 nm is no quadrature node: the chord beside it misses at most the bend there times one step
    bend = np.array([1.0622 - 1.0456, 0.6949 - 0.6310, 0.0010 - 0.0008]) / 5 * (470 / 999)
    assert np.all(np.abs(np.array(at_600) - [1.0622, 0.6310, 0.0008]) <= bend)


def test_d65_is_the_table_of_the_cie_up_to_830_nm() -> None:
    # CIE 15:2004, table T.1. 560 nm is no quadrature node: the chord beside it misses at most the bend there
    # times one step. Beyond 780 nm the daylight formula stands in; its rounded coefficients are off by 0.2 %.
    bend = abs((102.023 - 100.0) - (100.0 - 98.1671)) / 5 * (470 / 999)
    power = spectrum.d65() * spectrum.D65_SCALE
    for wavelength, published, error in (
        (360, 46.6383, 1e-9),
        (560, 100.0, bend),
        (830, 60.3125, 2e-3 * 60.3125),
    ):
        assert np.interp(wavelength, spectrum.wavelengths(), power) == pytest.approx(published, abs=error)


@pytest.mark.parametrize(
    ("table", "emitter", "reflectance"),
    [
        ("400:0.1, 500:0.2, 700:0.9", (0.81508, 0.325279, 0.105922), (0.702163, 0.34068, 0.122439)),
        ("300:1 900:1", (1.20488, 0.948228, 0.909267), (0.998985, 0.998874, 0.998802)),
        ("500:1, 510:1", (-0.066541, 0.0712441, 0.0133142), (-0.0729662, 0.0781108, 0.0146232)),
    ],
)
def test_tabulated_spectra_have_the_rgb_of_mitsuba(
    table: str, emitter: tuple[float, ...], reflectance: tuple[float, ...]
) -> None:
    # numbers: Mitsuba 3.9.1, scalar_rgb, mi.traverse of a point light and of a diffuse BSDF
    values = spectrum.tabulated(*spectrum.parse_pairs(table))
    largest = max(map(abs, emitter + reflectance))
    assert spectrum.integrate(values) == pytest.approx(np.array(emitter), abs=SIX_DIGITS * largest)
    assert spectrum.integrate(values, spectrum.d65()) == pytest.approx(np.array(reflectance), abs=SIX_DIGITS * largest)


def test_uniform_emitter_has_the_rgb_of_mitsuba() -> None:
    # number: Mitsuba 3.9.1, scalar_rgb, <spectrum name="intensity" value="0.7"/>
    assert spectrum.uniform(0.7) == pytest.approx(np.array([0.843356, 0.663804, 0.636241]), rel=SIX_DIGITS)


def test_unit_spectrum_has_luminance_one() -> None:
    xyz = np.linalg.solve(spectrum.XYZ_TO_RGB, spectrum.integrate(np.ones(spectrum.STEPS)))
    assert xyz[1] == pytest.approx(1.0, abs=8 * np.finfo(float).eps)


def test_table_between_nodes_is_linear_and_zero_outside() -> None:
    values = spectrum.tabulated(np.array([400.0, 600.0]), np.array([1.0, 3.0]))
    nodes = spectrum.wavelengths()
    inside = (nodes >= 400) & (nodes <= 600)
    assert np.allclose(values[inside], 1 + (nodes[inside] - 400) / 100, rtol=0, atol=8 * np.finfo(float).eps)
    assert not values[~inside].any()


def test_blackbody_is_plancks_law_with_wiens_maximum() -> None:
    # B(lambda) = 2 h c^2 / lambda^5 / (exp(h c / (lambda k T)) - 1) with the exact constants of the SI (2019)
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23
    wavelength = spectrum.wavelengths() * 1e-9
    expected = 2e-9 * h * c**2 / wavelength**5 / np.expm1(h * c / (wavelength * k * 5000.0))
    assert np.allclose(spectrum.blackbody(5000.0), expected, rtol=64 * np.finfo(float).eps)
    peak = spectrum.wavelengths()[np.argmax(spectrum.blackbody(5000.0))]
    assert abs(peak - 2.897771955e6 / 5000.0) <= 470 / 999


def test_blackbody_keeps_its_range() -> None:
    values = spectrum.blackbody(5000.0, 500.0, 600.0)
    nodes = spectrum.wavelengths()
    assert values[(nodes >= 500) & (nodes <= 600)].all()
    assert not values[(nodes < 500) | (nodes > 600)].any()


def test_hot_bodies_are_blue_and_cold_ones_red() -> None:
    hot, cold = (spectrum.integrate(spectrum.blackbody(t)) for t in (12000.0, 2500.0))
    assert hot[2] > hot[1] > hot[0]
    assert cold[0] > cold[1] > cold[2]
    assert not spectrum.blackbody(1e-300).any()
    assert not spectrum.blackbody(1e-320).any()


def test_spd_file(tmp_path: Path) -> None:
    path = tmp_path / "a.spd"
    path.write_text("# comment\n400 0.1\n\n500\t2e-1\n")
    nodes, values = spectrum.read_spd(path)
    assert nodes.tolist() == [400.0, 500.0]
    assert values.tolist() == [0.1, 0.2]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("400:0.1", "at least two"),
        ("400:0.1, 500", '"500"'),
        ("400:0.1, 500:x", '"500:x"'),
        ("400:0.1, 500:nan", '"500:nan"'),
        ("500:0.1, 400:1", "must increase"),
        ("400:1, 400:1", "must increase"),
    ],
)
def test_bad_tables_are_refused(text: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=reason):
        spectrum.parse_pairs(text)
    path = tmp_path / "a.spd"
    path.write_text(text.replace(":", " ").replace(", ", "\n"))
    with pytest.raises(UserError, match=r"a\.spd"):
        spectrum.read_spd(path)


def test_spd_file_that_cannot_be_read(tmp_path: Path) -> None:
    (tmp_path / "b.spd").write_bytes(b"\xff\xfe\x00\x80")
    for name in ("missing.spd", "b.spd"):
        with pytest.raises(UserError, match=name):
            spectrum.read_spd(tmp_path / name)
