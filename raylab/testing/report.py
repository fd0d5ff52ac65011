"""Report: what a test found, and how to repeat it."""

from __future__ import annotations

from dataclasses import dataclass

from raylab.stats.verdict import Outcome, Verdict


@dataclass(frozen=True)
class Report:
    """A verdict for each channel, the samples that were drawn for them, the time, and what replays the test."""

    name: str
    verdicts: tuple[Verdict, ...]
    samples: int
    seconds: float  # for drawing and deciding
    token: str
    findings: tuple[str, ...] = ()  # what is wrong beyond the verdicts, in words
    preparing: float = 0.0  # seconds for the scene and its kernel

    @property
    def outcome(self) -> Outcome:
        """FAIL if anything was found; else the worst of the verdicts: FAIL before INCONCLUSIVE before PASS."""
        outcomes = {verdict.outcome for verdict in self.verdicts}
        if self.findings or "FAIL" in outcomes:
            return "FAIL"
        return "INCONCLUSIVE" if "INCONCLUSIVE" in outcomes else "PASS"

    @property
    def detectable(self) -> float:
        """The smallest bias, as a share of the truth, that would have been seen in every channel."""
        relative = [v.detectable / abs(v.truth) if v.truth else float("nan") for v in self.verdicts]
        return max(relative, default=float("nan"))

    def __str__(self) -> str:
        lines = [f"{self.outcome}  {self.name}: {self.samples} samples, {self.seconds:.2g} s, replay {self.token}"]
        return "\n".join(lines + [f"  {line}" for line in (*self.findings, *self.verdicts)])
