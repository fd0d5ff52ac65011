"""What went wrong, said to the person who can mend it."""

from __future__ import annotations


class UserError(ValueError):
    """Bad input: the message says what was expected and what came. The command line exits with code 2."""


class SceneError(UserError):
    """A scene file or a scene built in Python that cannot be used."""


class InvalidSampleError(UserError):
    """A sample of a picture is not finite, and the render is strict."""
