"""All benchmarks, one after the other: what `make bench` runs. Ratios are taken within one run of each."""

from __future__ import annotations

import importlib.util

import blur
import course
import left_out
import million
import startup
import throughput


def main() -> None:
    for benchmark in (startup, million, throughput, left_out, blur, course):
        print(f"\n{benchmark.__name__}: {(benchmark.__doc__ or '').splitlines()[0]}", flush=True)
        benchmark.main()
    if importlib.util.find_spec("mitsuba") is None:
        print("\nequal_time: skipped, Mitsuba is not installed (make crosscheck installs it)")
        return
    import equal_time

    print("\nequal_time: raylab against Mitsuba 3", flush=True)
    equal_time.main()


if __name__ == "__main__":
    main()
