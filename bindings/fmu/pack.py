"""Packs an FMU: pack.py FOLDER LIBRARY FMU. The library lands where FMI 3.0 expects it on this machine."""

import platform
import sys
import zipfile
from pathlib import Path

TOP = Path(__file__).parent.parent.parent


def main(folder: str, library: str, fmu: str) -> None:
    machine = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64"}[platform.machine()]
    system = {"Linux": "linux", "Darwin": "darwin", "Windows": "windows"}[platform.system()]
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.write(Path(folder, "modelDescription.xml"), "modelDescription.xml")
        for resource in sorted(Path(folder, "resources").iterdir()):
            packed.write(resource, f"resources/{resource.name}")
        packed.write(library, f"binaries/{machine}-{system}/{Path(library).name}")
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            packed.write(TOP / name, f"documentation/licenses/{name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
