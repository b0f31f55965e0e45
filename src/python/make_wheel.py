"""Makes the wheel of the Python package from an installed Sutura: libraries, plugins, the command,
and every library they need that is not on each machine of this age.

    make_wheel.py PREFIX FOLDER      PREFIX: of cmake --install; the wheel goes to FOLDER
"""

import base64
import hashlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
# On every machine that the tag of the wheel names, with the symbols of that age.
SYSTEM = re.compile(r"^(linux-vdso|ld-linux-x86-64|libc|libm|libdl|libpthread|librt|libgcc_s|"
                    r"libstdc\+\+)\.so")
METADATA = """Metadata-Version: 2.1
Name: sutura
Version: {version}
Summary: Interactive simulation of surgical suturing
License: {licence}
Requires-Python: >=3.9
Requires-Dist: numpy>=1.21
Classifier: Operating System :: POSIX :: Linux
Classifier: Typing :: Typed
Description-Content-Type: text/markdown

{description}"""


def output_of(*command: object) -> str:
    return subprocess.run([str(c) for c in command], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def needed(library: Path) -> dict[str, Path]:
    """Name and place of every library that this one leads to and that must be brought along."""
    out = {}
    for name, place in re.findall(r"^\s*(\S+) => (\S+)", output_of("ldd", library), re.MULTILINE):
        if place == "not":
            sys.exit(f"make_wheel: {library} needs {name}, which is not found")
        if not SYSTEM.match(name):
            out[name] = Path(place)
    return out


def licence_file(library: Path) -> Path | None:
    """What the Debian package of a library says of its licence."""
    for place in {library, library.resolve(), Path("/usr") / library.resolve().relative_to("/")}:
        found = subprocess.run(["dpkg", "-S", place], text=True, capture_output=True)
        if found.returncode == 0:
            package = found.stdout.split(":")[0]
            file = Path("/usr/share/doc") / package / "copyright"
            return file if file.exists() else None
    return None


def glibc_of(files: list[Path]) -> str:
    """The newest version of the C library that any of them asks for: "2_36"."""
    versions = [(2, 17)]
    for file in files:
        symbols = output_of("objdump", "-T", file)
        versions += [(int(a), int(b)) for a, b in re.findall(r"GLIBC_(\d+)\.(\d+)", symbols)]
        # libstdc++ is the machine's own too. That of g++ 12 came with systems of glibc 2.35.
        if any(int(n) > 29 for n in re.findall(r"GLIBCXX_3\.4\.(\d+)", symbols)):
            versions.append((2, 35))
    return "{}_{}".format(*max(versions))


def gather(prefix: Path, package: Path, licences: Path) -> str:
    """Fills the folder of the package; the glibc that it needs."""
    shutil.copytree(SOURCE / "src/python/sutura", package,
                    ignore=shutil.ignore_patterns("__pycache__"))
    for folder in ("suture", "meshes"):
        shutil.copytree(SOURCE / "scenes" / folder, package / "scenes" / folder,
                        ignore=shutil.ignore_patterns("*.py", "*.geo"))
    shared = next(prefix.rglob("libsutura.so.0"))
    lib = package / "lib"
    (lib / "sutura").mkdir(parents=True)
    (package / "bin").mkdir()
    shutil.copy2(shared, lib / "libsutura.so.0")
    for plugin in (shared.parent / "sutura").glob("libsutura_*.so"):
        shutil.copy2(plugin, lib / "sutura")
    shutil.copy2(shared.parent / "sutura_fmu.so", lib)
    shutil.copy2(prefix / "bin/sutura", package / "bin")
    ours = [*lib.rglob("*.so*"), package / "bin/sutura"]
    for file in ours:
        output_of("strip", "--strip-debug", file)
    licences.mkdir(parents=True)
    shutil.copy2(SOURCE / "LICENSE", licences / "LICENSE")
    brought = {}
    for file in ours:
        brought |= needed(file)
    for name, place in brought.items():
        if name == "libsutura.so.0":
            continue
        shutil.copy2(place.resolve(), lib / name)
        if text := licence_file(place):
            shutil.copy2(text, licences / f"{name}.txt")
    # Whoever loads the package must get these and not those of the machine it was made on.
    for file in ours:
        for name, place in needed(file).items():
            if package.resolve() not in place.resolve().parents:
                sys.exit(f"make_wheel: {file.name} would take {name} from {place}")
    return glibc_of([*lib.rglob("*.so*"), package / "bin/sutura"])


def write(tree: Path, wheel: Path, record: str) -> None:
    """A zip with the list of its files and their hashes."""
    lines = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as out:
        for file in sorted(f for f in tree.rglob("*") if f.is_file()):
            name, data = file.relative_to(tree).as_posix(), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            lines.append(f"{name},sha256={digest},{len(data)}")
            # A fixed date: the same files make the same wheel.
            about = zipfile.ZipInfo(name, (2020, 1, 1, 0, 0, 0))
            about.external_attr = (0o100755 if file.stat().st_mode & 0o100 else 0o100644) << 16
            out.writestr(about, data, zipfile.ZIP_DEFLATED)
        out.writestr(zipfile.ZipInfo(record, (2020, 1, 1, 0, 0, 0)),
                     "\n".join([*lines, f"{record},,", ""]))


def main() -> None:
    prefix, folder = map(Path, sys.argv[1:])
    version = output_of(prefix / "bin/sutura", "--version").split()[-1]
    info = f"sutura-{version}.dist-info"
    with tempfile.TemporaryDirectory() as temporary:
        tree = Path(temporary)
        glibc = gather(prefix, tree / "sutura", tree / info / "licenses")
        gpl = any((tree / "sutura/lib").glob("libcholmod*"))
        tag = f"py3-none-manylinux_{glibc}_x86_64"
        (tree / info / "METADATA").write_text(METADATA.format(
            version=version, licence="Apache-2.0" + (" AND GPL-2.0-or-later" if gpl else ""),
            description=(SOURCE / "docs/embed/python.md").read_text()))
        (tree / info / "WHEEL").write_text(
            f"Wheel-Version: 1.0\nGenerator: make_wheel\nRoot-Is-Purelib: false\nTag: {tag}\n")
        (tree / info / "entry_points.txt").write_text(
            "[console_scripts]\nsutura = sutura.__main__:main\n")
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("sutura-*.whl"):
            old.unlink()
        wheel = folder / f"sutura-{version}-{tag}.whl"
        write(tree, wheel, f"{info}/RECORD")
    print(wheel)


if __name__ == "__main__":
    main()
