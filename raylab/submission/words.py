"""Words: types as students call them, and what Python's own messages mean in a shade().

A row is a pattern of the message, a sentence, an advice. What the pattern catches as {a} and {b} are types, put into
words; {name} is a name of the student's, {lines} where it is given a value.
"""

from __future__ import annotations

import re

Row = tuple[str, str, str]

_TYPES = (
    (r"u?int\d*|float\d*|Literal\[int\].*|int_|intp|numpy\.float64", "a number"),
    (r"Vec3", "a Vec3"),
    (r"bool|boolean|bool_", "True or False"),
    (r"none|NoneType", "None"),
    (r"Point.*", "a Point"),
    (r"AreaLight.*|PointLight.*|DirectionalLight.*", "a light"),
    (r"SceneData.*", "the scene"),
    (r"\w*Stream.*", "`rng`"),
    (r"Lambertian.*|Phong.*|RoughConductor.*|RoughPlastic.*", "a BRDF"),
    (r"Table.*", "a list of lights"),
    (r"(Uni)?Tuple\(.*|tuple", "a tuple"),
    (r"(readonly )?array\(.*|(numpy\.)?ndarray", "an array"),
    (r"(reflected )?list\(.*|list", "a list"),
    (r"unicode_type|Literal\[str\].*|str", "a text"),
    (r"Optional.*", "a value or None"),
    (r"Function.*|type\(.*|Dispatcher.*|builtin_function_or_method|function|method|Bound.*|Compiled", "a function"),
)  # fmt: skip
PARTS = {
    "Vec3": "x, y, z", "Point": "p (its place) and n (the normal)", "`rng`": "number() and square()",
    "a list of lights": "elements: for light in scene.lights:",
    "a light": "radiance, sample(x, u), pdf(x, y)", "the scene": "lights, points, suns and environment",
    "a BRDF": "k_d, eval(V, L), sample(V, N, u), pdf(V, w, N)",
}  # fmt: skip
_MADE = "A Vec3 is made by Vec3(x, y, z)."

