//! The effects of users' own that this process has read.
//!
//! An entry is known by its identifier wherever the library's are, so it lives as long as the process; each text is kept once.

use super::super::Entry;
use super::{Own, Stated};
use std::collections::BTreeMap;
use std::sync::{PoisonError, RwLock};

/// An effect that has a place among the known ones.
#[derive(Debug)]
pub(super) struct Registered {
    pub(super) own: Own,
    pub(super) entry: Entry,
}

static KNOWN: RwLock<BTreeMap<&'static str, &'static Registered>> = RwLock::new(BTreeMap::new());

/// Another effect has this identifier.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("`{id}` stands for another effect in a file read before: {before}; call one of them otherwise")]
pub(crate) struct Taken {
    /// The identifier.
    pub id: String,
    /// The other's expression.
    pub before: String,
}

/// Makes an effect known by its identifier, and gives its entry; the same effect may come again.
pub(crate) fn register(own: Own) -> Result<&'static Entry, Taken> {
    let mut known = KNOWN.write().unwrap_or_else(PoisonError::into_inner);
    if let Some(before) = known.get(own.stated.id.as_str()) {
        return if before.own.stated == own.stated {
            Ok(&before.entry)
        } else {
            Err(Taken { id: own.stated.id, before: before.own.stated.expression.clone() })
        };
    }
    let entry = own.entry();
    let registered: &'static Registered = Box::leak(Box::new(Registered { own, entry }));
    known.insert(registered.entry.id, registered);
    Ok(&registered.entry)
}

pub(super) fn registered(id: &str) -> Option<&'static Registered> {
    KNOWN.read().unwrap_or_else(PoisonError::into_inner).get(id).copied()
}

/// An effect of a user's own as it was stated, and its entry.
pub(crate) fn found(id: &str) -> Option<(&'static Stated, &'static Entry)> {
    registered(id).map(|r| (&r.own.stated, &r.entry))
}
