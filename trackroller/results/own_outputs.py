"""Outputs of a study's own, the key `own`: expressions of results and inputs, computed from the
solved cases.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters import REGIMES, expressions
from trackroller.results.constraints import quantity_of
from trackroller.study.file.study import Study
from trackroller.study.outputs import case_dims


def with_own_outputs(study: Study, data: xr.Dataset) -> xr.Dataset:
    """Return the results of a study with its own outputs, each a variable over the cases.

    Parameters
    ----------
    study : the study, whose key `own` holds an expression by name
    data : its results

    Returns
    -------
    The same results with a variable for each expression, NaN where a value that it needs is NaN;
    its unit is not known.
    """
    dims = case_dims(data, study.factors)
    shape = [data.sizes[name] for name in dims]
    regimes = {name: name for name in REGIMES}
    for name, text in study.config.own.items():
        needed = expressions.names(text, f"own.{name}") - set(REGIMES)
        columns = {
            one: quantity_of(data, dims, one, study.config.base, study.factors)[0] for one in needed
        }
        values = expressions.evaluate(text, columns | regimes, f"own.{name}")
        whole = np.broadcast_to(values, (int(np.prod(shape)),)).reshape(shape)
        words = {
            "long_name": name.replace("_", " "),
            "units": "1",
            "comment": f"own output: {text}",
        }
        data = data.assign({name: (dims, whole.astype(float), words)})
    return data
