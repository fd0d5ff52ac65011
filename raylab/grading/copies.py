"""Copies: how much of a submission stands letter by letter in raylab's own solution. For the staff; it decides nothing.

What the slide prescribes is alike in all right submissions, so a high number is a question and no answer. Nothing of
the submission is parsed: lines are compared as text, without spaces and comments.
"""

from __future__ import annotations

import re

from raylab.grading.assignment import Assignment

SHORT = 12  # characters; shorter lines are everybody's
SUSPICIOUS = 0.9


def lines(text: str) -> set[str]:
    squeezed = (re.sub(r"\s+", "", line.split("#")[0]) for line in text.splitlines())
    return {line for line in squeezed if len(line) >= SHORT}


def likeness(source: bytes, assignment: Assignment) -> dict[str, float]:
    """For each task the share of the solution's lines that are in the submission; {} where the solutions are not."""
    from raylab.grading.stub import solutions

    known, handed_in = solutions(), lines(source.decode("utf-8", "replace"))
    found = {}
    for task in assignment.tasks:
        if task.id in known:
            body = lines(known[task.id].text.split('"""')[-1])
            found[task.id] = len(body & handed_in) / len(body) if body else 0.0
    return found
