//! The boards, found by what their manifests say: a package in `firmware/boards` with a `[[package.metadata.board]]` for each image.
//! Nothing in this crate knows one by name, so that a port is its folder.

use serde::Deserialize;
use serde_json::Value;

use crate::shell::{Problem, metadata};

/// Where their folders are, from the top of the workspace.
pub(crate) const FOLDER: &str = "firmware/boards/";

/// An image for a board.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub(crate) struct Board {
    /// Its name in files.
    pub(crate) name: String,
    /// Its name for people.
    pub(crate) title: String,
    /// The package that is built.
    #[serde(skip)]
    pub(crate) package: String,
    /// Its program that is the image.
    pub(crate) image: String,
    /// The part, as `probe-rs` calls it.
    pub(crate) chip: String,
    /// Where its flash begins.
    pub(crate) flash: u32,
    /// It is the one that is flashed and replayed where none is named.
    #[serde(default)]
    default: bool,
}

/// All of them, the default first, then by package and in the order of their manifests.
pub(crate) fn all() -> Result<Vec<Board>, Problem> {
    let boards = of(&metadata(false)?)?;
    if boards.iter().filter(|board| board.default).count() != 1 {
        return Err(Problem::Failed(format!("one of the images in {FOLDER} is the default, no more and no fewer")));
    }
    Ok(boards)
}

/// The default.
pub(crate) fn default() -> Result<Board, Problem> {
    all()?.into_iter().next().ok_or_else(|| Problem::Failed(format!("there is no board in {FOLDER}")))
}

/// The packages that they are built from.
pub(crate) fn packages() -> Result<Vec<String>, Problem> {
    let mut packages: Vec<String> = all()?.into_iter().map(|board| board.package).collect();
    packages.sort();
    packages.dedup();
    Ok(packages)
}

/// Whether a package of `cargo metadata` lies among the boards.
pub(crate) fn holds(package: &Value) -> bool {
    package["manifest_path"].as_str().is_some_and(|path| path.replace('\\', "/").contains(&format!("/{FOLDER}")))
}

fn of(metadata: &Value) -> Result<Vec<Board>, Problem> {
    let mut boards = Vec::new();
    for package in metadata["packages"].as_array().into_iter().flatten().filter(|package| holds(package)) {
        let name = package["name"].as_str().unwrap_or_default();
        let images = package["metadata"]["board"].clone();
        let images: Vec<Board> = serde_json::from_value(images)
            .map_err(|e| Problem::Failed(format!("[[package.metadata.board]] of {name}: {e}")))?;
        boards.extend(images.into_iter().map(|board| Board { package: name.into(), ..board }));
    }
    boards.sort_by(|a, b| (!a.default, &a.package).cmp(&(!b.default, &b.package)));
    Ok(boards)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn package(name: &str, folder: &str, boards: &Value) -> Value {
        json!({ "name": name, "manifest_path": format!("/x/{folder}{name}/Cargo.toml"), "metadata": { "board": boards } })
    }

    fn image(name: &str, default: bool) -> Value {
        json!({ "name": name, "title": name, "image": name, "chip": "C", "flash": 0x0800_0000, "default": default })
    }

    #[test]
    fn a_folder_with_a_manifest_is_a_board() {
        let first = package("a", FOLDER, &json!([image("a1", false)]));
        let second = package("b", FOLDER, &json!([image("b1", false), image("b2", true)]));
        let found = of(&json!({ "packages": [second, first, package("core", "", &Value::Null)] })).unwrap();
        let names: Vec<(&str, &str)> = found.iter().map(|b| (b.name.as_str(), b.package.as_str())).collect();
        assert_eq!(names, [("b2", "b"), ("a1", "a"), ("b1", "b")]);
        assert_eq!(found[0].flash, 0x0800_0000);
    }

    #[test]
    fn a_board_that_says_too_little_is_refused_by_name() {
        let silent = package("mute", FOLDER, &Value::Null);
        let Err(Problem::Failed(why)) = of(&json!({ "packages": [silent] })) else { panic!("it was taken") };
        assert!(why.contains("mute"), "{why}");
    }

    #[test]
    fn the_boards_of_this_tree_are_found() {
        let boards = all().unwrap();
        assert!(boards.len() >= 3 && packages().unwrap().len() >= 2);
        assert!(
            boards.iter().all(|board| crate::shell::top().join(FOLDER).join("..").exists() && !board.chip.is_empty())
        );
        assert!(boards[0].default && boards[1..].iter().all(|board| !board.default));
    }
}
