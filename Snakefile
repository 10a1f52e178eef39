# From a study file to a report: snakemake --cores all [--config study=config/studies/NAME.yaml]
import sys

from snakemake.exceptions import WorkflowError

from trackroller.errors import InputError
from trackroller.study.files import WorkError
from trackroller.cli.workflow import sources, study_inputs, workflow_plan


configfile: "config/config.yaml"


try:
    PLAN = workflow_plan(
        config,
        main=workflow.is_main_process,
        tell=lambda line: print(line, file=sys.stderr),
    )
except (InputError, WorkError) as error:
    raise WorkflowError(str(error)) from None

RESULTS = str(PLAN.folder.root)


wildcard_constraints:
    chunk="[0-9a-f]{16}",


rule all:
    default_target: True
    input:
        f"{RESULTS}/design.nc",
        f"{RESULTS}/study.nc",
        f"{RESULTS}/sensitivity.nc",
        f"{RESULTS}/figures",
        f"{RESULTS}/report.html",


include: "workflow/rules/solve.smk"
include: "workflow/rules/show.smk"
