//! The forms of the effects: what each puts into the physics at a strength, and its parameters as the library names them.

use super::{Draw, Effect, Parameters, Scales};
use crate::plant::{Actuator, Backlash, Base, Friction, Hum, Lag, Machine, Overlap, Payload, Physics, Stop, Supply};
use Effect as E;
use std::f64::consts::TAU;

impl Effect {
    pub(super) fn command_side(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) -> Parameters {
        match self {
            E::NullBias => {
                if let Machine::Rigid { mass, .. } = physics.machine {
                    physics.table.offset = draw.sign * s;
                    return vec![("offset", draw.sign * s * mass)];
                }
                physics.command.bias = draw.sign * 0.02 * s;
                vec![("offset", physics.command.bias)]
            }
            E::CommandDelay => {
                physics.command.delay = 0.04 * s;
                vec![("time", 0.04 * s)]
            }
            E::ValveDeadband => {
                let half_width = 0.15 * scales.command * s;
                physics.valve.overlap = Some(Overlap { half_width, rounding: draw.between(0, 0.03, 0.1) });
                vec![("half_width", half_width)]
            }
            E::ValveLag => {
                let lag =
                    Lag { frequency: 4.0 / s, damping: draw.between(0, 0.5, 1.0), motor: draw.between(1, 8.0, 15.0) };
                physics.valve.lag = Some(lag);
                vec![("frequency", lag.frequency), ("damping", lag.damping)]
            }
            E::ValveRateLimit => {
                let rate = 0.05 * scales.command_rate / s;
                physics.valve.rate = Some(rate);
                vec![("rate", rate)]
            }
            _ => {
                let rate = draw.sign * 0.5 * s / scales.duration;
                physics.command.warming = Some((rate, 5.0 * scales.duration));
                vec![("rate", rate)]
            }
        }
    }

    pub(super) fn hydraulic(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) -> Parameters {
        let limit = if let Machine::Servo { velocity_limit, .. } = physics.machine { velocity_limit } else { 1.0 };
        match self {
            E::FlowSoftening => {
                physics.flow.corner = 0.35 * s;
                // Where the library's n-th order corner passes through the same point at demand = limit.
                vec![("sharpness", std::f64::consts::LN_2 / -(1.0 - 0.35 * s * std::f64::consts::LN_2).ln())]
            }
            E::AsymmetricLimit => {
                physics.flow.positive = 1.0 + draw.sign * 0.25 * s;
                physics.flow.negative = 1.0 - draw.sign * 0.25 * s;
                vec![("positive", limit * physics.flow.positive), ("negative", limit * physics.flow.negative)]
            }
            E::SupplyDroop => {
                let supply = Supply {
                    depth: 0.8 * s,
                    recovery: draw.log_between(0, 0.5, 6.0),
                    exponent: draw.between(1, 1.1, 1.4),
                    band: 0.7,
                };
                physics.flow.supply = Some(supply);
                vec![("depth", supply.depth), ("recovery", supply.recovery)]
            }
            E::LoadDependentFlow => {
                let supply = 1.1 * scales.acceleration / s;
                physics.actuator = Actuator::Chambers {
                    frequency: draw.between(0, 150.0, 250.0),
                    damping: draw.between(1, 0.3, 0.5),
                    stroke: 0.25,
                    supply,
                    orifices: true,
                };
                vec![("stall_acceleration", supply)]
            }
            E::OilCompliance => {
                let frequency = 6.0 / s;
                let least = 0.8 * scales.crossover / (TAU * frequency);
                let damping = draw.log_between(0, 0.06, 0.3).max(least).min(0.7);
                physics.actuator = Actuator::Chambers {
                    frequency,
                    damping,
                    stroke: 0.3,
                    supply: (4.0 * scales.acceleration).max(20.0),
                    orifices: false,
                };
                vec![("frequency", frequency), ("damping", damping)]
            }
            _ => {
                let laminar = 0.03 * s;
                let turbulent = draw.between(0, 0.0, 0.1) * laminar / scales.acceleration;
                physics.actuator = Actuator::Leaking { laminar, turbulent };
                vec![("coefficient", laminar)]
            }
        }
    }

