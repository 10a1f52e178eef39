"""Run the command line with `python -m trackroller.cli`."""

from trackroller.cli import main

main()
