"""The verdict of a study says of a life by wear what a sheet says: a placeholder, and a groove that is worn through."""

import trackroller as tr
from trackroller.report.words.verdict import verdict_sentences

STUDY = {
    "name": "worn",
    "base": {
        "motor_force": 0, "radial_force": -80, "axial_force": 5, "permissible_wear_depth": 0.05,
        "guide_overrollings_per_hour": 60, "guide_material": "C45",
    },
    "factors": {"roller_material": {"values": ["100Cr6", "C45"]}},
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces", "contact", "peak_stress", "life", "limits", "wear"],
}  # fmt: skip


def said(**base):
    results = tr.run(STUDY | {"base": STUDY["base"] | base})
    return results, {sentence.kind: sentence.text for sentence in verdict_sentences(results)}


def test_a_life_by_wear_names_its_placeholder_and_the_worn_groove():
    results, texts = said(friction_coefficient=0.3)
    assert results.verdict.best[0].ends == "wear"
    assert "wear coefficient of 100Cr6 on C45 is a placeholder" in texts["worn"]
    assert "Within this life the profiles wear beyond their run-in" in texts["worn"]


def test_a_life_by_fatigue_says_nothing_of_wear():
    results, texts = said(friction_coefficient=0.1, permissible_wear_depth=500)
    assert results.verdict.best[0].ends != "wear" != results.verdict.best[0].ends_high
    assert "worn" not in texts


def sampled(material):
    study = {
        "name": "scatter",
        "base": {"motor_force": 0, "roller_material": material, "friction_coefficient": 0.1},
        "factors": {"roller_profile_radius": {"values": [-6.6, -7]}, "axial_force": {"uniform": [0, 20]}},
        "design": "inner_outer", "samples": 64, "contact_model": "sliding", "accuracy": "preview",
        "outputs": ["forces", "contact", "peak_stress", "life"],
    }  # fmt: skip
    results = tr.run(study, progress=False)
    return {sentence.kind: sentence.text for sentence in verdict_sentences(results)}.get("scatter")


def test_a_sample_says_whether_the_scatter_of_its_material_is_known(tmp_path, monkeypatch):
    assert sampled("C45") == "The scatter of C45 itself is not counted."
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    text = "materials:\n  mine:\n    like: C45\n    scatter_in_cycles: {value: 4, unit: '-', source: own tests}\n"
    (tmp_path / "config" / "materials.yaml").write_text(text)
    assert "`material_scatter: true` adds it" in sampled("mine")


def test_a_value_under_base_that_no_limit_uses_is_named():
    _, texts = said(permissible_wear_depth=None, required_travel=50, guide_overrollings_per_hour=60)
    assert texts["not_checked"].endswith("; required_travel was given, but not used.")
    _, texts = said(friction_coefficient=0.3)
    assert "given, but not used" not in texts.get("not_checked", "")
