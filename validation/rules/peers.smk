# Reference numbers of other programs beside ours: snakemake -s validation/Snakefile --cores all peers
from validation.peers.compare import REFERENCES

PEERS = f"{RESULTS}/peers"


rule peers:
    input:
        reference=[HERE.parent / "tests" / "data" / name for name in REFERENCES],
        code=digest_file(f"{PEERS}/code", "validation.peers.page"),
    output:
        data=f"{PEERS}/peers.json",
        page=f"{PEERS}/peers.html",
    log:
        f"{PEERS}/logs/peers.log",
    conda:
        "../../workflow/envs/trackroller.yaml"
    script:
        "../scripts/peers.py"
