//! The details of the forms of a model's effects: free for a fit, or back where the library starts from.

use super::Model;
use crate::plant::effects::{Ends, Role};

/// Share of a range's logarithm that is near its end.
const NEAR_NONE: f64 = 0.2;

impl Model {
    /// This model with every detail of its effects' forms free, once for each start. A detail at the end of its range that means that
    /// there is none has no slope there: it starts from the middle of its range, and from near that end. Any other starts from the first
    /// and from the last of its starts.
    pub fn refined(&self) -> Vec<Self> {
        let [middle, near] = [false, true].map(|near| self.refined_from(near));
        if middle.same_values(&near) { vec![middle] } else { vec![middle, near] }
    }

    /// The same from the middle of the ranges' logarithms, or from near none.
    fn refined_from(&self, near: bool) -> Self {
        let share = if near { NEAR_NONE } else { 0.5 };
        let mut model = self.clone();
        for placed in &mut model.effects {
            let details =
                placed.values.iter_mut().zip(placed.entry.parameters).filter(|(_, p)| p.role == Role::Refined);
            for (value, parameter) in details {
                value.free = true;
                let none = match parameter.simple {
                    Ends::High if value.value >= value.high => Some([value.high, value.low]),
                    Ends::Low if value.value <= value.low => Some([value.low, value.high]),
                    _ => None,
                };
                if let Some([none, other]) = none.filter(|_| parameter.positive) {
                    value.value = none * (other / none).powf(share);
                } else if let [first, .., last] = *parameter.starts
                    && (near && value.value == first)
                {
                    value.value = last;
                }
            }
        }
        model
    }

    /// This model with the fitted details of these effects' forms back where the library starts from, and held there; how many
    /// these were.
    pub fn plain(&self, ids: &[&str]) -> (Self, usize) {
        let (mut model, mut details) = (self.clone(), 0);
        for placed in model.effects.iter_mut().filter(|p| ids.contains(&p.entry.id)) {
            let fitted = placed.values.iter_mut().zip(placed.entry.parameters);
            for (value, parameter) in fitted.filter(|(value, p)| value.free && p.role == Role::Refined) {
                let size = value.high / parameter.high;
                (value.value, value.free) = (parameter.first_start() * size, false);
                details += 1;
            }
        }
        (model, details)
    }

    fn same_values(&self, other: &Self) -> bool {
        self.values().zip(other.values()).all(|(a, b)| a.value == b.value)
    }
}
