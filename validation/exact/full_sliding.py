"""Forces of full sliding by quadrature, to compare the limit of large creepages with."""

from __future__ import annotations

import numpy as np

from trackroller.numerics.quadrature import clustered_rule


def complete_sliding(g: np.ndarray, slope: np.ndarray, nodes: int = 48) -> np.ndarray:
    """Integrate F_T, F_A, M_R over mu N for tractions opposite to the rigid slip, (n, 3).

    Parameters
    ----------
    g : numpy.ndarray, shape (n,)
        Axis ratio b/a of ellipses with c = sqrt(a b) = 1.
    slope : numpy.ndarray, shape (n,)
        xi/(phi c) > 0. The spin pole lies at x = -slope.
    nodes : int
        Nodes of each of both quadratures.
    """
    a, b = 1 / np.sqrt(g), np.sqrt(g)
    v, w = clustered_rule(nodes)
    pole = np.clip(-slope / a, -1.0, 1.0)
    f_a, m_r = np.zeros(g.size), np.zeros(g.size)
    for low, high in ((-1.0, pole), (pole, 1.0)):
        for vi, wi in zip(v, w, strict=True):
            x = low + (high - low) * vi
            half = np.sqrt(np.maximum(1.0 - x * x, 0.0))
            arm = a * x + slope
            # With y = b half t, the direction changes fast near t = 0. The form t = eps sinh(...) gives close nodes.
            eps = np.abs(arm) / np.maximum(b * half, 1e-300)
            top = np.arcsinh(1.0 / np.maximum(eps, 1e-13))
            for vj, wj in zip(v, w, strict=True):
                t = np.maximum(eps, 1e-13) * np.sinh(top * vj)
                root = np.hypot(arm, b * half * t)
                weight = wi * (high - low) * wj * top * np.maximum(eps, 1e-13) * np.cosh(top * vj)
                p = weight * 2.0 * half * half * np.sqrt(np.maximum(1.0 - t * t, 0.0)) * 1.5 / np.pi
                safe = np.where(root > 0, root, 1.0)
                f_a -= p * arm / safe
                m_r -= p * (a * x * arm + (b * half * t) ** 2) / safe
    return np.stack([np.zeros(g.size), f_a, m_r], axis=1)
