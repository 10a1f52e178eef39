"""The ladder of contact models: what the cheaper ones miss, in pairs of cases that differ in nothing else."""

from trackroller.report.comparison.errors import GOOD, QUANTITIES, errors
from trackroller.report.comparison.pairs import pairs
from trackroller.report.comparison.words import report_section, sentences

__all__ = ["GOOD", "QUANTITIES", "errors", "pairs", "report_section", "sentences"]
