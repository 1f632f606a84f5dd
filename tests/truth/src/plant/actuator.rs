//! The cylinder: rigid, leaking, or two chambers of compressible oil.

use crate::ode::State;
use crate::plant::state as at;

/// How flow becomes motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Actuator {
    /// Velocity is flow over area.
    #[default]
    Rigid,
    /// Some flow passes the piston: `q - v = laminar P + turbulent P |P|`, P the pressure difference times area over
    /// table mass (m/s2).
    Leaking {
        /// Laminar coefficient (s).
        laminar: f64,
        /// Turbulent coefficient (s3/m).
        turbulent: f64,
    },
    /// Two oil volumes that shrink and grow with the stroke.
    Chambers {
        /// Oil-column frequency in mid-stroke (Hz).
        frequency: f64,
        /// Damping ratio in mid-stroke, from flow past the piston (1).
        damping: f64,
        /// Half the stroke with its dead volume (m).
        stroke: f64,
        /// Supply pressure times area over table mass (m/s2).
        supply: f64,
        /// Whether the valve's flow depends on the pressure across each of its edges.
        orifices: bool,
    },
}

/// Entrained air: the oil is softer at low pressure by this share of the resting pressure.
const AIR: f64 = 0.03;

impl Actuator {
    pub(super) fn yields(&self) -> bool {
        !matches!(self, Self::Rigid)
    }

    pub(super) fn resting_pressure(&self) -> f64 {
        if let Self::Chambers { supply, .. } = self { 0.5 * supply } else { 0.0 }
    }

    pub(super) fn derivative(&self, demand: f64, v: f64, force: f64, y: &State, dy: &mut State) {
        match *self {
            Self::Rigid => {}
            Self::Leaking { laminar, turbulent } => {
                dy[at::V] = leak_pressure(demand - v, laminar, turbulent) - force;
            }
            Self::Chambers { frequency, damping, stroke, supply, orifices } => {
                let w = std::f64::consts::TAU * frequency;
                let (p1, p2) = (y[at::P1], y[at::P2]);
                let (q1, q2) = if orifices { edge_flows(demand, p1, p2, supply) } else { (demand, demand) };
                let leak = 2.0 * damping / w * (p1 - p2);
                let rest = 0.5 * supply;
                let stiffness = |p: f64| 0.5 * w * w * (1.0 + AIR) * p.max(0.0) / (p.max(0.0) + AIR * rest);
                let place = (y[at::X] / stroke).clamp(-0.9, 0.9);
                dy[at::P1] = stiffness(p1.max(0.02 * rest)) / (1.0 + place) * (q1 - v - leak);
                dy[at::P2] = stiffness(p2.max(0.02 * rest)) / (1.0 - place) * (v + leak - q2);
                dy[at::V] = p1 - p2 - force;
            }
        }
    }
}

/// The pressure that drives `lost` past the piston.
fn leak_pressure(lost: f64, laminar: f64, turbulent: f64) -> f64 {
    if turbulent <= 0.0 {
        return lost / laminar;
    }
    let root = (laminar * laminar + 4.0 * turbulent * lost.abs()).sqrt();
    lost.signum() * 2.0 * lost.abs() / (laminar + root)
}

/// Flow through the two open edges of a four-way valve, each by the orifice law, as velocities; softened where the
/// pressure difference vanishes, as a laminar edge does.
fn edge_flows(demand: f64, p1: f64, p2: f64, supply: f64) -> (f64, f64) {
    let edge = |difference: f64| {
        let ratio = 2.0 * difference / supply;
        ratio.signum() * (ratio * ratio / (ratio.abs() + 1e-3)).sqrt()
    };
    if demand > 0.0 {
        (demand * edge(supply - p1), demand * edge(p2))
    } else {
        (demand * edge(p1), demand * edge(supply - p2))
    }
}

#[cfg(test)]
mod tests {
    use super::{edge_flows, leak_pressure};

    #[test]
    fn leak_pressure_inverts_the_leak_law() {
        for lost in [-0.03, -1e-4, 0.0, 2e-3, 0.05] {
            let p: f64 = leak_pressure(lost, 4e-3, 5e-4);
            assert!((4e-3 * p + 5e-4 * p * p.abs() - lost).abs() < 1e-12, "{lost}");
        }
    }

    #[test]
    fn balanced_edges_pass_the_demand_and_a_loaded_pair_follows_the_root_of_what_is_left() {
        let (q1, q2) = edge_flows(0.2, 5.0, 5.0, 10.0);
        assert!((q1 - 0.2).abs() < 2e-4 && (q2 - 0.2).abs() < 2e-4);
        let (q1, _) = edge_flows(0.2, 7.0, 3.0, 10.0);
        assert!((q1 - 0.2 * (1.0_f64 - 0.4).sqrt()).abs() < 3e-4, "{q1}");
    }
}
