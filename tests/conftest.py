"""What several test files ask pytest for: the command line."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from raylab import cli


@dataclass
class Done:
    """What a command left behind."""

    code: int
    stdout: str
    stderr: str


@pytest.fixture
def run(monkeypatch, capsys) -> Callable[..., Done]:
    """Run the command line in this process, which is fast."""

    def call(*arguments: object) -> Done:
        monkeypatch.setattr(sys, "argv", ["raylab", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            cli.main()
        return Done(left.value.code, *capsys.readouterr())

    return call
