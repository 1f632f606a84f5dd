//! Where files go, judged before the work: a place that takes no file, and a place that is another argument's file.

use super::Failure;
use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::{ArgMatches, Command};
use std::any::TypeId;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// A file by its name, without its folder.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// Reads where a file goes.
pub(crate) fn place() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if path.as_os_str() == "-" {
            return Err("standard output is not among its places; `./-` is a file of that name".to_owned());
        }
        writable(path)
    })
}

/// The same where `-` is standard output.
pub(crate) fn place_or_stdout() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| if path.as_os_str() == "-" { Ok(path) } else { writable(path) })
}

/// Reads which folder files go to; it may be made later.
pub(crate) fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if path.exists() && !path.is_dir() { Err("is a file, name a folder".to_owned()) } else { Ok(path) }
    })
}

fn writable(path: PathBuf) -> Result<PathBuf, String> {
    let because = |e: std::io::Error| match e.kind() {
        ErrorKind::IsADirectory => "it is a folder; name a file".to_owned(),
        ErrorKind::PermissionDenied => "no permission; name another place".to_owned(),
        kind => kind.to_string(),
    };
    crate::files::writable(&path).map_err(|e| format!("no file can be written there: {}", because(e)))?;
    Ok(path)
}

/// Refuses a command line two of whose arguments name one file: what is read would be written over, or one result over the other.
pub(crate) fn distinct(command: &Command, matches: &ArgMatches) -> Result<(), Failure> {
    if let Some((name, below)) = matches.subcommand() {
        return command.find_subcommand(name).map_or(Ok(()), |command| distinct(command, below));
    }
    let mut seen: Vec<(String, PathBuf)> = Vec::new();
    for argument in command.get_arguments().filter(|a| a.get_value_parser().type_id() == TypeId::of::<PathBuf>()) {
        let name = argument.to_string();
        let given = matches.get_raw(argument.get_id().as_str()).into_iter().flatten();
        let files: Vec<PathBuf> = given.filter_map(|path| file(Path::new(path))).collect();
        for path in files {
            if let Some((other, _)) = seen.iter().find(|(other, there)| *there == path && *other != name) {
                let message = format!("{other} and {name} name one file, {}: give them two", path.display());
                return Err(Failure::Input(message));
            }
            seen.push((name.clone(), path));
        }
    }
    Ok(())
}

/// The file that a path leads to, whatever it is called; none for standard output, a device or a pipe, which take more than one.
fn file(path: &Path) -> Option<PathBuf> {
    if path.as_os_str() == "-" {
        return None;
    }
    if let Ok(there) = path.canonicalize() {
        return (there.is_file() || there.is_dir()).then_some(there);
    }
    let absolute = std::path::absolute(path).ok()?;
    let folder = absolute.parent().and_then(|folder| folder.canonicalize().ok());
    Some(folder.zip(absolute.file_name()).map_or_else(|| absolute.clone(), |(folder, name)| folder.join(name)))
}
