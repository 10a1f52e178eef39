"""Ask about values of one contact that are allowed but unusual."""

from __future__ import annotations

from trackroller.one_patch.inputs import PatchInputs
from trackroller.roller.doubts import sentence_of_unusual

# ASSUME: MPa; polyethylene to tungsten carbide
YOUNGS_MODULUS = (500.0, 7e5)


def doubts_of_patch(inputs: PatchInputs) -> list[str]:
    """Return a sentence for each unusual Young's modulus, with the unit that may have been meant.

    Examples
    --------
    >>> from trackroller.one_patch.inputs import checked_patch
    >>> given = {"normal_force": 1000, "semi_axes": [1, 1], "friction_coefficient": 0.3}
    >>> given["materials"] = {"youngs_modulus": 210, "poisson_ratio": 0.3}
    >>> "write '210 GPa' or 210000" in doubts_of_patch(checked_patch(given))[0]
    True
    """
    by_name = {body.name: body.youngs_modulus for body in inputs.bodies}
    sentences = [
        sentence_of_unusual(
            "youngs_modulus", modulus, "MPa", YOUNGS_MODULUS, f" (material '{name}')"
        )
        for name, modulus in by_name.items()
    ]
    return [text for text in sentences if text]
