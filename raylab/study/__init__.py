"""Studies: error against run time, measured fairly and with intervals."""

from raylab.study.measure import study
from raylab.study.results import Study

__all__ = ["Study", "study"]
