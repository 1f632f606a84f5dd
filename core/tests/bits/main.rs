//! The same bits, everywhere and from one version to the next: every law held to what it said when it was written down, to
//! the last place, on inputs that leave no branch out.
//!
//! Promises say what a law is good for; a constant or a sign that is a little wrong may keep all of them. Here nothing
//! passes that changes a number. `UPDATE_GOLDEN=1 cargo test -p shakedown-core --test bits` writes the numbers down anew,
//! which is right only where a change of the law was meant: its reason belongs into the commit.
//!
//! Nothing on the way to a number uses the host's mathematics library, so the file holds on every target.

#[cfg(test)]
mod blocks;
#[cfg(test)]
mod controller;
#[cfg(test)]
mod monitors;
#[cfg(test)]
mod parts;
#[cfg(test)]
mod record;
#[cfg(test)]
mod script;
#[cfg(test)]
mod tape;
#[cfg(test)]
mod tracking;
