"""The ladder of contact models: what the cheaper ones miss, in pairs of cases that differ in nothing else."""

from trackroller.ladder.errors import GOOD, QUANTITIES, errors
from trackroller.ladder.pairs import pairs
from trackroller.ladder.words import report_section, sentences

__all__ = ["GOOD", "QUANTITIES", "errors", "pairs", "report_section", "sentences"]
