"""Names of results with one number a case: the same in tables, study files, goals, targets, pages and the explorer.

A name is the variable, then body, contact and limit as far as the variable has them: `peak_stress_roller`,
`peak_stress_roller_2`, `normal_force_1`, `utilisation_guide_heat`. Without a contact it means the worse contact, or the
sum of both where the variable adds up.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage.limit import Limit
from trackroller.numerics.variable import BODIES, Variable
from trackroller.parameters import LIMITS, PARAMETERS
from trackroller.roller.dataset import VARIABLES

if TYPE_CHECKING:
    import xarray as xr

CONTACTS = ("1", "2")
PLACES = ("body", "contact", "limit")  # dimensions of a variable that a name can give, in the order of a name
_JOIN: dict[str, Any] = {"max": np.fmax.reduce, "min": np.fmin.reduce, "sum": np.nansum}


@dataclass(frozen=True)
class Part:
    """A part of a result variable with one number a case.

    Parameters
    ----------
    variable : Variable
        The variable.
    at : mapping of str to str
        Body, contact and limit, as far as the name gives them.
    """

    variable: Variable
    at: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def name(self) -> str:
        """Return the name."""
        return "_".join([self.variable.name, *(self.at[dim] for dim in PLACES if dim in self.at)])

    @property
    def words(self) -> str:
        """Return the words for a report, such as 'peak stress of the roller in contact 2'."""
        words = self.variable.label or self.variable.long_name
        body, contact, limit = (self.at.get(dim, "") for dim in PLACES)
        if body:
            if "the body" in words:
                words = words.replace("the body", f"the {body}")
            else:
                words = f"{words} of the {body}"
        if contact:
            words += f" in contact {contact}"
        elif self.variable.joined == "sum":
            words += " of both contacts"
        if limit in LIMITS:
            return f"{words}: {LIMITS[limit].title}"
        return words

    @property
    def of(self) -> str:
        """Return `roller`, `guide` or `pair`, whose value it is; an empty text if it is that of none of them."""
        return self.at.get("body", self.variable.of)

    def values(self, ds: xr.Dataset) -> xr.DataArray:
        """Return the values of every case; NaN where no contact has a value.

        Raises
        ------
        KeyError
            If the data set lacks the variable, or the contact, body or limit.
        """
        place: dict[str, Any] = dict(self.at)
        if "contact" in place:
            place["contact"] = int(place["contact"])
        part = ds[self.variable.name].sel(place, drop=True)
        if "contact" not in part.dims:
            return part
        joined: xr.DataArray = part.reduce(_JOIN[self.variable.joined], "contact", keep_attrs=True)
        return joined.where(part.notnull().any("contact"))


def parts_of(variable: Variable, limits: Iterable[Limit] = tuple(LIMITS.values())) -> Iterator[Part]:
    """Yield the parts of a variable that have one number a case, those without a contact first.

    Parameters
    ----------
    variable : Variable
        The variable; one over a patch or a section has no such parts.
    limits : iterable of Limit
        Limits whose parts are wanted, of a variable along limits.
    """
    if not set(variable.dims) <= set(PLACES):
        return
    contacts: tuple[str, ...] = ("",)
    if "contact" in variable.dims:
        contacts = CONTACTS
        if variable.joined:
            contacts = ("", *CONTACTS)
    bodies = BODIES if "body" in variable.dims else ("",)
    places = itertools.product(bodies, contacts)
    for body, contact in sorted(places, key=lambda place: bool(place[1])):
        for limit in limits if "limit" in variable.dims else (None,):
            if limit is None or body in limit.bodies:
                at = {"body": body, "contact": contact, "limit": limit.name if limit else ""}
                yield Part(variable, MappingProxyType({dim: key for dim, key in at.items() if key}))


PARTS: Mapping[str, Part] = MappingProxyType(
    {part.name: part for variable in VARIABLES.values() for part in parts_of(variable)}
)


def declared(name: str) -> Variable:
    """Return the declaration of a result by its name in a data set or by that of a part.

    A name of another solver has no declaration; the result counts as a life if its name says so.
    """
    if name in PARTS:
        return PARTS[name].variable
    if name in VARIABLES:
        return VARIABLES[name]
    if "life" in name:
        return Variable(name, "", (), "1", "", name, scale="log10", life=True)
    return Variable(name, "", (), "1", "", name, scale="natural", life=False)


def is_life(name: str) -> bool:
    """Return whether a result is a life."""
    return declared(name).life


def body_of(name: str) -> str:
    """Return `roller` or `guide`, whose value a result is; an empty text for any other result."""
    if name in PARTS:
        of = PARTS[name].of
    else:
        of = declared(name).of
    return of if of in BODIES else ""


def pair_first(lives: Iterable[str]) -> list[str]:
    """Return lives, those of the pair first, then those of the roller."""
    ranks = dict.fromkeys(lives, 2)
    for name in ranks.keys() & PARTS.keys():
        ranks[name] = {"pair": 0, "roller": 1}.get(PARTS[name].of, 2)
    return sorted(ranks, key=ranks.__getitem__)


def unit_of(name: str) -> str | None:
    """Return the unit of a result, of its variable, or of a parameter; None for any other name."""
    if name in PARTS:
        return PARTS[name].variable.units
    if name in VARIABLES:
        return VARIABLES[name].units
    if name in PARAMETERS:
        return PARAMETERS[name].unit
    return None
