"""Studies: error against run time, measured fairly and with intervals."""

from raylab.study.measure import study
from raylab.study.results import Study
from raylab.study.truth import Truth
from raylab.study.truth import find as find_truth

__all__ = ["Study", "Truth", "find_truth", "study"]
