//! The firmware's files: for every board the image as `.elf`, `.bin` and `.hex`, the SHA-256 of each, the list of all that is built
//! in, and the lines that flash them. The same sources give the same bytes, whatever folder they are built in.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::image::Flash;
use crate::boards::{self, Board};
use crate::firmware::LINKER;
use crate::output::say;
use crate::reproduce::{remap, sha256};
use crate::sbom;
use crate::shell::{Problem, run as execute, top};

/// Where the files are put, from the top of the workspace.
const FOLDER: &str = "target/release-files/firmware";
/// Where they are built: apart from other builds, whose paths are not cut down.
const BUILD: &str = "target/release-build";

/// Builds all of them.
pub(super) fn run() -> Result<(), Problem> {
    let folder = top().join(FOLDER);
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", folder.display()));
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(failed)?;
    }
    std::fs::create_dir_all(&folder).map_err(failed)?;
    let (mut sums, mut lines) = (String::new(), String::new());
    for board in &boards::all()? {
        let elf = built(board)?;
        for path in files(board, &elf, &folder)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let _ = writeln!(sums, "{}  {name}", sha256(&path)?);
        }
        lines += &flashing(board);
    }
    let list = folder.join(format!("shakedown-{}-firmware.cdx.json", env!("CARGO_PKG_VERSION")));
    write(&list, sbom::of(&boards::packages()?)?.as_bytes())?;
    write(&folder.join("SHA256SUMS"), sums.as_bytes())?;
    write(&folder.join("FLASHING.txt"), lines.as_bytes())?;
    say(&format!("{sums}\nin {FOLDER}, with {}\n\n{lines}", list.file_name().unwrap_or_default().display()));
    Ok(())
}

/// The image's name in a release.
fn name(board: &Board) -> String {
    format!("shakedown-{}-{}", env!("CARGO_PKG_VERSION"), board.name)
}

/// Builds the image of `board` with this machine's folders cut out of it.
fn built(board: &Board) -> Result<PathBuf, Problem> {
    let folder = top().join(BUILD);
    let mut cargo = board.command()?;
    cargo.env("CARGO_TARGET_DIR", &folder).env("RUSTFLAGS", format!("{LINKER} {}", remap(&top(), &folder)));
    execute(&mut cargo)?;
    Ok(board.built(&folder))
}

/// Writes the three files of an image; where they are.
fn files(board: &Board, elf: &Path, folder: &Path) -> Result<[PathBuf; 3], Problem> {
    let bytes = std::fs::read(elf).map_err(|e| Problem::Failed(format!("{}: {e}", elf.display())))?;
    let wrong = |why| Problem::Failed(format!("{}: {why}", elf.display()));
    let flash = Flash::of(&bytes).map_err(wrong)?;
    if flash.origin != board.flash {
        return Err(wrong(format!("it begins at {:#x}, the flash at {:#x}", flash.origin, board.flash)));
    }
    let paths = ["elf", "bin", "hex"].map(|kind| folder.join(format!("{}.{kind}", name(board))));
    write(&paths[0], &bytes)?;
    write(&paths[1], &flash.bytes)?;
    write(&paths[2], flash.hex().map_err(wrong)?.as_bytes())?;
    Ok(paths)
}

/// The lines that flash an image, one for each tool.
fn flashing(board: &Board) -> String {
    let (name, chip, at) = (name(board), &board.chip, board.flash);
    let title = &board.title;
    format!(
        "{title}, one of these:\n  probe-rs download --chip {chip} {name}.elf && probe-rs reset --chip {chip}\n  \
         dfu-util -a 0 -s {at:#010x}:leave -D {name}.bin\n  STM32_Programmer_CLI -c port=SWD -w {name}.hex -v -rst\n  \
         st-flash --reset write {name}.bin {at:#010x}\n"
    )
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Problem> {
    std::fs::write(path, bytes).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))
}
