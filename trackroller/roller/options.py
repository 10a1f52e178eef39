"""Check the options of a solution, and choose the contact model that solves a case."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, make_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.damage import checked_limits, first_limit
from trackroller.errors import Collector, InputError
from trackroller.numerics.plain import plain
from trackroller.parameters import OPTIONS
from trackroller.parameters.accuracy import Accuracy, Tolerance, settings_of, tolerance_of
from trackroller.parameters.contact_models import DECLARED
from trackroller.roller.stop import parse_condition

if TYPE_CHECKING:
    import xarray as xr

_Fields = make_dataclass(
    "_Fields",
    [(option.name, Any, field(default=option.default)) for option in OPTIONS.values()],
    frozen=True,
)


@dataclass(frozen=True)
class Options(_Fields):  # type: ignore[misc, valid-type]
    """Checked options of a solution, one field for each entry of `trackroller.parameters.OPTIONS`.

    Raises
    ------
    InputError
        If a value is not allowed, or if two options exclude each other.
    """

    def __post_init__(self) -> None:
        wrong = Collector()
        for option in OPTIONS.values():
            with wrong.part():
                value = plain(getattr(self, option.name), option.name)
                if not isinstance(value, Accuracy):
                    value = option.check(value)
                object.__setattr__(self, option.name, value)
                if option.kind == "condition" and value is not None:
                    parse_condition(value)
        refused = {error.field.split(".")[0] for error in wrong.errors}
        if not refused & {"accuracy", "contact_model", "outputs"}:
            with wrong.part():
                check_accuracy(self.accuracy, self.contact_model, self.outputs)
        wrong.check()
        check_pairs(self.hertz, self.normal, self.slip_terms, self.contact_model)
        check_not_checked(self.outputs, self.not_checked)
        check_spin_model((self.spin_model,), (self.contact_model,))

    @property
    def settings(self) -> Accuracy:
        """Return the discretisation of each stage; stages outside the walk of a tolerance take that
        of the default.
        """
        if isinstance(self.accuracy, Accuracy):
            return self.accuracy
        if self.tolerance is not None:
            rung = OPTIONS["accuracy"].default
        else:
            rung = self.accuracy
        return settings_of(rung, DECLARED[self.contact_model].rough_peaks)

    @property
    def tolerance(self) -> Tolerance | None:
        """Return the tolerances that are met case by case, None if every case has the same
        settings.
        """
        return tolerance_of(self.accuracy, self.outputs)

    def changed(self, **values: Any) -> Options:
        """Return the options with other values for some of them."""
        if all(getattr(self, name) == value for name, value in values.items()):
            return self
        return Options(**{**vars(self), **values})

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of a result that record the options."""
        values = {
            o.name: o.attribute(getattr(self, o.name), self.contact_model) for o in OPTIONS.values()
        }
        return {name: value for name, value in values.items() if value is not None}


def options_of_cases(
    cases: xr.Dataset, given: Mapping[str, Any]
) -> tuple[list[dict[str, Any]], np.ndarray]:
    """Return the different options of a design's cases, and the index of each case's options, shape
    (n,).

    Parameters
    ----------
    cases : xarray.Dataset
        Cases along `case`. The attribute `options` (JSON) holds what the study file says, and a
        coordinate that is called like an option holds the option of each case.
    given : mapping
        Options of the call, which take precedence over the attribute.

    Raises
    ------
    InputError
        If the call gives an option that the cases vary.
    """
    stated = json.loads(cases.attrs.get("options", "{}")) | given
    varying = [name for name in OPTIONS if name in cases.coords]
    for name in varying:
        if name in given:
            levels = ", ".join(dict.fromkeys(map(str, np.atleast_1d(cases[name].values))))
            remedy = f"Leave {name} out, or choose the cases with one value of it."
            raise InputError(
                name, given[name], f"the option of the cases, which vary it ({levels})", remedy
            )
    if not varying:
        return [stated], np.zeros(cases.sizes.get("case", 1), dtype=int)
    keys = list(zip(*[np.atleast_1d(cases[name].values).tolist() for name in varying], strict=True))
    known = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    different = [stated | dict(zip(varying, key, strict=True)) for key in known]
    for options in different:  # a grid also pairs a spin model with contact models that have none
        if not OPTIONS["spin_model"].applies(
            options.get("contact_model", OPTIONS["contact_model"].default)
        ):
            options["spin_model"] = OPTIONS["spin_model"].default
    return different, np.array([known[key] for key in keys])


