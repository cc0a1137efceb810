"""The `tetgan` command: one subcommand a stage. Each reads files, calls one function, writes files.

Heavy libraries are imported inside the commands, so that `--help` answers at once.
"""

import logging
import sys

from tetgan.cli import data as data
from tetgan.cli import evaluation as evaluation
from tetgan.cli import models as models
from tetgan.cli import simulation as simulation
from tetgan.cli import solidify as solidify
from tetgan.cli import solids as solids
from tetgan.cli import studies as studies
from tetgan.cli import tables as tables
from tetgan.cli.app import app
from tetgan.errors import UserError

# isort: on


def main() -> None:
    """Entry point: errors a person can act on are one line, everything else is a bug and shows itself."""
    logging.basicConfig(level=logging.INFO, format="%(levelname).1s %(name)s: %(message)s")
    try:
        app()
    except UserError as error:
        sys.exit(_complain(str(error)))
    except OSError as error:
        sys.exit(_complain(f"{error.filename or 'file'}: {error.strerror or error}"))


def _complain(message: str) -> int:
    print(f"error: {' '.join(message.split())}", file=sys.stderr)
    return 2
