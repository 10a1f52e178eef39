"""Record what a version of `trackroller` computes, and compare two such recordings.

The recorder uses the public interface only, so it runs with old and new checkouts whose internal modules differ. Run it
in the root of the checkout that is to be recorded::

    python -m validation.same_numbers record before.npz
    python -m validation.same_numbers compare before.npz after.npz --tolerance 1e-12

A checkout that lacks this package is recorded from its own root; `PYTHONPATH` then names the checkout that has the
package.
"""

import os

# One thread makes the order of every sum repeatable. The limit must stand before NumPy is loaded.
for _name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
