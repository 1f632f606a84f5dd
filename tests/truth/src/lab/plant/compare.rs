//! What one plant has and another has not.

use super::Plant;
use crate::lab::law::{Gate, Part, Place};
use std::sync::Arc;

impl Plant {
    /// Lets every law from number `first` on act only where the gate is open.
    pub fn gate_from(&mut self, before: &Self, gate: Gate) {
        for part in &mut self.parts {
            if before.is_new(part) {
                part.gate = Some(gate);
            }
        }
    }

    /// Places of the laws that `before` does not have.
    pub fn places_since(&self, before: &Self) -> Vec<Place> {
        self.parts.iter().filter(|p| before.is_new(p)).map(|p| p.place).collect()
    }

    /// The gate of the laws that `before` does not have.
    pub fn gate_since(&self, before: &Self) -> Option<Gate> {
        self.parts.iter().filter(|p| before.is_new(p)).find_map(|p| p.gate)
    }

    fn is_new(&self, part: &Part) -> bool {
        !self.parts.iter().any(|old| Arc::ptr_eq(&old.law, &part.law))
    }
}