    pub(super) fn mechanical(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) -> Parameters {
        let per_mass = if let Machine::Rigid { mass, .. } = physics.machine { mass } else { 1.0 };
        match self {
            E::ViscousFriction => {
                let pole = match physics.machine {
                    Machine::Servo { a1, .. } => a1,
                    Machine::Rigid { mass, viscous, .. } => viscous / mass,
                };
                let coefficient = 0.6 * pole * s;
                physics.table.viscous = Some((coefficient, 0.1));
                vec![("coefficient", coefficient * per_mass)]
            }
            E::CoulombFriction | E::StribeckFriction => {
                let sliding = 3.0 * s;
                let ratio = if self == E::CoulombFriction { 1.0 } else { draw.between(0, 1.4, 2.2) };
                let stribeck = draw.log_between(1, 0.004, 0.02);
                let presliding = draw.log_between(2, 8e-6, 2.5e-5);
                physics.table.friction =
                    Some(Friction { sliding, breakaway: ratio * sliding, stribeck, presliding, patch: None });
                let mut out = vec![("force", sliding * per_mass)];
                if self == E::StribeckFriction {
                    out.extend([("static", ratio * sliding * per_mass), ("velocity", stribeck)]);
                }
                out
            }
            E::Backlash => {
                let gap = 1e-3 * s;
                physics.table.backlash = Some(Backlash { gap, sharpness: draw.between(0, 60.0, 120.0) });
                vec![("gap", gap)]
            }
            E::EndStop => {
                let position = scales.stroke * (1.0 - 0.5 * s);
                let stiffness = draw.log_between(0, 500.0, 4000.0);
                let exponent = draw.between(1, 1.05, 1.2);
                physics.table.stop = Some(Stop { position, stiffness, exponent, scale: 0.01, damping: 2.0 });
                vec![("position", position), ("stiffness", stiffness)]
            }
            E::BaseCompliance => {
                let base = Base {
                    mass_ratio: s,
                    frequency: draw.log_between(0, 5.0, 12.0),
                    damping: draw.between(1, 0.03, 0.12),
                    cubic: 100.0,
                };
                physics.base = Some(base);
                vec![("frequency", base.frequency), ("damping", base.damping), ("mass_ratio", base.mass_ratio)]
            }
            _ => {
                let frequency = draw.log_between(0, 1.2, 9.0);
                let stretch = scales.acceleration / (TAU * frequency).powi(2);
                let payload = Payload {
                    mass_ratio: 1.2 * s,
                    frequency,
                    damping: draw.between(1, 0.01, 0.05),
                    cubic: -0.005 / (stretch * stretch),
                    second: Some((0.02, draw.between(2, 2.6, 3.4))),
                    pounding: None,
                };
                physics.payload = Some(payload);
                vec![("mass_ratio", payload.mass_ratio), ("frequency", frequency), ("damping", payload.damping)]
            }
        }
    }

    pub(super) fn sensor_side(self, s: f64, draw: &Draw, scales: &Scales, physics: &mut Physics) -> Parameters {
        let sensors = &mut physics.sensors;
        match self {
            E::DisplacementLag => {
                sensors.displacement_lag = 0.03 * s;
                vec![("time", 0.03 * s)]
            }
            E::DisplacementNonlinearity => {
                let cubic = draw.sign * 0.2 * s / (scales.stroke * scales.stroke);
                sensors.displacement_bend = draw.sign * (6.0 * cubic.abs()).sqrt();
                vec![("cubic", cubic)]
            }
            E::AccelerationLag => {
                sensors.acceleration_lag = 0.05 * s;
                vec![("time", 0.05 * s)]
            }
            E::AccelerationGain => {
                sensors.acceleration_gain = 1.0 + draw.sign * 0.6 * s;
                vec![("gain", sensors.acceleration_gain)]
            }
            E::AccelerationBias => {
                sensors.acceleration_bias = draw.sign * 3.0 * s;
                vec![("offset", sensors.acceleration_bias)]
            }
            E::TiltCoupling => {
                sensors.tilt = draw.sign * 4.0 * s;
                vec![("angle_per_displacement", sensors.tilt)]
            }
            _ => {
                let frequency = if draw.u[0] < 0.7 { 50.0 } else { 60.0 } + draw.between(1, -0.02, 0.02);
                let hum = Hum { frequency, amplitude: 4.0 * s, third: draw.between(2, 0.0, 0.1) };
                sensors.hum = Some(hum);
                vec![("frequency", frequency), ("amplitude", hum.amplitude)]
            }
        }
    }
}
