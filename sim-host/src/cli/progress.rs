//! Progress on standard error for anything over a second: a bar or a spinner where somebody watches a terminal, nothing where
//! nobody does, lines for the page around it in a browser.

#[cfg(target_family = "wasm")]
mod lines;
#[cfg(not(target_family = "wasm"))]
mod terminal;

#[cfg(target_family = "wasm")]
pub(crate) use lines::{at, bar, spinner};
#[cfg(not(target_family = "wasm"))]
pub(crate) use terminal::{at, bar, spinner};
