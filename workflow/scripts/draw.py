"""Draws the figure of a job by the script of its name, with all that is printed in the job's log."""

import runpy
import sys
from pathlib import Path

script = Path(__file__).with_name(f"draw_{snakemake.params.figure}.py")
with Path(snakemake.log[0]).open("w") as log:
    sys.stdout = sys.stderr = log
    runpy.run_path(str(script), {"snakemake": snakemake})
