//! What happens to the table, its valve and its hydraulic block.

use super::super::Promise::{Harmless, Inside, Relay, Reported};
use super::super::{Class, Clock, Fault};
use crate::faults::machine::PlantFault;
use crate::faults::spoil::BITS;

/// Lengths in m, accelerations in m/s2.
pub(super) const TABLE: &[Class] = &[
    Class::new("payload-loose", "the payload comes off and knocks", Harmless(0.05), |d| {
        let (mass, blow) = (d.uniform(0.1, 1.0), d.scale(2.0, 50.0));
        Fault::Table(PlantFault::Payload { mass, blow, length: d.scale(0.003, 0.05), count: 1 + d.below(5) as u32 })
    }),
    Class::new(
        "supply-lost",
        "the supply falls with a time constant of 30 ms to 1 s",
        Reported(Clock::Deviation(0.06), 3.0),
        |d| Fault::Table(PlantFault::Supply(d.scale(0.03, 1.0))),
    ),
    Class::new("valve-hard-over", "the valve stuck hard over", Relay(Clock::Valve(0.03, 0.04), 0.15), |d| {
        Fault::Table(PlantFault::Stuck(d.sign() * d.scale(0.12, 10.0)))
    }),
    Class::new("valve-frozen", "the valve stuck where it was", Relay(Clock::Deviation(0.05), 1.5), |_| {
        Fault::Table(PlantFault::Frozen)
    }),
    Class::new("valve-shut", "the valve stuck shut", Reported(Clock::Deviation(0.02), 0.5), |_| {
        Fault::Table(PlantFault::Stuck(0.0))
    }),
    Class::new("output-bit", "one bit of the output's converter stands", Inside, |d| {
        Fault::Table(PlantFault::Bit(d.below(BITS[1] as usize) as u32, d.chance(0.5)))
    }),
    Class::new(
        "existing-valve-over",
        "behind a modifier, the valve stuck hard over",
        Relay(Clock::Deviation(0.06), 0.3),
        |d| Fault::Behind(PlantFault::Stuck(d.sign() * d.scale(0.12, 10.0))),
    ),
    Class::new(
        "existing-valve-shut",
        "behind a modifier, the valve stuck shut",
        Reported(Clock::Deviation(0.06), 0.3),
        |_| Fault::Behind(PlantFault::Stuck(0.0)),
    ),
    Class::new("relay-welded", "the relay welded, and an emergency stop", Inside, |_| Fault::Welded),
];
