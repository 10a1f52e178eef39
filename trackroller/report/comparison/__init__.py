"""Compare contact models: errors of the cheaper models, in pairs of cases that agree in all other inputs."""

from trackroller.report.comparison.pairs import GOOD, QUANTITIES, errors, pairs
from trackroller.report.comparison.words import report_section, sentences

__all__ = ["GOOD", "QUANTITIES", "errors", "pairs", "report_section", "sentences"]
