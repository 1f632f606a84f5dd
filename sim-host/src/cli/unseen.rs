//! What the guard cannot see under given settings, said before they are used.

use super::output::tell;
use shakedown_core::Settings;

/// Says each hazard that the guard cannot see under `settings`.
pub(super) fn say_unseen(settings: &Settings) {
    settings.findings().for_each(|finding| tell(&format!("note: {finding}")));
}
