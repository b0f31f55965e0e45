"""The wheel in a fresh virtual environment, without a network: what README and the page show runs.

    wheel_test.py BUILD
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


def run(*command: object, folder: Path, expect: str = "") -> str:
    clean = {k: v for k, v in os.environ.items()
             if not k.startswith(("SUTURA_", "PYTHON", "LD_LIBRARY"))}
    out = subprocess.run([str(c) for c in command], cwd=folder, env=clean | {"MPLBACKEND": "agg"},
                         text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if out.returncode != 0 or expect not in out.stdout:
        sys.exit(f"{' '.join(map(str, command))}\n{out.stdout}\nexit code {out.returncode}, "
                 f"expected '{expect}'")
    return out.stdout


def python_blocks(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(), re.DOTALL)


def main() -> None:
    build = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        run("cmake", "--install", build, "--prefix", folder / "prefix", folder=folder)
        run(sys.executable, SOURCE / "src/python/make_wheel.py", folder / "prefix", folder / "dist",
            folder=folder)
        # numpy and matplotlib are those of the system: there is no network to get others from.
        run(sys.executable, "-m", "venv", "--system-site-packages", folder / "venv", folder=folder)
        python = folder / "venv/bin/python"
        wheel, = (folder / "dist").glob("*.whl")
        run(python, "-m", "pip", "install", "--no-index", "--no-deps", wheel, folder=folder)

        # Every library of ours comes from the wheel, wherever it is put.
        where = run(python, "-c", "import sutura; s = sutura.load(sutura.scenes / "
                    "'suture/prick.xml'); s.step(); print(open('/proc/self/maps').read())",
                    folder=folder)
        for place in re.findall(r"(/\S*(?:sutura|cholmod|metis|tinyxml)\S*\.so\S*)", where):
            if not place.startswith(str(folder / "venv")):
                sys.exit(f"{place} does not come from the wheel")

        block, = python_blocks(SOURCE / "README.md")
        if block.count("\n") > 14:
            sys.exit("README promises a dozen lines")
        run(python, "-c", block, folder=folder)
        if (folder / "force.png").stat().st_size < 10000:
            sys.exit("README's curve is empty")
        examples = SOURCE / "docs/embed/examples"
        run(python, examples / "drive.py", folder=folder, expect="let go: the tip moves by")
        run(python, examples / "write.py", folder=folder, expect="did you mean 'thread_length'?")
        run(folder / "venv/bin/sutura", "describe", "Tissue", folder=folder, expect="young")
        run(python, "-m", "sutura", "--version", folder=folder, expect="sutura 0.")
        run(folder / "venv/bin/sutura", "fmu", SOURCE / "scenes/components/Grasper.xml",
            folder=folder, expect="Grasper.fmu: ")


if __name__ == "__main__":
    main()
