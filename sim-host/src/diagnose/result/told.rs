//! Which of an effect's parameters are worth a reader's time.

use super::NamedEffect;
use crate::identify::quantity::Quantity;
use crate::plant::effects::{Role, entry};
use std::collections::BTreeMap;

impl NamedEffect {
    /// The parameters that say something: a detail of its form that was not fitted is where there is none of it.
    pub fn told(&self) -> BTreeMap<String, Quantity> {
        let details = entry(self.id).map_or(&[][..], |entry| entry.parameters);
        let idle = |key: &str| details.iter().any(|p| p.key == key && p.role == Role::Refined);
        let told =
            |(key, q): &(&String, &Quantity)| q.std.is_some() || q.low.is_some() || q.high.is_some() || !idle(key);
        self.parameters.iter().filter(told).map(|(key, q)| (key.clone(), q.clone())).collect()
    }
}
