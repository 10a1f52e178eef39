"""Look at the intervals of a study that grows, and plan its next step."""

import json
import logging
from pathlib import Path

from trackroller.cli.workflow import log_to
from trackroller.results.sample_growth import next_step
from trackroller.study.file.load import load_study
from trackroller.study.store.put import put_text

log_to(snakemake.log[0], "look at the intervals")
config = snakemake.params.config
step = next_step(load_study(config["study"]), config["results"], logging.getLogger("trackroller").info)
put_text(Path(snakemake.output[0]), json.dumps(step) + "\n")
