"""Testing: one line for each claim about an estimator; trials, samples and bets are put together here.

    report = Examiner().unbiased("area_diffuse", my_shade, trial="polygons")
    print(report)

In reading order: `report` (what a test found), `source` (where samples come from), `deciding` (claims about columns of
samples), `relations` (the same before and after a change of the scene), `examiner` (all that can be claimed).
"""

from raylab.errors import UserError
from raylab.testing.examiner import Examiner
from raylab.testing.report import Report
from raylab.testing.source import Source
from raylab.trials import Answer

__all__ = ["Answer", "Examiner", "Report", "Source", "UserError"]
