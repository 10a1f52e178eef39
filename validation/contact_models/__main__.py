"""Solve, draw and report the comparison of the contact models: python -m validation.contact_models FOLDER.

The study is `validation/config/contact_models.yaml`; its name becomes that of the folder. With `--small`, four designs
at accuracy `preview` show that it runs.
"""

import sys
from pathlib import Path

import yaml

from validation.contact_models.product import compare

STUDY = Path(__file__).resolve().parents[1] / "config" / "contact_models.yaml"
FEW = {"friction_coefficient": {"values": [0.05, 0.3]}, "motor_force": {"values": [0, -15]}}

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    study = yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    if "--small" in sys.argv:
        study |= {"factors": FEW, "accuracy": "preview"}
    path = folder / "contact_models.yaml"
    path.write_text(yaml.safe_dump(study, sort_keys=False), encoding="utf-8")
    compare(path, folder)
