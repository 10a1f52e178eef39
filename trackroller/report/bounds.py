"""The requirements that the output of an answer is compared with."""

from __future__ import annotations

from trackroller.results.answer import Answer, Required
from trackroller.results.life_columns import FIRST_LIMIT, OF_PAIR


def required_of_output(answer: Answer) -> list[Required]:
    """Return what is required of the output of an answer.

    A required life of the pair is compared with the life to the first limit, as its verdict is.
    """
    name = answer.output[0]
    names: tuple[str, ...] = (name,)
    if name == FIRST_LIMIT[0]:
        names = OF_PAIR
    return [one for one in answer.required if one.output in names]


def bounds_of_output(answer: Answer) -> list[float]:
    """Return the smallest and the largest value that is enough, of each of these requirements;
    infinite without one.
    """
    return [end for one in required_of_output(answer) for end in (one.least, one.most)]
