"""The `sutura` command that came with this package: `python -m sutura run scene.xml`."""

import os
import sys
from pathlib import Path


def main() -> None:
    program = Path(__file__).parent / "bin" / "sutura"
    os.execv(program, [str(program), *sys.argv[1:]])


if __name__ == "__main__":
    main()