def check_accuracy(accuracy: Any, contact_model: str, outputs: Collection[str]) -> None:
    """Refuse a tolerance that is too small, of a quantity that is not computed, or of a model
    without known errors.

    Parameters
    ----------
    accuracy, contact_model, outputs : object, str, collection of str
        Checked values of these options.

    Raises
    ------
    InputError
        See `Tolerance.read`; and if the declaration of the contact model does not say that its
        errors are known.
    """
    if tolerance_of(accuracy, outputs) is not None and not DECLARED[contact_model].known_errors:
        allowed = (
            f"one of {', '.join(OPTIONS['accuracy'].values)}: the errors of {contact_model} "
            "were not measured"
        )
        raise InputError("accuracy", accuracy, allowed)


def check_pairs(hertz: str, normal: str, slip_terms: Collection[str], contact_model: str) -> None:
    """Refuse options that exclude each other.

    Parameters
    ----------
    hertz, normal, slip_terms, contact_model : str or collection of str
        Values of these options; see `trackroller.parameters.OPTIONS`.

    Raises
    ------
    InputError
        If non-Hertzian patches meet the published table of Hertz's ellipse, or the contact model
        does not serve the normal problem or a slip term.
    """
    if normal == "halfspace" and hertz != "exact":
        allowed = "exact with normal: halfspace, which solves patch and pressure itself"
        raise InputError(
            "hertz", hertz, allowed, "Leave hertz out, or take normal: hertz (with circles)."
        )
    declared = DECLARED[contact_model]
    declared.check("normal", normal)
    for term in slip_terms:
        declared.check("slip_terms", term)


def check_not_checked(outputs: Collection[str], not_checked: Collection[str]) -> None:
    """Refuse to leave out every limit where the outputs ask for limits.

    Parameters
    ----------
    outputs, not_checked : collection of str
        Values of these options.

    Raises
    ------
    InputError
        If no limit is left.
    """
    if first_limit.GROUP in outputs and not checked_limits(outputs, not_checked):
        remedy = f"Name fewer limits, or remove {first_limit.GROUP} from outputs."
        wrong = f"leaves out every limit, and the outputs ask for {first_limit.GROUP}"
        raise InputError("not_checked", ", ".join(not_checked), "", remedy, wrong)


def check_surface(contact_model: str, friction_law: object, film: float) -> None:
    """Refuse a friction law or a film that the contact model does not serve.

    Parameters
    ----------
    contact_model : str
        Value of this option.
    friction_law : object
        The friction law of a case; "" or None stands for constant friction.
    film : float
        Flexibility of the film of a case [mm^3/N]; 0 is no film.

    Raises
    ------
    InputError
        If the declaration of the contact model does not say that it serves them.
    """
    declared = DECLARED[contact_model]
    if friction_law and not declared.friction_laws:
        remedy = "Take contact_model: kalker, or leave friction_law out."
        allowed = f"constant friction with contact_model: {contact_model}"
        raise InputError("friction_law", friction_law, allowed, remedy)
    if film > 0.0 and not declared.films:
        remedy = "Take contact_model: kalker, or leave layer_flexibility out."
        allowed = f"0 (no film) with contact_model: {contact_model}"
        raise InputError("layer_flexibility", film, allowed, remedy)


def check_spin_model(spin_models: Sequence[str], contact_models: Sequence[str]) -> None:
    """Refuse a position of the spin pole that no contact model uses.

    Parameters
    ----------
    spin_models, contact_models : sequence of str
        Values of these options: one each, or the levels of a study.

    Raises
    ------
    InputError
        If a spin model other than the default is given without the contact model that it belongs
        to.
    """
    option = OPTIONS["spin_model"]
    if set(spin_models) != {option.default} and not any(map(option.applies, contact_models)):
        raise InputError(
            "spin_model",
            ", ".join(spin_models),
            f"only {option.default} with contact_model: {', '.join(contact_models)}, which finds "
            "the spin pole itself",
            f"Take contact_model: {option.models[0]}, or leave spin_model out.",
        )


def model_in_use(options: Options, friction_law: str, film: float = 0.0) -> str:
    """Return the contact model that solves a case, which may differ from the wanted one.

    Parameters
    ----------
    options : Options
        Options of the solution.
    friction_law : str
        The friction law of the case as canonical JSON, "" for constant friction.
    film : float
        Flexibility of the film of the case [mm^3/N]; 0 is no film.

    Returns
    -------
    str
        Name of the contact model.

    Notes
    -----
    A cheaper model stands in (`kalker_table` for `kalker`) at accuracy preview, if it serves the
    normal problem, the slip, the friction and the film of the case. The result names it in
    `contact_model_used`.
    """
    own = DECLARED[options.contact_model]
    if not own.cheaper or options.settings.name != "preview":
        return own.name
    other = DECLARED[own.cheaper]
    serves = options.normal in other.normals and set(options.slip_terms) <= set(other.slip_terms)
    serves = serves and (other.films or film == 0.0)
    if serves and (other.friction_laws or law_of(friction_law).is_constant):
        return other.name
    return own.name
