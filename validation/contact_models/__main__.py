"""Solve and report the comparison of the contact models: python -m validation.contact_models FOLDER.

The study is `validation/config/contact_models.yaml`; its results stand in `FOLDER/study`, and
`contact_models.json` holds its errors. With `--small`, four designs at accuracy `preview` show that it runs.
"""

import json
import sys
from pathlib import Path

import yaml

from trackroller.files import write_text
from validation.contact_models.product import compare

STUDY = Path(__file__).resolve().parents[1] / "config" / "contact_models.yaml"
FEW = {"friction_coefficient": {"values": [0.05, 0.3]}, "motor_force": {"values": [0, -15]}}

if __name__ == "__main__":
    folder, study = Path(sys.argv[1]), yaml.safe_load(STUDY.read_text(encoding="utf-8"))
    if "--small" in sys.argv:
        study |= {"factors": FEW, "accuracy": "preview"}
    write_text(folder / "contact_models.json", json.dumps(compare(study, folder), indent=1) + "\n")
