"""The sizes of a drawing that give the axis distance of a roller, see
`trackroller.roller.aliases`.
"""

from __future__ import annotations

import math

from trackroller.numerics.parameter import Parameter

SIZES = {
    name: Parameter(
        name, "", "mm", math.nan, meaning, 0.0, open_lower=True, allow_missing=True, role="choice"
    )
    for name, meaning in (
        (
            "outer_radius",
            "outer radius of the roller; with the groove depth it gives the axis distance",
        ),
        ("groove_depth", "depth of the groove below the outer radius; with the outer radius"),
    )
}
