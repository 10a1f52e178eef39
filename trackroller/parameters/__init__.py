"""Declare every parameter of a case and every option of the solver, each exactly once.

`PARAMETERS` holds the numbers that describe a case, `OPTIONS` what a solution can be asked for. The
checks of input, the fields and the JSON schema of a study file, the keys of `--set` and their help,
the fingerprint of a case, the attributes of a result and the tables of the documentation are
derived from these two lists. A new option is declared in `parameters/options.py`, added to the
signature of `trackroller.solve` (a test compares the two), and used where it matters.

Units here are those that a user writes: degrees, m/min and hours. The solver works in N, mm, MPa
and rad.
"""

from __future__ import annotations

from trackroller.damage import LIMITS, add_own
from trackroller.damage.pair import FIRST_TO_FAIL
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import BODIES, REGIMES

# before the modules below read LIMITS; files of a user's own may import the names above from here
add_own()

from trackroller.parameters.contact_models import CONTACT_MODELS, EXACTNESS  # noqa: E402
from trackroller.parameters.numbers import OF_LIMITS, PARAMETERS  # noqa: E402
from trackroller.parameters.options import OPTIONS, Option, options_text, words_of  # noqa: E402

__all__ = [
    "BODIES",
    "CONTACT_MODELS",
    "EXACTNESS",
    "FIRST_TO_FAIL",
    "LIMITS",
    "OF_LIMITS",
    "OPTIONS",
    "PARAMETERS",
    "REGIMES",
    "Option",
    "Parameter",
    "options_text",
    "words_of",
]

OUTPUT_GROUPS = words_of("outputs")
SPIN_MODELS = words_of("spin_model")
ACCURACIES = words_of("accuracy")
LIFE_RULES = words_of("life_rule")
DEFAULT_OUTPUTS: tuple[str, ...] = OPTIONS["outputs"].default
REGIME_LABELS = ("rolling", "full slip", "lift-off", "failed")  # the same in prose
MATERIAL_FIELDS = ("roller_material", "guide_material")
# entries of a case that are mappings; in columns they stand as canonical JSON, '' for none
MECHANICAL_MAPPINGS = {
    "friction_law": "friction as a function of the slip speed in mm/s: {kind: constant | linear | "
    "exponential | table, "
    "...}; it scales friction_coefficient, which holds at rest; not given: constant",
    "guide_profile": "drawn or measured cross-section of the guide, for normal: halfspace; not "
    "given: the circle",
    "roller_profile": "drawn or measured cross-section of the roller, for normal: halfspace; not "
    "given: the circle",
}
MAPPING_FIELDS: dict[str, str] = MECHANICAL_MAPPINGS | {
    own.name: own.meaning for limit in LIMITS.values() for own in limit.mappings
}
ROLES = ("choice", "condition")  # who sets a parameter: the designer, or the use of the roller
ROLE_OF = {name: parameter.role for name, parameter in PARAMETERS.items()} | {
    **dict.fromkeys((*MATERIAL_FIELDS, "material_pair", *MAPPING_FIELDS), "choice"),
    "friction_law": "condition",
}
FRICTION_LEVELS = PARAMETERS["friction_coefficient"].words
