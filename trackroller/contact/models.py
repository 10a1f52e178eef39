"""The contact models by name, each a class behind `protocol.ContactModel` that is registered once.

A model gives the contact law of the equilibrium, and the tractions of given patches on a grid.
"""

from __future__ import annotations

import hashlib
import inspect
import sys
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.kalker.kalker_model import KalkerModel
from trackroller.contact.normal.patches import NormalSolver
from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Elastic
from trackroller.contact.rollers import Rollers
from trackroller.contact.sliding_model import SlidingModel
from trackroller.contact.table.table_model import TableModel
from trackroller.errors import InputError, check_names
from trackroller.parameters.accuracy import Accuracy
from trackroller.parameters.contact_models import declare

CLASSES: dict[str, type[ContactModel]] = {
    model.declaration.name: model for model in (SlidingModel, KalkerModel, TableModel)
}


def register(model: type[ContactModel]) -> type[ContactModel]:
    """Add a contact model to `solve`, study files, command line and plan; usable as a decorator of
    its class.

    Parameters
    ----------
    model : type
        Subclass of `ContactModel` with a `declaration`; it is called with `Rollers` and `Accuracy`.

    Returns
    -------
    type
        The class.

    Raises
    ------
    InputError
        If another model has the name.

    Notes
    -----
    The model exists in this process. The identity of stored cases holds its name and the source of
    its module, so that a changed model solves its cases anew. Other modules that it imports do not
    count.
    """
    declare(replace(model.declaration, source=_digest(model)))
    CLASSES[model.declaration.name] = model
    return model


def _digest(model: type[ContactModel]) -> str:
    """Return a digest of the source of a model's module, or of the code of its methods if there is
    no source.
    """
    try:
        source = inspect.getsource(sys.modules[model.__module__])
    except (OSError, TypeError):
        codes = [part.__code__ for part in vars(model).values() if inspect.isfunction(part)]
        constants = [
            [value for value in code.co_consts if not inspect.iscode(value)] for code in codes
        ]
        source = repr(
            [(code.co_code, code.co_names, own) for code, own in zip(codes, constants, strict=True)]
        )
    return hashlib.sha256(source.encode()).hexdigest()


def contact_model(
    name: str,
    settings: Accuracy,
    elastic: Elastic,
    spin_model: str = "skewed",
    law: FrictionLaw | None = None,
    travel_speed: np.ndarray | float = 1000.0,
    slip_terms: Collection[str] = (),
    patches: NormalSolver | None = None,
) -> ContactModel:
    """Return the contact model `name` for n rollers.

    Parameters
    ----------
    name : str
        Name of a registered model. Its declaration says which patches, slips and friction it
        serves.
    settings : Accuracy
        Discretisation.
    elastic : Elastic
        Combined constants of the rollers, arrays (n,).
    spin_model : str
        Assumption on the spin pole, for 'sliding' only.
    law : FrictionLaw, optional
        Friction over its value at rest by slip speed; constant if not given.
    travel_speed : ndarray, shape (n,), or float
        Travel speed of the rollers [mm/s].
    slip_terms : collection of str
        With 'profile' the rigid slip follows the guide's profile instead of its tangent; 'sliding'
        always does. 'curve' changes the slip that a model is given, see `slip.Slip`.
    patches : NormalSolver, optional
        Solver of the normal problem of the rollers; Hertz's ellipses if not given.

    Returns
    -------
    ContactModel
        The model.

    Raises
    ------
    InputError
        For an unknown name, or a model that does not serve solved patches.
    """
    check_names("contact_model", [name], list(CLASSES))
    travel = np.array(
        np.broadcast_to(np.asarray(travel_speed, float), np.shape(elastic.shear_modulus))
    )
    given = Rollers(elastic, law or constant(), travel, spin_model, "profile" in slip_terms)
    if patches is None:
        return CLASSES[name](given, settings)
    on_patches = CLASSES[name].on_solved_patches
    if on_patches is None:
        raise InputError("normal", "halfspace", f"hertz only, with contact_model: {name}")
    return on_patches(given, patches)
