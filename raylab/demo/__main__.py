"""`python -m raylab.demo`: what `make demo` runs."""

from __future__ import annotations

import sys

from raylab.demo import demo
from raylab.errors import UserError

if __name__ == "__main__":
    try:
        complete = demo(sys.argv[1] if len(sys.argv) > 1 else "demo")
    except UserError as error:
        sys.exit(f"raylab: error: {error}")
    sys.exit(0 if complete else 130)
