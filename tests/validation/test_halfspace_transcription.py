"""The benchmark's transcription of eqs. (1)-(6) computes the same field as the package."""

import numpy as np

from validation.benchmarks import published_transcription as transcription
from validation.exact.stresses import quadrature_on_ellipse


def test_all_styles_agree_and_approach_the_exact_field():
    """Printed and reused forms give equal numbers, near the exact field at depth (Simpson, 40 points)."""
    contact = transcription.tractions_of_paper(0.6, 0.35, 1000.0, 0.5, 3**0.5 / 2, 6.0, 0.4, 0.0, 0.33)
    contact = transcription.Contact(contact.x, contact.y, 0.2 * contact.q_z, -0.1 * contact.q_z, contact.q_z, 0.33)

    def tractions(x, y):
        p = 1000.0 * np.sqrt(np.clip(1 - (x / 0.6) ** 2 - (y / 0.35) ** 2, 0, None))
        return 0.2 * p, -0.1 * p, p

    point = (0.1, -0.05, 0.2)
    found = [transcription.stress_at(contact, point, style) for style in transcription.STYLES]
    assert np.allclose(found[0], found[1], rtol=1e-9)
    assert np.allclose(found[0], quadrature_on_ellipse(tractions, 0.6, 0.35, point, 0.33), atol=1.5)


def test_time_is_that_of_all_evaluations_of_the_search():
    """Two contacts take the evaluations of both searches, each of some hundred points."""
    contact = transcription.tractions_of_paper(0.6, 0.35, 1000.0, 0.5, 3**0.5 / 2, 6.0, 0.01, 0.3, 0.33, points=12)
    count = transcription.evaluations_of_search(contact)
    found = transcription.time_transcription([contact, contact], sample=3, style="reused")
    assert count > 100 and found["evaluations"] == 2 * count and found["seconds"] > 0