PYTHON: tuple[Row, ...] = (
    (
        r"ZeroDivisionError",
        "This line divides by zero.",
        "Test before dividing. A squared distance of 0 means that the point on the light is x itself; a zero vector "
        "has no direction.",
    ),
    (
        r"(UnboundLocalError|NameError): .* variable '(?P<name>\w+)'",
        "`{name}` has no value here; it is only set on {lines}, which did not run.",
        "Give it a value before the if or the loop: {name} = 0.0, or {name} = black.",
    ),
    (r"NameError: name '(?P<name>\w+)' is not defined", "`{name}` is not defined.", "Check how it is written."),
    (
        r"IndexError: index (?P<i>-?\d+) is out of bounds for axis \d+ with size (?P<n>\d+)",
        "Index {i} is past the end: the array has {n} elements, and the first one has the index 0.",
        "",
    ),
    (r"IndexError: tuple index", "The index is past the end of the tuple.", "rng.square() has the parts [0] and [1]."),
    (r"IndexError: list index", "The index is past the end of the list.", "The first element has the index 0."),
    (r"IndexError", "The index is not one of this array: {raw}", "Indices are whole numbers from 0."),
    (
        r"unsupported operand type\(s\) for [-+*/@]*=?: '(NoneType|none)' and|operand .*: '\w+' and '(NoneType|none)'",
        "One side of this calculation is None, which is no number.",
        "Begin a sum with black (colours) or 0.0 (numbers), not with None.",
    ),
    (
        r"unsupported operand type\(s\) for (\+=?|-=?): '(int|float)' and 'Vec3'|"
        r"unsupported operand type\(s\) for (\+=?|-=?): 'Vec3' and '(int|float)'",
        "This line adds a number and a Vec3.",
        "A sum of colours begins with black: result = black. A grey is Vec3(a, a, a).",
    ),
    (
        r"unsupported operand type\(s\) for /=?: '(int|float)' and 'Vec3'",
        "This line divides a number by a Vec3.",
        "Divide by its length or by a component; only Vec3 / number and Vec3 / Vec3 are known.",
    ),
    (r"unsupported operand type\(s\) for @", "`@` is not known here.", "Write dot(a, b), or * to scale a vector."),
    (
        r"unsupported operand type\(s\) for \*\*.*'Vec3'",
        "A Vec3 cannot be raised to a power.",
        "Write a * a for the square of each component, dot(a, a) for the squared length.",
    ),
    (
        r"'(?P<a>\w+)' and '(Point|tuple)'|'Point' and '(?P<b>\w+)'|can only concatenate tuple",
        "This line calculates with a point or a tuple as if it were a vector.",
        "The place of the point x is x.p; y - x is the vector between two points. " + _MADE,
    ),
    (r"can't multiply sequence", "A tuple, list or text cannot be multiplied by a number.", _MADE),
    (
        r"unsupported operand type\(s\) for (?P<op>\S+).*: '(?P<a>[^']+)' and '(?P<b>[^']+)'",
        "This line combines {a} and {b} by {op}, which is not known.",
        "",
    ),
    (r"'Vec3' object is not subscriptable", "A Vec3 has no index.", "Its components are v.x, v.y and v.z."),
    (
        r"'(builtin_function_or_)?method' object is not subscriptable|cannot unpack non-iterable (method|function)",
        "This is a function; it must be called first.",
        "Write rng.square() with brackets.",
    ),
    (
        r"'(float|int)' object is not subscriptable",
        "A number has no index.",
        "Where u is asked for, a pair is due: rng.square(), not rng.number().",
    ),
    (r"'(?P<a>[^']+)' object is not subscriptable", "{a} has no index.", ""),
    (
        r"'(?P<a>[^']+)' object is not callable",
        "{a} is not a function, and cannot be called.",
        "Perhaps a * is missing before a bracket.",
    ),
    (
        r"'tuple' object does not support item assignment",
        "A tuple cannot be changed.",
        "Take it apart (u1, u2 = rng.square()) and make a new one: (a, b).",
    ),
    (
        r"'(?P<a>[^']+)' object does not support item assignment|assignment destination is read-only",
        "Arguments cannot be changed.",
        "Copy first, or make a new vector: Vec3(x, y, z).",
    ),
    (
        r"'(?P<op>[<>=!]+)' not supported between instances of '(?P<a>[^']+)' and '(?P<b>[^']+)'",
        "{a} and {b} cannot be compared by {op}.",
        "Compare a number: a component (c.x), dot(a, b), length(a) or luminance(c). max(0.0, ...) is for numbers.",
    ),
    (
        r"operand 'Vec3' does not support ufuncs",
        "`numpy` cannot calculate with a Vec3.",
        "Begin a sum with black instead of an array; for functions take the components: Vec3(f(v.x), f(v.y), f(v.z)).",
    ),
    (
        r"must be real number, not (?P<a>\w+)",
        "This function is for numbers, and is given {a}.",
        "Take the components one by one: Vec3(f(v.x), f(v.y), f(v.z)).",
    ),
    (r"bad operand type for abs\(\): 'Vec3'", "`abs` is for numbers.", "For a vector write absolute(v), or length(v)."),
    (
        r"Vec3(\.__init__)?\(\) (missing|takes)",
        "Vec3 takes three numbers.",
        "Write Vec3(x, y, z), not Vec3([x, y, z]).",
    ),
    (
        r"(?P<f>\w+)\(\) missing \d+ required positional arguments?: (?P<what>.*)",
        "`{f}` needs more arguments: {what} is missing.",
        "",
    ),
    (r"(?P<f>\w+)\(\) takes .* given", "`{f}` is given too many or too few arguments: {raw}", ""),
    (r"got an unexpected keyword argument '(?P<what>\w+)'", "No argument is called `{what}`.", ""),
    (
        r"not enough values to unpack \(expected (?P<n>\d+), got (?P<m>\d+)\)",
        "On the left of = stand {n} names, on the right {m} values.",
        "rng.square() gives two numbers; light.sample(x, u) gives y and p_y.",
    ),
    (
        r"too many values to unpack \(expected (?P<n>\d+)",
        "On the left of = stand {n} names, on the right more values.",
        "rng.square() gives two numbers; light.sample(x, u) gives y and p_y.",
    ),
    (r"cannot unpack non-iterable (?P<a>\w+)", "{a} cannot be taken apart into several names.", ""),
    (r"'(?P<a>[^']+)' object is not iterable", "A for loop cannot run over {a}.", "Write for i in range(n):"),
    (r"object cannot be interpreted as an integer", "A whole number is needed here.", "Write int(...) around it."),
    (
        r"math domain error",
        "A square root or a logarithm is taken of a negative number.",
        "Rounding may bring 1 - z * z just below 0: write math.sqrt(max(0.0, ...)).",
    ),
    (
        r"FloatingPointError: (divide by zero|invalid value)",
        "This line divides by zero, or takes the root of a negative number.",
        "Test before dividing; write np.sqrt(np.maximum(0.0, ...)).",
    ),
    (r"OverflowError", "The number becomes too large.", "Look for exp or ** of a large number."),
    (
        r"shapes \((?P<n>[^)]*)\) \((?P<m>[^)]*)\)|shapes? mismatch|not aligned",
        "The arrays on this line have different sizes.",
        "A vector has three numbers; Vec3 is made for them.",
    ),
    (
        r"'(list|tuple|ndarray|float|int|NoneType)' object has no attribute '[xyz]'",
        "A Vec3 is expected here.",
        _MADE,
    ),
    (
        r"'tuple' object has no attribute '(p|n|radiance)'",
        "A point is expected here, and a tuple is given.",
        "light.sample gives two things: y, p_y = light.sample(x, rng.square()).",
    ),
    (
        r"'Vec3' object has no attribute '(p|n|slack|tilt)'",
        "A point is expected here, and a Vec3 is given.",
        "Where surfaces meet, write the points themselves: shadow(scene, x, y), dist_sqr(x, y).",
    ),
    (
        r"'Point' object has no attribute '[xyz]'",
        "A Vec3 is expected here, and a point is given.",
        "y - x is the vector from x to y; x.p is the place of x, x.n the normal there.",
    ),
    (r"'(?P<a>[^']+)' object has no attribute '(?P<name>\w+)'", "There is no `.{name}` in {a}.", "{parts}"),
    (r"AssertionError", "The assertion on this line does not hold.", ""),
)


def in_words(name: str) -> str:
    """A type, by Python's or the compiler's name, as students call it; other text as it is."""
    return next((words for pattern, words in _TYPES if re.fullmatch(pattern, name)), name)


def parts_of(name: str) -> str:
    """What an object of the type has."""
    words = in_words(name)
    known = PARTS.get(words.removeprefix("a ") if words not in PARTS else words)
    return f"It has {known}." if known else ""
