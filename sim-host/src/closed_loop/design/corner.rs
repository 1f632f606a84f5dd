//! How far a model may be off, and the corners of that.

/// How far parameters may be off, each way, relative to their values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Gain of the valve, b0 and b1 together.
    pub gain: f64,
    /// Its pole.
    pub pole: f64,
    /// Moving mass: the square of the oil column's frequency goes with its inverse.
    pub mass: f64,
    /// Supply pressure.
    pub supply: f64,
}

impl Default for Spread {
    fn default() -> Self {
        Self::all(0.3)
    }
}

impl Spread {
    /// The same for every parameter.
    pub fn all(share: f64) -> Self {
        Self { gain: share, pole: share, mass: share, supply: share }
    }

    /// The larger of those of gain and pole: the share of a flow asked for that may not come.
    pub fn largest(&self) -> f64 {
        self.gain.max(self.pole)
    }

    /// Every combination of ends.
    pub fn corners(&self) -> Vec<Corner> {
        let ends = |share: f64| if share > 0.0 { vec![1.0 - share, 1.0 + share] } else { vec![1.0] };
        let mut corners = Vec::new();
        for &gain in &ends(self.gain) {
            for &pole in &ends(self.pole) {
                for &mass in &ends(self.mass) {
                    corners.extend(ends(self.supply).iter().map(|&supply| Corner { gain, pole, mass, supply }));
                }
            }
        }
        corners
    }
}

/// One combination of parameters, as factors on the model's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// On the valve's gain.
    pub gain: f64,
    /// On its pole.
    pub pole: f64,
    /// On the moving mass.
    pub mass: f64,
    /// On the supply pressure.
    pub supply: f64,
}

impl Default for Corner {
    fn default() -> Self {
        Self { gain: 1.0, pole: 1.0, mass: 1.0, supply: 1.0 }
    }
}

impl std::fmt::Display for Corner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if *self == Self::default() {
            return write!(f, "the model itself");
        }
        write!(f, "gain {:.2}, pole {:.2}, mass {:.2}, supply {:.2}", self.gain, self.pole, self.mass, self.supply)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_all_combinations_and_none_of_what_is_certain() {
        assert_eq!(Spread::all(0.3).corners().len(), 16);
        let two = Spread { gain: 0.3, pole: 0.1, mass: 0.0, supply: 0.0 }.corners();
        assert_eq!(two.len(), 4);
        assert!(two.iter().all(|c| c.mass == 1.0 && c.supply == 1.0 && c.gain != 1.0));
    }
}
