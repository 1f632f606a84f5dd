//! Set-ups as laboratories have them: what the sensors add, what is stated of them, and what is stated wrongly.

pub mod draw;
pub mod noise;
pub mod sensing;
pub mod visible;

/// Something in the set-up that is not as stated, or is not stated.
#[derive(Debug, Clone, PartialEq)]
pub struct Misstated {
    /// Kind, a short name: `controller gain`, `noise`, `clock`, `drift`.
    pub kind: &'static str,
    /// The channel, or empty where it is the run's.
    pub channel: &'static str,
    /// Number of the run; none where it is in all of them.
    pub run: Option<u64>,
    /// The quantity that `stated` and `is` give.
    pub quantity: &'static str,
    /// As stated (SI); none where nothing was stated.
    pub stated: Option<f64>,
    /// As it is (SI).
    pub is: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Root of the sum of squares it leaves on all rows (standard deviations); none where it was not measured.
    pub sigma: Option<f64>,
    /// Listed effects that have the same equation at this place: to name one is no wrong name.
    pub tolerated: &'static [&'static str],
}
