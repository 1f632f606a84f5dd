//! The unit of each proposed channel: from the heading, from how the channels belong together, or from its size.

use super::columns::{Choice, Facts};
use crate::recording::channel::Channel;
use crate::recording::check::relation;
use crate::recording::unit::{NUMBER, UNITS, Unit};

/// Gives every choice its unit where something speaks for one.
pub(super) fn settle(choices: &mut [Choice], facts: &[Facts]) {
    for choice in choices.iter_mut() {
        stated(choice, &facts[choice.column]);
    }
    time(choices, facts);
    lengths(choices, facts);
    for (channel, order) in [(Channel::Velocity, 1), (Channel::Acceleration, 2), (Channel::SpecimenAcceleration, 2)] {
        derived(choices, facts, channel, order);
    }
    for choice in choices.iter_mut().filter(|c| c.unit.is_none()) {
        if choice.channel.dimensions().contains(&NUMBER.dimension) {
            choice.unit = Some(NUMBER);
            choice.evidence.push("nothing speaks for a unit: taken as an uncalibrated number".to_owned());
            choice.doubtful = true;
        }
    }
}

fn stated(choice: &mut Choice, fact: &Facts) {
    let Some(text) = &fact.heading.unit else { return };
    if let Some(unit) = Unit::in_header(text) {
        choice.unit = Some(unit);
        choice.evidence.push(format!("the header says [{text}]"));
        choice.doubtful = false;
    }
}

fn at(choices: &[Choice], channel: Channel) -> Option<usize> {
    choices.iter().position(|c| c.channel == channel)
}

fn time(choices: &mut [Choice], facts: &[Facts]) {
    let Some(i) = at(choices, Channel::Time).filter(|i| choices[*i].unit.is_none()) else { return };
    let Some(step) = facts[choices[i].column].step else { return };
    // A table is sampled between 20 Hz and 20 kHz; only a step from 0.05 to 0.05 s on could be either.
    let (unit, why) = if step < 0.05 {
        (Unit::named("s"), format!("a step of {step:.6} is {:.1} Hz in seconds", 1.0 / step))
    } else {
        (
            Unit::named("ms"),
            format!("a step of {step:.4} is {:.1} Hz in milliseconds, {:.2} Hz in seconds", 1e3 / step, 1.0 / step),
        )
    };
    choices[i].unit = unit;
    choices[i].evidence.push(why);
    choices[i].doubtful = step >= 0.05;
}

/// Seconds a step of time is, as far as it is settled.
fn step(choices: &[Choice], facts: &[Facts]) -> Option<f64> {
    let time = &choices[at(choices, Channel::Time)?];
    Some(facts[time.column].step? * time.unit?.factor)
}

/// Lengths by their size: no table travels metres, few travel less than a millimetre.
fn lengths(choices: &mut [Choice], facts: &[Facts]) {
    for channel in [Channel::Displacement, Channel::Reference] {
        let Some(i) = at(choices, channel).filter(|i| choices[*i].unit.is_none()) else { continue };
        let (low, high) = facts[choices[i].column].range;
        let span = high - low;
        let (unit, certain) = if span < 0.3 {
            ("m", span > 2e-4)
        } else if span < 3000.0 {
            ("mm", span > 3.0)
        } else {
            ("um", span > 6000.0)
        };
        choices[i].unit = Unit::named(unit);
        choices[i].evidence.push(format!("it spans {span:.4}, the travel of a table in {unit}"));
        choices[i].doubtful |= !certain;
    }
}

/// Velocity and acceleration by comparison with the displacement's derivative.
fn derived(choices: &mut [Choice], facts: &[Facts], channel: Channel, order: u32) {
    let (Some(i), Some(d)) = (at(choices, channel), at(choices, Channel::Displacement)) else { return };
    let (Some(dt), Some(length)) = (step(choices, facts), choices[d].unit) else { return };
    let (x, y) = (&facts[choices[d].column].samples, &facts[choices[i].column].samples);
    let Some(found) = relation(x, y, dt, order) else { return };
    let si = found.gain / length.factor;
    let alike = UNITS.iter().filter(|u| channel.dimensions().contains(&u.dimension));
    let Some(best) = alike.min_by(|a, b| (si * a.factor).ln().abs().total_cmp(&(si * b.factor).ln().abs())) else {
        return;
    };
    let ratio = si * best.factor;
    let name = if order == 2 { "second derivative" } else { "derivative" };
    let sign = if found.turned { "MINUS " } else { "" };
    choices[i].evidence.push(format!(
        "in {} it is {sign}{ratio:.3} times the {name} of displacement ({:.1} to {:.1} Hz)",
        best.symbol, found.from_hz, found.to_hz
    ));
    if found.turned {
        choices[i].evidence.push("its sign is turned: correct the column before it is used".to_owned());
    }
    let fits = (0.7..1.4).contains(&ratio) && !found.turned;
    match choices[i].unit {
        None if channel != Channel::SpecimenAcceleration || fits => {
            choices[i].unit = Some(*best);
            // What is derived from a unit that only a size speaks for is no better known.
            choices[i].doubtful = !fits || choices[d].doubtful;
        }
        Some(unit) if unit != *best && channel != Channel::SpecimenAcceleration => choices[i].doubtful = true,
        _ => choices[i].doubtful |= !fits,
    }
}
