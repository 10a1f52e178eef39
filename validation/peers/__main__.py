"""Compare with the reference numbers of other programs, and write `peers.json`: python -m validation.peers FOLDER."""

import json
import sys
from pathlib import Path

from trackroller.files import write_whole
from validation.peers.compare import compare

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(compare(), indent=1) + "\n"
    write_whole(folder / "peers.json", lambda beside: beside.write_text(text, encoding="utf-8"))
