"""Plan: how many samples a render takes, checked before it begins."""

from __future__ import annotations

from dataclasses import dataclass

from raylab.errors import UserError

# Independent scrambles of a picture (all samplers but one), from which its error is estimated. Each more costs
# precision (1.3 times the variance of one scramble at 64 samples for two, 1.7 for four; 1.1 and 1.3 at 256), so few at
# first.
FEW_STREAMS, STREAMS, FEW_SAMPLES = 2, 4, 512
MAX_SAMPLES = 1 << 30  # of one stream: Sobol' numbers have 32 bits


@dataclass(frozen=True)
class Plan:
    """How many samples to take, checked: samples per stream, or a time, or an error."""

    streams: int
    samples: int = MAX_SAMPLES
    seconds: float = float("inf")
    relative_error: float = 0.0

    @classmethod
    def make(cls, sampler: str, spp: int | None, seconds: float | None, relative_error: float | None) -> Plan:
        given = [
            n for n, v in (("spp", spp), ("seconds", seconds), ("relative_error", relative_error)) if v is not None
        ]
        if sampler == "centre" and (spp not in (None, 1) or seconds or relative_error):
            raise UserError("the sampler 'centre' takes one sample of each pixel, further ones would be the same")
        if sampler == "centre":
            return cls(1, samples=1)
        if len(given) > 1:
            raise UserError(f"expected one of spp, seconds and relative_error, got {' and '.join(given)}")
        for name, value in (("spp", spp), ("seconds", seconds), ("relative_error", relative_error)):
            if value is not None and not (value > 0 and value < float("inf")):
                raise UserError(f"{name} must be positive, got {value}")
        streams = 1 if sampler == "independent" else STREAMS
        if relative_error is not None:
            streams = max(2, streams)  # two halves, see `raylab.stopping`
        if spp is None:
            return cls(streams, seconds=seconds or float("inf"), relative_error=relative_error or 0.0)
        if spp > MAX_SAMPLES or int(spp) != spp:
            raise UserError(f"spp must be a whole number up to {MAX_SAMPLES}, got {spp}")
        streams = min(streams, FEW_STREAMS) if spp <= FEW_SAMPLES else streams
        streams = next(r for r in range(streams, 0, -1) if spp % r == 0)
        return cls(streams, samples=int(spp) // streams)
