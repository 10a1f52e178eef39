"""The recipe for a damage limit in CONTRIBUTING works as it stands there."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """
import json
import trackroller as tr
from trackroller.parameters import OPTIONS
steel = {"like": "1.7225-normalised", "permissible_pressure": 500.0}
case = tr.Case(motor_force=0, roller_material=steel)
found = tr.solve(case, outputs=("lining", "contact"), contact_model="sliding")
used, pressure = found.lining_utilisation, found.max_pressure
assert OPTIONS["outputs"].values["lining"].startswith("contact pressure")
assert used.dims == ("contact", "body") and used.attrs["symbol"] == "p/p_zul"
print(json.dumps([used.sel(body=body).values.tolist() for body in ("roller", "guide")] + [pressure.values.tolist()]))
"""


@pytest.mark.slow
def test_a_limit_of_one_file_reaches_the_data_set(tmp_path):
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    recipe = text.partition("## Add a damage limit")[2].partition("\n## ")[0]
    assert len(recipe.splitlines()) < 54 and len(re.findall(r"```python", recipe)) == 1
    shutil.copytree(ROOT / "trackroller", tmp_path / "trackroller")
    room = tmp_path / "trackroller" / "damage"
    (room / "lining.py").write_text(re.search(r"```python\n(.*?)```", recipe, re.DOTALL)[1], encoding="utf-8")
    entry = room / "__init__.py"
    listed = entry.read_text(encoding="utf-8")
    listed = listed.replace("    bearing,\n", "    bearing,\n    lining,\n").replace("_FILES = (", "_FILES = (lining, ")
    entry.write_text(listed, encoding="utf-8")
    done = subprocess.run([sys.executable, "-c", PROGRAM], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    roller, guide, pressure = json.loads(done.stdout.replace("NaN", "null"))
    assert roller == pytest.approx([p / 500.0 for p in pressure], rel=1e-14) and guide == [None, None]
