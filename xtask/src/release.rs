//! What is handed to users: the files of a release, each with its check sum and the list of what is built in.

mod firmware;
mod host;
mod image;

use crate::shell::Problem;

/// The chore: builds the files of one product.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["firmware"] => firmware::run(),
        ["host"] => host::run(),
        _ => Err(Problem::Usage("release takes `firmware` or `host`".into())),
    }
}
