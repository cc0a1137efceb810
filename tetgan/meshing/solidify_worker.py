"""Child process that makes solids of mesh files, since libraries may crash or take hours on bad ones.

Run as `python -m tetgan.meshing.solidify_worker OPTIONS_JSON`; paths come on stdin, rows of a table go.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from tetgan.errors import UserError
from tetgan.meshing.solidify import SolidifyOptions, solidify_file
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.repair_worker import serve_requests

_MEMORY_BYTES = 16 * 2**30  # address space


def solidify_to(path: Path, out: Path, options: SolidifyOptions) -> dict[str, Any]:
    """Write the solid of a file; what was made of it, or `problem`, the reason why nothing was."""
    try:
        return solidify_file(path, out, options).row()
    except (ShapeError, UserError) as error:
        return {"problem": str(error)}
    except MemoryError:
        return {"problem": "not enough memory; a longer edge takes less"}


def main() -> None:
    """Serve with the options on the command line."""
    options = SolidifyOptions.model_validate_json(sys.argv[1])

    def answer(request: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        row = solidify_to(Path(str(request["path"])), Path(str(request["out"])), options)
        return {"row": np.array(json.dumps(row))}

    serve_requests(answer, options.timeout_seconds, _MEMORY_BYTES)


if __name__ == "__main__":
    main()
