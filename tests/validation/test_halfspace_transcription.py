"""The benchmark's transcription of eqs. (1)-(6) computes the same field as the package."""

import numpy as np
import pytest

from validation.benchmarks import published_transcription as transcription
from validation.exact.stresses import quadrature_on_ellipse


def test_all_styles_agree_and_approach_the_exact_field():
    """Printed, reused and shared forms give equal numbers, near the exact field at depth (Simpson, 40 points)."""
    contact = transcription.tractions_of_paper(0.6, 0.35, 1000.0, 0.5, 3**0.5 / 2, 6.0, 0.4, 0.0, 0.33)
    contact = transcription.Contact(contact.x, contact.y, 0.2 * contact.q_z, -0.1 * contact.q_z, contact.q_z, 0.33)

    def tractions(x, y):
        p = 1000.0 * np.sqrt(np.clip(1 - (x / 0.6) ** 2 - (y / 0.35) ** 2, 0, None))
        return 0.2 * p, -0.1 * p, p

    point = (0.1, -0.05, 0.2)
    found = [transcription.stress_at(contact, point, style) for style in transcription.STYLES]
    assert np.allclose(found[0], found[1], rtol=1e-9) and np.allclose(found[0], found[2], rtol=1e-9)
    assert np.allclose(found[0], quadrature_on_ellipse(tractions, 0.6, 0.35, point, 0.33), atol=1.5)


def test_simpson_weights_are_scipys():
    """Odd and even numbers of points, as scipy.integrate.simpson treats them."""
    from scipy.integrate import simpson

    for n in (40, 41):
        x = np.linspace(0, 2, n)
        assert transcription.simpson_weights(x) @ np.exp(x) == pytest.approx(simpson(np.exp(x), x=x), rel=1e-13)


def test_search_counts_its_evaluations():
    """The count by the package's kernels is within a factor of two of that of the transcription's own search."""
    contact = transcription.tractions_of_paper(0.6, 0.35, 1000.0, 0.5, 3**0.5 / 2, 6.0, 0.01, 0.3, 0.33, points=12)
    quick, whole = (
        transcription.time_transcription(contacts=[contact], sample=3, style="shared", full=full)
        for full in (False, True)
    )
    assert whole["measured"] and not quick["measured"]
    assert 0.5 < quick["evaluations"] / whole["evaluations"] < 2.0
