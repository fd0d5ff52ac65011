"""Environments: eval(w) -> L_env, sample(N, u) -> w, p_w and pdf(N, w), p in 1/sr; w points to the sky.

`sample` follows the brightness (slide "Arbitrary surface in env. by Monte Carlo"). Where the brightness says nothing
(a constant sky) the hemisphere over N is sampled; elsewhere a sample may lie below the horizon of N, which the
clamped cosine of the estimator turns into zero.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from raylab.jit import njit
from raylab.record import record
from raylab.sampling import PI, frame, pdf_hemisphere, sample_hemisphere, turn
from raylab.vec3 import Vec3, black, dot, luminance, vec3_at
from raylab.view import View


@record
class NoEnvironment(NamedTuple):
    """A scene in the dark."""

    tag: int = 0

    def present(self):
        return False

    def by_brightness(self):
        return False

    def eval(self, w):
        return black

    def sample(self, N, u):
        return N, 0.0

    def pdf(self, N, w):
        return 0.0


@record
class ConstantEnvironment(NamedTuple):
    """The same radiance from everywhere."""

    radiance: Vec3

    def present(self):
        return True

    def by_brightness(self):
        return False

    def eval(self, w):
        return self.radiance

    def sample(self, N, u):
        return sample_hemisphere(N, u), 0.5 / PI

    def pdf(self, N, w):
        return pdf_hemisphere(N, w)


@record
class GradientEnvironment(NamedTuple):
    """L(w) = radiance + (red . w, green . w, blue . w), sampled in proportion to its luminance a + b (axis . w)."""

    radiance: Vec3
    red: Vec3
    green: Vec3
    blue: Vec3
    a: float
    b: float
    axis: Vec3

    def present(self):
        return True

    def by_brightness(self):
        return False

    def eval(self, w):
        return self.radiance + Vec3(dot(self.red, w), dot(self.green, w), dot(self.blue, w))

    def sample(self, N, u):
        z = 2.0 * sample_linear(self.a - self.b, self.a + self.b, u[0]) - 1.0
        r, phi = math.sqrt(max(0.0, (1.0 - z) * (1.0 + z))), 2.0 * PI * u[1]
        s, t = frame(self.axis)
        w = s * (r * math.cos(phi)) + t * (r * math.sin(phi)) + self.axis * z
        return w, self.pdf(N, w)

    def pdf(self, N, w):
        return (self.a + self.b * dot(self.axis, w)) / (4.0 * PI * self.a)


@njit
def sample_linear(left, right, u):
    """x in [0, 1] with density proportional to left + (right - left) x; both at least 0, not both 0."""
    root = math.sqrt(left * left + (right * right - left * left) * u)
    return min(u * (left + right) / (left + root), 1.0) if left + root > 0.0 else 0.0


# --- images ---


@record
class ImageEnvironment(NamedTuple):
    """A latitude-longitude image; sampled cell by cell in proportion to the luminance, exactly and in float64.

    The sphere is cut into `rows` x `columns` cells, bounded by circles of latitude and meridians. `heights` holds
    the cosines of the rows' edges, `row_cdf` and `cell_cdf` the cumulated shares of the rows and of the cells
    within each row; a cell of share zero is never chosen. `texels` says how radiance runs within a cell.
    """

    right: Vec3  # rows of the world-to-local rotation
    up: Vec3
    back: Vec3
    rows: int
    columns: int
    heights: View  # (rows + 1,)
    row_cdf: View  # (rows,)
    cell_cdf: View  # (rows, columns)
    texels: Any  # Nearest or Bilinear

    def present(self):
        return True

    def by_brightness(self):
        return True

    def eval(self, w):
        theta, phi = angles(self, w)
        if math.isnan(theta):  # which no integer can be made of
            return Vec3(theta, theta, theta)
        return self.texels.eval(theta / PI, phi)

    def sample(self, N, u):
        row, v = choose(self.row_cdf, u[0])
        column, h = choose_column(self.cell_cdf, row, self.columns, u[1])
        across, down, density = self.texels.sample_cell(row, column, h, v)
        z = self.heights[row] + (self.heights[row + 1] - self.heights[row]) * down
        phi = 2.0 * PI * (column + across + self.texels.offset()) / self.columns
        r = math.sqrt(max(0.0, (1.0 - z) * (1.0 + z)))
        w = self.right * (r * math.sin(phi)) + self.up * z - self.back * (r * math.cos(phi))
        return w, density * cell_pdf(self, row, column)

    def pdf(self, N, w):
        theta, phi = angles(self, w)
        if math.isnan(theta):
            return theta
        x = phi * self.columns - self.texels.offset()
        x = x if x >= 0.0 else x + self.columns
        column = min(int(x), self.columns - 1)
        row = min(int(theta / PI * self.rows), self.rows - 1)
        top, bottom = self.heights[row], self.heights[row + 1]
        down = min(max((top - math.cos(theta)) / (top - bottom), 0.0), 1.0)
        return self.texels.cell_density(row, column, x - column, down) * cell_pdf(self, row, column)


@njit
def angles(env, w):
    """Polar angle in [0, pi] from local +y, and the longitude as a fraction of a turn in [0, 1)."""
    x, y, z = dot(env.right, w), dot(env.up, w), dot(env.back, w)
    return math.atan2(math.sqrt(x * x + z * z), y), turn(x, -z)


@njit
def cell_pdf(env, row, column):
    """The probability of a cell divided by its solid angle, 1/sr."""
    p_row = env.row_cdf[row] - (env.row_cdf[row - 1] if row > 0 else 0.0)
    p_cell = env.cell_cdf[row, column] - (env.cell_cdf[row, column - 1] if column > 0 else 0.0)
    solid_angle = 2.0 * PI / env.columns * (env.heights[row] - env.heights[row + 1])
    return p_row * p_cell / solid_angle


@njit
def choose(cdf, u):
    """The first i with cdf[i] > u, and where u lies between cdf[i - 1] and cdf[i], in [0, 1)."""
    low, high = 0, len(cdf) - 1
    while low < high:
        middle = (low + high) // 2
        if cdf[middle] <= u:
            low = middle + 1
        else:
            high = middle
    below = cdf[low - 1] if low > 0 else 0.0
    return low, min((u - below) / (cdf[low] - below), 1.0 - 2.0**-53)


@njit
def choose_column(cdf, row, columns, u):
    """`choose` in one row of a two-dimensional table."""
    low, high = 0, columns - 1
    while low < high:
        middle = (low + high) // 2
        if cdf[row, middle] <= u:
            low = middle + 1
        else:
            high = middle
    below = cdf[row, low - 1] if low > 0 else 0.0
    return low, min((u - below) / (cdf[row, low] - below), 1.0 - 2.0**-53)


@record
class Nearest(NamedTuple):
    """Each texel is a cell of constant radiance; `pixels` (height * width, 3)."""

    pixels: View
    width: int
    height: int

    def offset(self):
        return 0.0

    def eval(self, v, u):
        row, column = min(int(v * self.height), self.height - 1), min(int(u * self.width), self.width - 1)
        return vec3_at(self.pixels, row * self.width + column)

    def sample_cell(self, row, column, h, v):
        return h, v, 1.0

    def cell_density(self, row, column, across, down):
        return 1.0


@record
class Bilinear(NamedTuple):
    """Radiance is bilinear between texels, as in Mitsuba 3: rows stand at theta = pi j / (height - 1)."""

    pixels: View
    width: int
    height: int

    def offset(self):
        return 0.5

    def eval(self, v, u):
        x, y = u * self.width - 0.5, v * (self.height - 1)
        x = x if x >= 0.0 else x + self.width
        column, row = min(int(x), self.width - 1), min(int(y), self.height - 2)
        right, s, t = (column + 1) % self.width, x - column, y - row
        top, bottom = row * self.width, (row + 1) * self.width
        return (vec3_at(self.pixels, top + column) * (1.0 - s) + vec3_at(self.pixels, top + right) * s) * (1.0 - t) + (
            vec3_at(self.pixels, bottom + column) * (1.0 - s) + vec3_at(self.pixels, bottom + right) * s
        ) * t

    def sample_cell(self, row, column, h, v):
        c00, c10, c01, c11 = corners(self, row, column)
        down = sample_linear(c00 + c10, c01 + c11, v)
        left, right = c00 + (c01 - c00) * down, c10 + (c11 - c10) * down
        across = sample_linear(left, right, h)
        return across, down, (left + (right - left) * across) * 4.0 / (c00 + c10 + c01 + c11)

    def cell_density(self, row, column, across, down):
        c00, c10, c01, c11 = corners(self, row, column)
        total = c00 + c10 + c01 + c11
        left, right = c00 + (c01 - c00) * down, c10 + (c11 - c10) * down
        return (left + (right - left) * across) * 4.0 / total if total > 0.0 else 0.0


@njit
def corners(texels, row, column):
    """Luminance at the four corners of a cell: top left, top right, bottom left, bottom right."""
    right = (column + 1) % texels.width
    top, bottom = row * texels.width, (row + 1) * texels.width
    return (
        luminance(vec3_at(texels.pixels, top + column)),
        luminance(vec3_at(texels.pixels, top + right)),
        luminance(vec3_at(texels.pixels, bottom + column)),
        luminance(vec3_at(texels.pixels, bottom + right)),
    )
