"""Packs an FMU: pack.py LIBRARY FMU. The library lands where FMI 3.0 expects it on this machine."""

import platform
import sys
import zipfile
from pathlib import Path

HERE = Path(__file__).parent
TOP = HERE.parent.parent


def main(library: str, fmu: str) -> None:
    machine = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64"}[platform.machine()]
    system = {"Linux": "linux", "Darwin": "darwin", "Windows": "windows"}[platform.system()]
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.write(HERE / "modelDescription.xml", "modelDescription.xml")
        packed.write(HERE / "resources" / "settings.toml", "resources/settings.toml")
        packed.write(library, f"binaries/{machine}-{system}/shakedown_core{Path(library).suffix}")
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            packed.write(TOP / name, f"documentation/licenses/{name}")


if __name__ == "__main__":
    main(*sys.argv[1:])
