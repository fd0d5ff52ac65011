"""Grading: submissions run in a jail in another process, numbers come out, verdicts are made here."""
