"""The benchmark's transcription of eqs. (1)-(6) computes the same field as the package."""

import numpy as np
import pytest

import trackroller as tr
from validation.benchmarks import published_transcription as transcription
from validation.exact.stresses import quadrature_on_ellipse


@pytest.mark.slow
def test_all_styles_agree_and_approach_the_exact_field():
    """Printed and reused forms give equal numbers, near the exact field at depth (Simpson, 40 points)."""

    def tractions(x, y):
        p = 1000.0 * np.sqrt(np.clip(1 - (x / 0.6) ** 2 - (y / 0.35) ** 2, 0, None))
        return 0.2 * p, -0.1 * p, p

    x, y = np.linspace(-0.6, 0.6, 40), np.linspace(-0.35, 0.35, 40)
    contact = transcription.Contact(x, y, *tractions(*np.meshgrid(x, y)), 0.33)

    point = (0.1, -0.05, 0.2)
    found = [transcription.stress_at(contact, point, style) for style in transcription.STYLES]
    assert np.allclose(found[0], found[1], rtol=1e-9)
    assert np.allclose(found[0], quadrature_on_ellipse(tractions, 0.6, 0.35, point, 0.33), atol=1.5)


def test_time_is_that_of_all_evaluations_of_the_search():
    """Two contacts take the evaluations of both searches, each of some hundred points."""
    contacts = transcription.contacts_of_case(tr.Case(), points=12)
    count = sum(map(transcription.evaluations_of_search, contacts))
    found = transcription.time_transcription(contacts, "reused", sample=3)
    assert count > 200 and found["evaluations"] == count and found["seconds"] > 0
