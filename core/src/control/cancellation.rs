//! Feedforward cancellation of a hard-wired inner loop (the paper's Fig. 2).
//!
//! ```text
//! output = u + g x          and the inner loop subtracts x:   valve = output - x = u - (1 - g) x
//! ```
//! output, u and the LVDT's reading x in m; g = 1 cancels the loop. Since the inner loop subtracts the LVDT whatever we
//! do, the output at which the valve passes no oil is the LVDT's reading, not zero: a zero from x = 0.1 m would drive the
//! table at (b0 / a1) 0.1 m = 0.24 m/s.

/// What lies between the output and the valve.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::InnerLoop;
///
/// // A hard-wired loop subtracts the LVDT: the output at which no oil flows is the LVDT's reading.
/// let settings = Settings { inner_loop: InnerLoop::Hardwired, ..Settings::default() };
/// assert_eq!(settings.zero_flow(0.05), 0.05);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum InnerLoop {
    /// Nothing: the output is the valve command, and zero (with the null bias) passes no oil.
    #[default]
    Absent,
    /// A controller with unity proportional gain that subtracts the LVDT from the output.
    Hardwired,
}

impl InnerLoop {
    /// What is added to the law's command (m) so that the inner loop cancels: also the output at which no oil flows,
    /// at LVDT reading `displacement` (m).
    #[inline]
    pub fn cancellation(self, displacement: f32) -> f32 {
        match self {
            Self::Absent => 0.0,
            Self::Hardwired => displacement,
        }
    }
}
