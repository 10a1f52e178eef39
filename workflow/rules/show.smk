# What is drawn and written from the gathered file. A change of this code does the results anew; `study/draws.py` and the
# like are part of it because an analysis draws its design again.
ANALYSIS = [
    "fatigue.py",
    "study/convergence.py",
    "study/delta.py",
    "study/designs.py",
    "study/draws.py",
    "expressions.py",
    "study/factors.py",
    "study/givendata.py",
    "study/goals.py",
    "study/indices.py",
    "study/levels.py",
    "study/outputs.py",
    "study/pairs.py",
    "study/pareto.py",
    "study/phrases.py",
    "study/restore.py",
    "study/robustness.py",
    "study/sampling.py",
    "study/sensitivity.py",
    "study/sensitivity_labels.py",
    "study/sobol.py",
    "study/words.py",
]


rule sensitivity:
    input:
        study=f"{RESULTS}/study.nc",
        code=sources(*ANALYSIS),
    output:
        f"{RESULTS}/sensitivity.nc",
    log:
        f"{RESULTS}/logs/sensitivity.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/sensitivity.py"


rule figures:
    input:
        study=f"{RESULTS}/study.nc",
        sensitivity=f"{RESULTS}/sensitivity.nc",
        code=sources("plots", "ladder", *ANALYSIS),
    output:
        directory(f"{RESULTS}/figures"),
    log:
        f"{RESULTS}/logs/figures.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/figures.py"


rule report:
    input:
        study=f"{RESULTS}/study.nc",
        figures=f"{RESULTS}/figures",
        sensitivity=f"{RESULTS}/sensitivity.nc",
        code=sources(
            "report",
            "templates",
            "ladder",
            "plots/style.py",
            "plots/study_view.py",
            *ANALYSIS,
        ),
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/logs/report.log",
    conda:
        "../envs/trackroller.yaml"
    script:
        "../scripts/report.py"
