//! A fault and a table as a person reads them, with the values that were dealt.

use super::class::{Channel, Fault};
use super::machine::{PlantFault, Table};
use super::spoil::SignalFault;
use std::fmt::{Display, Formatter, Result};

impl Channel {
    /// Its name and its unit.
    const fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Displacement => ("LVDT", "m"),
            Self::Second => ("second displacement sensor", "m"),
            Self::Acceleration => ("accelerometer", "m/s2"),
            Self::Command => ("command", "m"),
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::None => f.write_str("none"),
            Self::Signal(channel, spoil) => signal(f, channel, spoil),
            Self::Shared(spoil) => {
                f.write_str("shared with the loop behind the device, ")?;
                signal(f, Channel::Displacement, spoil)
            }
            Self::LinkCut => f.write_str("no byte of the stream arrives"),
            Self::LinkGarbled(share) => write!(f, "one bit in {:.0} bytes of the stream is flipped", 1.0 / share),
            Self::SettingsGarbled(bits) => write!(f, "a frame of settings with {bits} bits flipped"),
            Self::SettingsNonsense => f.write_str("settings with one number that makes no sense"),
            Self::SettingsWrong(factor) => write!(f, "gains off by factors up to {factor:.3}"),
            Self::Jitter(share) => write!(f, "ticks longer or shorter by up to {:.2} %", 100.0 * share),
            Self::Missed(length) => write!(f, "no tick for {length} ms"),
            Self::Welded => f.write_str("the relay is welded"),
            Self::Block(latency) => write!(f, "the block shuts in {:.0} ms", 1e3 * latency),
            Self::Table(how) => write!(f, "table: {how}"),
            Self::Behind(how) => write!(f, "behind an existing controller: {how}"),
        }
    }
}

fn signal(f: &mut Formatter<'_>, channel: Channel, spoil: SignalFault) -> Result {
    let (name, unit) = channel.words();
    write!(f, "{name}: ")?;
    match spoil {
        SignalFault::Open => f.write_str("no number"),
        SignalFault::Rail(at) => write!(f, "stands at {at:.4} {unit}"),
        SignalFault::Clipped(limit) => write!(f, "held within {limit:.4} {unit} of zero"),
        SignalFault::Stuck => f.write_str("stands where it stood"),
        SignalFault::Detached(noise) => write!(f, "stands where it stood, with noise of {noise:.6} {unit}"),
        SignalFault::Noisy(noise) => write!(f, "white noise of {noise:.6} {unit}"),
        SignalFault::Drifting(rate) => write!(f, "moves away at {rate:.5} {unit} a second"),
        SignalFault::Returning { rate, most, left } => {
            let (most, left) = (most * rate.signum(), left * most * rate.signum());
            write!(
                f,
                "moves away at {:.5} {unit} a second to {most:.4} {unit}, and back to {left:.4} {unit}",
                rate.abs()
            )
        }
        SignalFault::Offset(offset) => write!(f, "off by {offset:.4} {unit}"),
        SignalFault::Spikes { height, length, period: u32::MAX } => {
            write!(f, "a spike of {height:.4} {unit} that lasts {length} ms")
        }
        SignalFault::Spikes { height, length, period } => {
            write!(f, "spikes of {height:.4} {unit} that last {length} ms, every {period} ms")
        }
        SignalFault::Gap(length) => write!(f, "no number for {length} ms"),
        SignalFault::Flicker { length, period } => write!(f, "no number for {length} ms, every {period} ms"),
        SignalFault::Short(noise) => write!(f, "reads zero, with noise of {noise:.6} {unit}"),
        SignalFault::Hum { amplitude, frequency } => write!(f, "hum of {amplitude:.4} {unit} at {frequency:.1} Hz"),
        SignalFault::Bit { bit, set, .. } => write!(f, "bit {bit} of its converter stands at {}", u8::from(set)),
        SignalFault::Reversed => f.write_str("its sign turned"),
        SignalFault::Gain { left, over } => write!(f, "its gain goes to {left:.3} of itself over {over:.2} s"),
    }
}

impl Display for PlantFault {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match *self {
            Self::Stuck(command) => write!(f, "the valve stays with a command of {command:.4} m"),
            Self::Frozen => f.write_str("the valve stays where it is"),
            Self::Bit(bit, set) => write!(f, "bit {bit} of the output's converter stands at {}", u8::from(set)),
            Self::Supply(time) => write!(f, "the supply falls with a time constant of {time:.3} s"),
            Self::Payload { mass, blow, length, count } => write!(
                f,
                "the payload, {mass:.2} of the table's mass, comes off and knocks {count} times with {blow:.1} m/s2 for {:.1} ms",
                1e3 * length
            ),
        }
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self { b1, b0, a1, limit, null, oil } = self;
        write!(f, "b1 {b1:.4} 1/s, b0 {b0:.2} 1/s2, a1 {a1:.2} 1/s, limit {limit:.4} m/s, null {:.3} mm", 1e3 * null)?;
        oil.map_or(Ok(()), |oil| {
            write!(f, ", oil column {:.1} Hz, damping {:.3}", oil.omega / std::f64::consts::TAU, oil.damping)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::class::CLASSES;
    use crate::faults::dice::FaultRng;

    #[test]
    fn every_fault_is_told_with_its_values() {
        let told = |fault: Fault| fault.to_string();
        let drifting = told(Fault::Signal(Channel::Displacement, SignalFault::Drifting(-0.004)));
        assert_eq!(drifting, "LVDT: moves away at -0.00400 m a second");
        assert_eq!(told(Fault::LinkGarbled(0.01)), "one bit in 100 bytes of the stream is flipped");
        assert_eq!(
            told(Fault::Behind(PlantFault::Supply(0.25))),
            "behind an existing controller: the supply falls with a time constant of 0.250 s"
        );
        for class in CLASSES.iter() {
            let text = told((class.deal)(&mut FaultRng::new(1, 1)));
            assert!(!text.is_empty() && !text.contains(['{', '(']), "{}: {text}", class.id);
        }
    }
}
