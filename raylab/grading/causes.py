"""Causes: what can be wrong, in the words of the slides, each in three levels of hint.

The first level says where to look, the second what to compare, the third names it.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cause:
    """A mistake by name; `hints` from vague to plain."""

    id: str
    hints: tuple[str, str, str]


def _cause(id: str, where: str, compare: str, named: str) -> tuple[str, Cause]:
    return id, Cause(id, (where, compare, named))


FACTOR, IF, COSINE, LOOP, RANDOM, PDF, MAP, IFS, FOCUS, TIME, WEIGHT, HALF = (
    "One of the factors of g is not that of the slide.",
    "Look at the `if` of the slide, and at what it keeps out.",
    "Look at the cosines.",
    "Look at how the loop over the lights adds up.",
    "Look at the random numbers: how many are drawn, and what is made of them.",
    "Look at the density: what is divided by, and in which measure.",
    "Look at how the result is made of two numbers from the square.",
    "Look at where the result must be 0.",
    "Look at the focus point, and at the ray that goes there.",
    "Look at where the time begins and ends.",
    "Look at the weights.",
    "How many of your points lie in the inner half of the area, or of the hemisphere's height?",
)

CAUSES: dict[str, Cause] = dict((
    _cause("none", "", "", "These are the numbers of the reference."),
    _cause("black", COSINE, "Every sample is black: what does max(0, .) do to a negative number?",
           "A dot product has the wrong sign, so that the clamp turns all light into nothing: L points from x "
           "to y, and the "
           "light's cosine is dot(-L, y.n)."),
    _cause("distance missing", FACTOR, "Move the lamp twice as far away: how does your result change, and how "
    "the slide's?",
           "The division by the squared distance |x - y|^2 is missing (or L is not of unit length in the cosines)."),
    _cause("distance power", FACTOR, "Move the lamp twice as far away: how does your result change, and how the "
    "slide's?",
           "The distance comes in another power than 1 / |x - y|^2."),
    _cause("light cosine missing", COSINE, "Turn the lamp: does your result know?",
           "Your result is the reference without the cosine at the light, dot(-L, y.n)."),
    _cause("receiver cosine missing", COSINE, "Turn the surface: does your result know?",
           "Your result is the reference without the cosine at the surface, dot(L, N)."),
    _cause("light cosine power", COSINE, "How often does the cosine at the light come in?",
           "The cosine at the light comes in a wrong power."),
    _cause("receiver cosine power", COSINE, "How often does the cosine at the surface come in?",
           "The cosine at the surface comes in a wrong power."),
    _cause("receiver cosine not clamped", COSINE, "What is dot(L, N) of a light below the horizon of N?",
           "The cosine at the surface is not clamped: light from below the horizon of N counts as negative light."),
    _cause("receiver cosine absolute", COSINE, "What is |dot(L, N)| of a light below the horizon of N?",
           "The cosine at the surface is taken as |cos| where it must be max(0, cos): light from below the "
           "horizon of N "
           "comes through."),
    _cause("normal of the triangle", COSINE, "Which normal does the slide mean, N or that of the flat triangle, x.n?",
           "The cosine is taken with x.n, the normal of the flat triangle, instead of the shading normal N."),
    _cause("other normal at the light", COSINE, "Which surface does each cosine belong to?",
           "The cosine at the light is taken with N, the normal at x, instead of y.n, the normal at y."),
    _cause("pdf missing", PDF, "What becomes of your result when the lamp is twice as large?",
           "The division by the density p is missing."),
    _cause("pdf multiplied", PDF, "What becomes of your result when the lamp is twice as large?",
           "The density is multiplied instead of divided by."),
    _cause("pdf power", PDF, "How often is the density divided by?", "The density comes in a wrong power."),
    _cause("pdf of another light", PDF, "Each light has a density of its own.",
           "The samples of every light are divided by the density of the first light's."),
    _cause("area for pdf", PDF, "Is the density of a ball's sample one over its area?",
           "The area of the light takes the place of 1 / p_y; on a ball it is not that, as only what is seen is "
           "sampled."),
    _cause("no shadow test", IF, "What stands between x and y?",
           "The shadow test is missing: hidden light comes through."),
    _cause("shadow inverted", IF, "When does the light come through: when shadow(...) is True, or when it is False?",
           "The shadow test is the wrong way round: only hidden light counts."),
    _cause("k_d missing", FACTOR, "Paint the surface another colour: does your result know?",
           "The factor k_d is missing."),
    _cause("k_d power", FACTOR, "How often does k_d come in?", "k_d comes in a wrong power."),
    _cause("radiance missing", FACTOR, "Make the lamp brighter: does your result know?",
           "The radiance of the light is missing."),
    _cause("radiance power", FACTOR, "How often does the radiance come in?", "The radiance comes in a wrong power."),
    _cause("f_r missing", FACTOR, "Give the surface another BRDF: does your result know?",
           "The factor f_r is missing."),
    _cause("f_r power", FACTOR, "How often does f_r come in?", "f_r comes in a wrong power."),
    _cause("only diffuse", FACTOR, "Does your highlight move when the eye does?",
           "Only k_d of the BRDF is used: the lobe is missing. Ask brdf.eval(V, L)."),
    _cause("V and L reversed", "Look at what is handed to the BRDF.", "Where do V and L point? And N?",
           "A direction is handed to brdf.eval the wrong way round: V points to the eye and L to the light."),
    _cause("N for V", "Look at what is handed to the BRDF.", "Does your highlight move when the eye does?",
           "brdf.eval gets N where V is due."),
    _cause("last light only", LOOP, "Two lamps: which of them do you see?",
           "Only the last light counts: `result =` where the slide has `result +=`."),
    _cause("first light only", LOOP, "Two lamps: which of them do you see?",
           "The loop ends after the first light: `return result` stands inside the loop."),
    _cause("divided by the lights", LOOP, "Two equal lamps: is it twice as bright as with one?",
           "The result is divided by the number of lights; light adds up."),
    _cause("counted twice", LOOP, "One lamp: how often is it added?", "The light is counted twice."),
    _cause("not random", RANDOM, "Call it twice: do you get two values?",
           "Every sample is taken at the same point: random numbers are not used."),
    _cause("one random number for two", RANDOM, "Where do your samples lie in the square?",
           "The same random number is used for both coordinates: samples lie on a line."),
    _cause("same numbers for all lights", RANDOM, "Does each light get numbers of its own?",
           "All lights share the random numbers of the first; the mean is right, the variance is not."),
    _cause("several samples", RANDOM, "How many samples does one call take?",
           "More than one sample is taken in a call; the mean is right, the variance is not the slide's."),
    _cause("solid angle", RANDOM, "Which density does the slide choose: uniform on the light, or in solid angle?",
           "The light is sampled by solid angle, where this slide samples it by area: right on average, another "
           "variance."),
    _cause("epsilon", "Look for constants that are not on the slide.",
           "What does the constant do when the lamp is near?",
           "A constant is added to the squared distance (or to a density): near lights come out too dark."),
    _cause("clipped", "Look for constants that are not on the slide.", "How bright may one sample be?",
           "Samples are cut off at a largest value: light is lost."),
    _cause("factor", FACTOR, "Your result is a constant times the truth.",
           "Your result is {factor} times the reference."),
    _cause("negated", FACTOR, "Your result is negative light.", "Your result is minus the reference."),
    # skies
    _cause("uniform for cosine", PDF, "Which directions does your sampler draw most often?",
           "The directions are drawn uniformly, but weighed as if in proportion to the cosine."),
    _cause("cosine for uniform", PDF, "Which directions does your sampler draw most often?",
           "The directions are drawn in proportion to the cosine, but weighed as if uniformly."),
    _cause("whole sphere", PDF, "How many of your directions point below the horizon?",
           "Directions are drawn from the whole sphere instead of the hemisphere over N."),
    _cause("radiance of another direction", FACTOR, "From where does the light come that you look up?",
           "The environment is asked for another direction than the one that was sampled."),
    _cause("other technique", PDF, "Which of the two boxes of the slide is this: by BRDF, or by environment? "
    "The captions "
           "on the slide are exchanged.", "This is the other technique: the two functions are exchanged."),
    _cause("pdf of the other technique", PDF, "Sampled by one density and divided by another?",
           "The sample comes from one technique and the density from the other."),
    # lobes
    _cause("exponent off by one", FACTOR, "Which constant belongs to the density, and which to the BRDF: n + 1, "
    "n + 2?",
           "The constants n + 1 of the density and n + 2 of the BRDF are mixed up."),
    _cause("lobe around N", "Look at the axis of the lobe.", "Where is the highlight when the eye moves?",
           "The lobe stands around N instead of the mirror direction R."),
    _cause("not mirrored", "Look at the axis of the lobe.", "Where is the highlight when the eye moves?",
           "The lobe stands around V instead of the mirror direction R."),
    # both techniques
    _cause("weights missing", WEIGHT,
           "The weights of both techniques at one point add up to 1. Yours?",
           "The weights are missing: light that both techniques find counts twice."),
    _cause("weights exchanged", WEIGHT, "Which density stands in the numerator of which weight?",
           "The weights of the two techniques are exchanged."),
    _cause("weights of one half", WEIGHT, "Does the weight depend on the densities?",
           "Both weights are 1/2, whatever the densities."),
    _cause("measure of the weight", WEIGHT,
           "In which measure are the two densities that you compare?",
           "A density in 1/m^2 is weighed against one in 1/sr: multiply by cos(theta) / r^2 first."),
    _cause("other heuristic", WEIGHT, "Balance: p / (p + q). Power: p^2 / (p^2 + q^2).",
           "It is the other heuristic."),
    _cause("light samples only", "Look at what is added up.",
           "How many techniques are there, and how many in your sum?",
           "The BRDF's sample is missing from the sum."),
    _cause("BRDF samples only", "Look at what is added up.",
           "How many techniques are there, and how many in your sum?",
           "The lights' samples are missing from the sum."),
    # plain functions: samplers
    _cause("angle for height", MAP, HALF, "The angle is spread evenly, so directions crowd at the axis; its cosine, "
           "or a function of that, must be even."),
    _cause("sine for cosine", MAP, HALF, "Sine and cosine are exchanged: the angle is measured from the horizon, "
           "not from the axis."),
    _cause("half a turn", MAP, "Draw some hundred points, seen from above: are they all around?",
           "Not all the way round: phi must go from 0 to 2 pi."),
    _cause("not turned to the axis", MAP, "Try an axis other than (0, 0, 1).",
           "The direction stands around the z axis, not yet around the one that was handed over: use from_frame."),
    _cause("axes exchanged", MAP, "Which of the three numbers belongs to which axis?",
           "The axes are exchanged: the last one is that of the normal (of a lens point: x belongs to x, y to y)."),
    _cause("below the horizon", MAP, "What is dot(w, N) of your directions?",
           "Directions point below the horizon: the height must not be negative."),
    _cause("not of unit length", MAP, "How long is your vector?",
           "The direction is not of unit length: x^2 + y^2 + z^2 = 1 asks for r = sqrt(1 - z^2)."),
    _cause("square for disk", MAP, "Draw some hundred points, seen from above: do they fill a disk?",
           "The points fill a square, or a part of one, where a disk is due."),
    _cause("no square root", MAP, HALF, "Points crowd at the centre: half of the radius holds a quarter of the "
           "area, so r = sqrt(u1)."),
    _cause("another power of the cosine", MAP, HALF, "The density is proportional to another power of the cosine "
           "than the slide's."),
    _cause("exponent missing", FACTOR, "Does your lobe become narrower when n grows?", "The exponent n has no effect."),
    _cause("power for root", MAP, "Is your lobe narrow or wide when n is large?",
           "A power where a root is due: cos(alpha) = u^(1 / (n + 1)), not u^(n + 1)."),
    _cause("radius missing", FACTOR, "Make the lens larger: does your result know?",
           "The radius a of the lens is missing."),
    _cause("radius power", FACTOR, "Make the lens twice as large: how much further out are your points?",
           "The radius a comes in a wrong power."),
    _cause("on the rim", MAP, HALF, "All points lie on the rim of the lens: the radius must be random too."),
    # plain functions: values
    _cause("normalisation missing", FACTOR, "What is the integral of your density over all directions?",
           "The factor (n + 1) / (2 pi), which makes the integral 1, is missing."),
    _cause("lobe behind R", IFS, "What does a negative number to an even power give?",
           "There is a density behind R, where dot(R, w) is negative: it must be 0 there."),
    _cause("focus sphere", FOCUS, "How far away is the focus point of a pixel at the edge?",
           "The focus points lie on a sphere: `toward` must not be normalized, as z = f on the plane of focus."),
    _cause("focus point missing", FOCUS, "Where does the pinhole's ray meet the plane z = f?",
           "The focus point is f times `toward`, not `toward` divided by f."),
    _cause("lens point ignored", FOCUS, "Does the direction change with the lens point?",
           "The direction is the pinhole's: the lens point does not come in."),
    _cause("lens point added", FOCUS, "From where to where does the ray go?",
           "The lens point is added where it must be subtracted: direction = focus point - lens point."),
    _cause("not divided by f", FOCUS, "What happens when the focus plane is far away?",
           "The lens point must be divided by f: the further the focus plane, the less the direction changes."),
    _cause("multiplied by f", FOCUS, "What happens when the focus plane is far away?",
           "The lens point is multiplied by f where it must be divided by it."),
    _cause("z is not 1", FOCUS, "How long must the direction be?",
           "The direction has the right way but not z = 1: divide it by its z."),
    _cause("backwards", FOCUS, "From where to where does the ray go?",
           "The direction points from the focus point to the lens."),
    _cause("opening missing", TIME, "Try a shutter that does not open at 0.", "The time of opening is missing."),
    _cause("shutter not scaled", TIME, "Try a shutter that is open for a tenth of a second.",
           "u is not scaled by the length of the interval, close - open."),
    _cause("interval for end", TIME, "What comes out near u = 1?",
           "u is multiplied by the time of closing; the length of the interval is close - open."),
    _cause("reversed", TIME, "What comes out at the beginning, and what at the end?",
           "Beginning and end are exchanged."),
    _cause("not clamped", TIME, "What happens before t0, and after t1?",
           "The thing does not stand still before t0 or after t1: clamp (t - t0) / (t1 - t0) to 0 and 1."),
    _cause("time not scaled", TIME, "Where is it halfway between t0 and t1?",
           "The time is not divided by the length of the interval, t1 - t0."),
    _cause("beginning missing", TIME, "Try a motion that does not begin at 0.",
           "The time t0 of the beginning is missing, above or below the fraction bar: (t - t0) / (t1 - t0)."),
    _cause("jumps", TIME, "Where is it halfway between t0 and t1?", "The thing jumps instead of moving evenly."),
    _cause("not even", TIME, "Where is it after a quarter of the time?", "The thing moves, but not evenly."),
    _cause("velocity for position", TIME, "Where is it at t1?",
           "p1 is taken for the way that is gone: the way from p0 to p1 is p1 - p0, and begins at p0."),
    _cause("sum missing", WEIGHT, "The weights of both techniques at one point add up to 1. Yours?",
           "It is not divided by the sum of both."),
    _cause("greater one takes all", WEIGHT, "Does the weight change smoothly with the densities?",
           "The larger density takes all: that is another heuristic."),
    _cause("squares", WEIGHT, "Is each of the densities squared, or none?",
           "The squares do not stand where the slide has them: p / (p + q), or p^2 / (p^2 + q^2)."),
    _cause("overflow", "Try very small and very large numbers.", "What is the square of 1e-200, and of 1e200?",
           "Squares run out of the range of numbers: divide p and q by one of them first."),
))  # fmt: skip
