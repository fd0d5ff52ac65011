"""Figures: the register, the files in docs, the page that shows them, and the command that makes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from raylab import cli
from raylab.errors import UserError
from raylab.figures import make, panels, registry
from raylab.figures.gallery import markdown
from raylab.slides import TABLE

DOCS = Path(__file__).parents[1] / "docs"
FIGURES = registry.all_figures()


def test_page_shows_every_figure():
    assert (DOCS / "gallery.md").read_text() == markdown(), "run `make figures`"


def test_every_file_in_docs_has_a_figure_and_every_figure_a_small_file():
    assert {p.stem for p in (DOCS / "figures").glob("*")} == set(FIGURES)
    sizes = {name: (DOCS / "figures" / f"{name}.png").stat().st_size for name in FIGURES}
    assert not {name: size for name, size in sizes.items() if size > registry.MOST_BYTES}


def test_figures_of_the_slide_table_exist():
    assert {row.figure for row in TABLE if row.figure} <= set(FIGURES)


def test_an_unknown_name_gets_the_nearest():
    first = next(iter(FIGURES))
    with pytest.raises(UserError, match=f'unknown figure "{first}x"; the nearest is "{first}"'):
        registry.chosen([first + "x"])


def test_a_name_is_registered_once_and_for_a_slide_that_exists():
    first = next(iter(FIGURES.values()))
    with pytest.raises(ValueError, match="two figures"):
        registry.figure(first.name, first.slide, "caption")
    with pytest.raises(ValueError, match="no slide"):
        registry.figure("new", "No such slide", "caption")


def draws(name, done):
    return registry.Figure(name, TABLE[0].title, "caption", lambda path: path.write_bytes(done))


def interrupted(path):
    path.write_bytes(b"half")
    raise KeyboardInterrupt


def test_ctrl_c_keeps_what_is_done(tmp_path, monkeypatch):
    figures = [draws("one", b"1"), draws("two", b"2")._replace(draw=interrupted), draws("three", b"3")]
    monkeypatch.setattr("raylab.figures.registry.chosen", lambda names: figures)
    arguments = ["figures", "-o", str(tmp_path / "out"), "--gallery", str(tmp_path / "page.md")]
    result = CliRunner().invoke(cli.commands, arguments, standalone_mode=False)
    assert result.return_value == cli.INTERRUPTED
    assert "Wrote 1 of 3 figures" in result.output
    assert [p.name for p in (tmp_path / "out").iterdir()] == ["one.png"]  # no half figure
    assert not (tmp_path / "page.md").exists()


def test_list_names_all_figures():
    result = CliRunner().invoke(cli.commands, ["figures", "--list"], standalone_mode=False)
    assert [line.split()[0] for line in result.output.splitlines()] == list(FIGURES)


def test_a_folder_is_asked_for():
    with pytest.raises(UserError, match="-o DIR"):
        CliRunner().invoke(cli.commands, ["figures"], standalone_mode=False, catch_exceptions=False)


def test_gallery_links_from_where_it_is(tmp_path):
    make.gallery(tmp_path / "page.md", tmp_path / "pictures")
    assert "](pictures/" in (tmp_path / "page.md").read_text()


def test_slope_of_a_power_law():
    x = np.array([1.0, 4.0, 16.0])
    assert panels.slope(x, 7.0 * x**-1.5) == pytest.approx(-1.5, rel=1e-12)


def test_error_map_is_dark_where_there_is_no_error():
    reference = np.ones((2, 2, 3))
    wrong = reference.copy()
    wrong[0, 0] = 2.0  # as far off as the scale goes
    shown = panels.error_map(wrong, reference)
    np.testing.assert_array_equal(shown[1, 1], panels.colours(0.0))
    np.testing.assert_array_equal(shown[0, 0], panels.colours(1.0))


def test_row_shows_pictures_pixel_for_pixel(tmp_path):
    """A pixel becomes a block of scale x scale; its corner is known from the layout's gap and title."""
    from PIL import Image

    pixels = np.zeros((20, 30, 3))
    pixels[::2] = 1.0
    panels.row(tmp_path / "row.png", [panels.Panel("", pixels), panels.Panel("", pixels, zoom=(0, 0, 4))], scale=3)
    shown = np.asarray(Image.open(tmp_path / "row.png").convert("L"))
    np.testing.assert_array_equal(shown[34:94, 16:106], np.kron(255 * (pixels[..., 0] > 0), np.ones((3, 3))))


def test_titles_and_notes_stay_over_and_under_their_picture(tmp_path):
    from PIL import Image

    words, grey = "one point on each of the lights", np.full((20, 60, 3), 0.5)
    panels.row(tmp_path / "row.png", [panels.Panel(words, grey, words)] * 2)
    shown = np.asarray(Image.open(tmp_path / "row.png").convert("L"))
    frame = (shown[:4], shown[-4:], shown[:, :14], shown[:, 138:150], shown[:, -14:])
    assert [part.min() for part in frame] == [255] * 5


@pytest.mark.parametrize("name", ["ladder_area_brdf", "glossy_lobes", "mc_lobe_densities"])  # those without a render
def test_a_figure_is_a_small_png_with_a_background_and_lines(name, tmp_path):
    from PIL import Image

    path = FIGURES[name].write(tmp_path)
    assert path.stat().st_size <= registry.MOST_BYTES
    shown = np.asarray(Image.open(path).convert("RGB"))
    white = (shown == 255).all(axis=-1).mean()
    assert 0.5 < white < 0.99
