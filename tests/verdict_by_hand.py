"""The verdict of a study without a target, again from its rows by plain pandas."""

import math

import numpy as np
import pytest


def nine_of_ten(lives):
    """Return the life that nine of ten rows reach."""
    return np.sort(lives)[math.ceil(0.1 * len(lives)) - 1]


def check_verdict(found, frame, choices, conditions, life, weighted=True):
    """Compare the candidates that a verdict names with the rows of a study.

    Parameters
    ----------
    found : Verdict
    frame : pandas.DataFrame with the choices, the conditions, `valid` and the life; a row that is not valid counts as 0
    choices, conditions : names of columns
    life : name of the column that is compared
    weighted : whether the rows stand for the use, which those at the ends of ranges alone do not
    """
    frame = frame.assign(own=frame[life].where(frame["valid"], 0.0).fillna(0.0))
    if found.kind == "cannot_tell" and found.why == "conditions":
        sizes = frame.groupby(choices).size() if choices else [len(frame)]
        assert conditions and (min(sizes) < 20 or not weighted)
        return
    if found.kind == "give":
        if found.rest is not None:
            check_verdict(found.rest, frame, choices, conditions, life, weighted)
        return
    if conditions and not found.sampled:  # conditions that no candidate meets are left out
        frame = frame[frame.groupby(conditions)["own"].transform("max") > 0]
    groups = frame.groupby(choices, sort=False)["own"] if choices else frame.assign(one=1).groupby("one")["own"]
    low = groups.apply(nine_of_ten) if found.sampled else groups.min()
    if found.kind in ("none", "cannot_tell"):
        assert not len(low) or not (low > 0).any()
        return
    if found.sampled and not (low > 0).any():
        return  # conditions out of reach are left out of the ranking
    assert found.kind in ("build", "a_or_b", "lasts"), found.kind  # lives without a range
    assert found.best[0].low == pytest.approx(low.max(), rel=1e-12)
    for one in found.candidates:
        key = tuple(one.choices[name] for name in choices)
        own = low.iloc[0] if not choices else low.loc[key if len(key) > 1 else key[0]]
        if one.judged:
            assert one.low == pytest.approx(own, rel=1e-12)
    ties = sum(math.isclose(value, low.max(), rel_tol=1e-9) for value in low)
    assert len(found.best) >= ties and (found.why == "tie") == (len(found.best) == ties > 1)
