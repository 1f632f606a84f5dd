//! Do the channels belong together? Displacement, its second derivative and the accelerometer; velocity; reference and
//! displacement; the controller's inputs and its command.
//!
//! Where a link between two channels fails, single repairs are tried one after the other: a sign turned, a unit
//! exchanged, two columns swapped. A repair that makes every link hold is the likely cause and is named; where none
//! does, the broken link itself is reported. A gain or a lag within what a sensor can have breaks no link.

use super::replay::Replay;
use super::{Fault, Finding, Severity};
use crate::recording::Baseline;
use crate::recording::channel::{Channel, PerChannel};
use crate::recording::experiment::ChannelSource;
use crate::recording::run::Run;
use crate::recording::signal::{filled, quantile};
use crate::recording::unit::{UNITS, Unit};
use agreement::{Agreement, agreement};
use std::borrow::Cow;

mod agreement;
mod follows;

pub(super) use agreement::coherent_bins;
pub(in crate::recording) use agreement::{Bin, delay_over, spectra_of};

/// A link is sound while one channel is between these multiples of what the other says it should be: what a wrong
/// sensitivity may do, and less than what separates any two units.
const SOUND_GAIN: std::ops::Range<f64> = 0.2..5.0;

/// Logarithm of the gain that a unit put right may leave.
const ACCURATE: f64 = 0.25;

/// How well one sign and one delay must explain the phases before a sign is called turned.
const IN_STEP: f64 = 0.85;

/// The same for reference and displacement, between which the whole loop stands.
const SOUND_TRACKING: std::ops::Range<f64> = 0.25..4.0;

/// Highest frequency at which any loop may be expected to follow its reference, Hz.
const FOLLOWS: f64 = 1.0;

/// Largest travel of a table, m, and largest acceleration, m/s2, that can be believed.
const LARGEST: [(Channel, f64); 3] =
    [(Channel::Displacement, 4.0), (Channel::Reference, 4.0), (Channel::Acceleration, 500.0)];

/// The channels of a run, some of them changed by a repair.
type Signals<'a> = PerChannel<Cow<'a, [f64]>>;

/// One thing that must hold between channels.
#[derive(Debug, Clone, PartialEq)]
struct Link {
    about: About,
    state: State,
    /// How far its gain is from one, as a logarithm.
    distance: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum About {
    Pair(Channel, Channel),
    Controller,
    Size(Channel),
}

impl About {
    /// The channel to look at first.
    fn channel(self) -> Channel {
        match self {
            Self::Pair(_, to) | Self::Size(to) => to,
            Self::Controller => Channel::Command,
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
enum State {
    /// Too little motion or too much noise to say.
    Unknown,
    Sound,
    Broken(String),
    /// The two belong together but for a gain outside [`SOUND_GAIN`].
    Off(String),
}

impl State {
    /// What is wrong, where something is.
    fn fault(&self) -> Option<&str> {
        match self {
            Self::Broken(text) | Self::Off(text) => Some(text),
            Self::Unknown | Self::Sound => None,
        }
    }
}

/// Something that could be put right in the experiment.
#[derive(Debug, Clone, PartialEq)]
enum Repair {
    Sign(Channel),
    Unit { channels: Vec<Channel>, stated: Unit, recorded: Unit },
    Swap(Channel, Channel),
    Factor { channel: Channel, from: Unit, to: Unit },
}

/// How one channel agrees with a derivative of another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Relation {
    /// Size of the second against the derivative of the first.
    pub(crate) gain: f64,
    /// They run against each other.
    pub(crate) turned: bool,
    /// Lowest and highest frequency it rests on, Hz.
    pub(crate) from_hz: f64,
    /// The same.
    pub(crate) to_hz: f64,
}

/// Compares `second` with the `order`-th derivative of `first`, samples `dt` seconds apart; none where they do not
/// belong together or too little is signal.
pub(crate) fn relation(first: &[f64], second: &[f64], dt: f64, order: u32) -> Option<Relation> {
    let found = agreement(first, second, dt, order).filter(|a| !a.unrelated && a.slope.abs() < 1.2)?;
    Some(Relation { gain: found.gain, turned: found.turned, from_hz: found.from_hz, to_hz: found.to_hz })
}

/// Looks for broken links and the repair that mends them.
pub(super) fn check(run: &Run, sources: &PerChannel<ChannelSource>, baseline: &Baseline) -> Vec<Finding> {
    let signals = signals(run);
    let follows = follows::follows_to(baseline, &run.law);
    let links = links(&signals, run, follows);
    let broken: Vec<&Link> = links.iter().filter(|l| l.state.fault().is_some()).collect();
    let Some(first) = broken.first() else { return Vec::new() };
    let mends = |repair: Repair| -> Option<(Repair, f64)> {
        let mended = self::links(&repaired(&signals, &repair, sources), run, follows);
        let holds = links.iter().zip(&mended).all(|(before, after)| match after.state {
            // A unit is a factor to a sensor's accuracy, not about one.
            State::Sound => !repair.rescales() || !matches!(before.state, State::Off(_)) || after.distance < ACCURATE,
            State::Unknown => before.state == State::Unknown,
            State::Broken(_) | State::Off(_) => false,
        });
        holds.then(|| (repair, mended.iter().map(|l| l.distance).sum()))
    };
    // Kinds of repair in their order; within a kind, the one that brings the gains nearest to one.
    let all = repairs(&signals, sources);
    let mended = (0..=LAST_KIND).find_map(|kind| {
        let of_kind = all.iter().filter(|r| r.kind() == kind).cloned();
        let mended: Vec<(Repair, f64)> = of_kind.filter_map(mends).collect();
        let best = mended.iter().min_by(|a, b| a.1.total_cmp(&b.1))?.clone();
        Some((best, mended))
    });
    match mended {
        Some((best, others)) => match undecided(run, &best, &others, &evidence(&broken)) {
            Some(finding) => vec![finding],
            None => vec![best.0.finding(run, &evidence(&broken))],
        },
        // The controller alone out of step is the replay's to explain.
        None if broken.iter().all(|l| l.about == About::Controller) => Vec::new(),
        None if broken.iter().all(|l| matches!(l.state, State::Off(_))) => vec![off(run, first, &evidence(&broken))],
        None => vec![unexplained(run, first, &evidence(&broken))],
    }
}

fn signals(run: &Run) -> Signals<'_> {
    let mut signals = PerChannel::default();
    for (channel, samples) in run.channels.iter() {
        signals.set(channel, Cow::Borrowed(samples.as_slice()));
    }
    signals
}

fn evidence(broken: &[&Link]) -> String {
    broken.iter().filter_map(|link| link.state.fault()).collect::<Vec<_>>().join("; ")
}

/// Every link that the channels at hand allow, always in the same order; the loop moves with its reference up to `follows`, Hz.
fn links(signals: &Signals<'_>, run: &Run, follows: f64) -> Vec<Link> {
    use Channel::{Acceleration, Displacement, Reference, Velocity};
    let mut links = Vec::new();
    let replay = Replay::of(signals, run);
    // Where the stated controller makes the recorded command out of them, reference, displacement and command are what they
    // are said to be, however badly the table follows.
    let confirmed = replay.as_ref().is_some_and(Replay::reproduces);
    let followed = |state: State| match state {
        State::Broken(_) | State::Off(_) if confirmed => State::Unknown,
        state => state,
    };
    for (from, to, order) in [(Displacement, Acceleration, 2), (Displacement, Velocity, 1), (Velocity, Acceleration, 1)]
    {
        if let (Some(x), Some(y)) = (signals.get(from), signals.get(to)) {
            let found = agreement(x, y, run.dt, order);
            let distance = found.map_or(0.0, |a| a.gain.ln().abs());
            links.push(Link { about: About::Pair(from, to), state: kinematic(from, to, order, found), distance });
        }
    }
    if let (Some(x), Some(y)) = (signals.get(Reference), signals.get(Displacement)) {
        let found = agreement(x, y, run.dt, 0);
        let distance = found.map_or(0.0, |a| a.low_gain.ln().abs());
        let state = match tracking(found, follows) {
            State::Unknown => slow_part(x, y, run.dt),
            known => known,
        };
        links.push(Link { about: About::Pair(Reference, Displacement), state: followed(state), distance });
    }
    if let (Some(x), Some(u)) = (signals.get(Displacement), signals.get(Channel::Command)) {
        let state = followed(driving(agreement(x, u, run.dt, 1)));
        links.push(Link { about: About::Pair(Displacement, Channel::Command), state, distance: 0.0 });
    }
    for (channel, largest) in LARGEST {
        if let Some(samples) = signals.get(channel) {
            links.push(Link { about: About::Size(channel), state: size(channel, samples, largest), distance: 0.0 });
        }
    }
    if let Some(replay) = replay {
        links.push(Link { about: About::Controller, state: replay_state(&replay), distance: 0.0 });
    }
    links
}

fn kinematic(from: Channel, to: Channel, order: u32, found: Option<Agreement>) -> State {
    let derivative = if order == 2 { "second derivative" } else { "derivative" };
    let Some(a) = found else { return State::Unknown };
    let band = format!("{:.1} to {:.1} Hz", a.from_hz, a.to_hz);
    if a.unrelated {
        return State::Broken(format!("{to} has nothing in common with the {derivative} of {from} ({band})"));
    }
    // A sensor that is turned round is so at every frequency, and of the right size; one that tilts with the table only at the lowest,
    // and of a size that falls with frequency.
    let tilted = match a.fast {
        Some((turned, gain)) => (a.turned || a.low_turned) && !turned && SOUND_GAIN.contains(&gain),
        None => a.turned && a.farthest > ACCURATE,
    };
    if (order == 2 && tilted) || (a.turned && a.in_step < IN_STEP) {
        return State::Unknown;
    }
    if a.turned {
        return State::Broken(format!("{to} runs against the {derivative} of {from} ({band})"));
    }
    if a.slope.abs() > 1.2 {
        return State::Broken(format!(
            "{to} against the {derivative} of {from} changes with frequency to the power {:.1} ({band})",
            a.slope
        ));
    }
    if !SOUND_GAIN.contains(&a.gain) {
        return State::Off(format!("{to} is {:.4} times the {derivative} of {from} ({band})", a.gain));
    }
    State::Sound
}

/// Between reference and displacement stands the loop: only its lowest frequencies say anything, and only roughly; of signs only
/// those up to `follows`, Hz.
fn tracking(found: Option<Agreement>, follows: f64) -> State {
    // A loop follows at frequencies below its own; above them its phase says nothing of signs, and its gain of units.
    let Some(a) = found.filter(|a| !a.unrelated && a.from_hz < FOLLOWS) else { return State::Unknown };
    if a.low_turned {
        let broken = format!("displacement runs against the reference ({:.1} Hz)", a.from_hz);
        return if a.from_hz < follows { State::Broken(broken) } else { State::Unknown };
    }
    if !SOUND_TRACKING.contains(&a.low_gain) {
        return State::Broken(format!("displacement is {:.4} times the reference ({:.1} Hz)", a.low_gain, a.from_hz));
    }
    if a.lead_s > 0.0 {
        return State::Broken(format!("displacement comes {:.1} ms before its reference", 1e3 * a.lead_s));
    }
    State::Sound
}

/// Between what is slow of reference and displacement lies no unit, however little else the two have in common.
fn slow_part(reference: &[f64], displacement: &[f64], dt: f64) -> State {
    let window = ((1.0 / (FOLLOWS * dt)) as usize).max(1);
    let size = |samples: &[f64]| {
        let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
        (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len().max(1) as f64).sqrt()
    };
    let slow = |samples: &[f64]| -> f64 {
        let means: Vec<f64> =
            filled(samples).chunks_exact(window).map(|chunk| chunk.iter().sum::<f64>() / window as f64).collect();
        if means.len() < 8 { f64::NAN } else { size(&means) }
    };
    let (asked, shown) = (slow(reference), slow(displacement));
    let ratio = shown / asked;
    // A reference that is fast says nothing of this; a unit is a factor of ten or more.
    if asked > 0.3 * size(&filled(reference)) && !(0.1..10.0).contains(&ratio) && ratio.is_finite() {
        return State::Broken(format!("displacement is {ratio:.4} times the reference below {FOLLOWS} Hz"));
    }
    State::Unknown
}

/// A positive command moves the table towards positive displacement, whatever else stands between them.
fn driving(found: Option<Agreement>) -> State {
    let sure = |a: &Agreement| !a.unrelated && a.in_step > 0.8 && a.slow_bins >= 8 && a.from_hz < 1.5;
    let Some(a) = found.filter(sure) else { return State::Unknown };
    if a.turned {
        return State::Broken("the table moves against the command".to_owned());
    }
    State::Sound
}

fn size(channel: Channel, samples: &[f64], largest: f64) -> State {
    let span = quantile(samples, 0.999) - quantile(samples, 0.001);
    if span > largest {
        return State::Broken(format!("{channel} spans {span:.0} in SI units, more than any table's {largest:.0}"));
    }
    State::Sound
}

fn replay_state(replay: &Replay) -> State {
    if replay.reproduces() || replay.reproduces_with_other_gains() {
        return State::Sound;
    }
    State::Broken(format!("the stated controller misses the recorded command by {:.0} %", 100.0 * replay.stated_error))
}

/// Every single repair, the likelier ones first.
fn repairs(signals: &Signals<'_>, sources: &PerChannel<ChannelSource>) -> Vec<Repair> {
    use Channel::{Acceleration, Command, Displacement, Reference, Velocity};
    let there = |c: &Channel| signals.get(*c).is_some();
    let singles: Vec<Channel> =
        [Acceleration, Velocity, Reference, Displacement, Command].into_iter().filter(there).collect();
    let mut repairs: Vec<Repair> = singles.iter().map(|&c| Repair::Sign(c)).collect();
    let lengths: Vec<Channel> = [Reference, Displacement].into_iter().filter(there).collect();
    let groups = singles.iter().map(|&c| vec![c]).chain((lengths.len() == 2).then_some(lengths));
    for channels in groups {
        let Some(stated) = channels.first().and_then(|&c| sources.get(c)).map(|s| s.unit) else { continue };
        for recorded in UNITS.iter().filter(|u| u.dimension == stated.dimension && u.factor != stated.factor) {
            repairs.push(Repair::Unit { channels: channels.clone(), stated, recorded: *recorded });
        }
    }
    for &channel in &singles {
        let Some(stated) = sources.get(channel).map(|s| s.unit) else { continue };
        let alike: Vec<Unit> = UNITS.into_iter().filter(|u| u.dimension == stated.dimension).collect();
        let pairs = alike.iter().flat_map(|from| alike.iter().map(move |to| (*from, *to)));
        repairs.extend(pairs.filter(|(f, t)| f.factor != t.factor).map(|(from, to)| Repair::Factor {
            channel,
            from,
            to,
        }));
    }
    for (i, &a) in singles.iter().enumerate() {
        repairs.extend(singles[i + 1..].iter().map(|&b| Repair::Swap(a, b)));
    }
    repairs
}

fn repaired<'a>(signals: &Signals<'a>, repair: &Repair, sources: &PerChannel<ChannelSource>) -> Signals<'a> {
    let mut out = signals.clone();
    let scaled = |channel: Channel, by: f64| signals.get(channel).map(|s| s.iter().map(|x| x * by).collect::<Vec<_>>());
    let factor = |channel: Channel| sources.get(channel).map_or(1.0, |s| s.unit.factor);
    let mut set = |channel: Channel, samples: Option<Vec<f64>>| {
        if let Some(samples) = samples {
            out.set(channel, Cow::Owned(samples));
        }
    };
    match repair {
        Repair::Sign(channel) => set(*channel, scaled(*channel, -1.0)),
        Repair::Unit { channels, stated, recorded } => {
            for &channel in channels {
                set(channel, scaled(channel, recorded.factor / stated.factor));
            }
        }
        Repair::Factor { channel, from, to } => set(*channel, scaled(*channel, from.factor / to.factor)),
        Repair::Swap(a, b) => {
            set(*a, scaled(*b, factor(*a) / factor(*b)));
            set(*b, scaled(*a, factor(*b) / factor(*a)));
        }
    }
    out
}

/// The last of [`Repair::kind`].
const LAST_KIND: u8 = 3;

impl Repair {
    /// True for a factor.
    fn rescales(&self) -> bool {
        matches!(self, Self::Unit { .. } | Self::Factor { .. })
    }

    /// The likelier kinds have the lower numbers.
    fn kind(&self) -> u8 {
        match self {
            Self::Sign(_) => 0,
            Self::Unit { .. } => 1,
            Self::Swap(..) => 2,
            Self::Factor { .. } => 3,
        }
    }

    fn finding(&self, run: &Run, evidence: &str) -> Finding {
        let whole = |channel, fault| Finding::whole(run, channel, fault, Severity::BadData);
        match self {
            Self::Sign(channel) => whole(*channel, Fault::Inverted).saying(
                format!("the sign of {channel} is turned round: {evidence}"),
                format!("turn the sign of column {channel}, or of its wiring, and check which direction is positive"),
            ),
            Self::Unit { channels, stated, recorded } => {
                let names: Vec<&str> = channels.iter().map(|c| c.name()).collect();
                let names = names.join(" and ");
                whole(channels[0], Fault::WrongUnit).saying(
                    format!("{names}: recorded in {}, not in {} as stated: {evidence}", recorded.symbol, stated.symbol),
                    format!("write `unit = \"{}\"` for {names}", recorded.symbol),
                )
            }
            Self::Factor { channel, from, to } => whole(*channel, Fault::WrongUnit).saying(
                format!(
                    "{channel} is {:.4} times too large, the factor between {} and {}: {evidence}",
                    to.factor / from.factor,
                    to.symbol,
                    from.symbol
                ),
                format!("check how {channel} was converted: twice, or the wrong way round"),
            ),
            Self::Swap(a, b) => whole(*a, Fault::Swapped).saying(
                format!("the columns of {a} and {b} are swapped: {evidence}"),
                format!("exchange the columns of {a} and {b} in [channels]"),
            ),
        }
    }
}

/// A unit that is wrong where several others would do as well, as where the size of a channel is all that speaks.
fn undecided(run: &Run, best: &(Repair, f64), others: &[(Repair, f64)], evidence: &str) -> Option<Finding> {
    let (Repair::Unit { channels, stated, .. }, least) = best else { return None };
    let mut units: Vec<Unit> = Vec::new();
    for (other, distance) in others {
        if let Repair::Unit { channels: of, recorded, .. } = other
            && of == channels
            && *distance < least + ACCURATE
            && units.iter().all(|unit| unit.factor != recorded.factor)
        {
            units.push(*recorded);
        }
    }
    if units.len() < 2 {
        return None;
    }
    let names = channels.iter().map(|c| c.name()).collect::<Vec<_>>().join(" and ");
    let possible = units.iter().map(|unit| unit.symbol).collect::<Vec<_>>().join(", ");
    Some(Finding::whole(run, channels[0], Fault::WrongUnit, Severity::BadData).saying(
        format!("{names}: not recorded in {} as stated: {evidence}; of {possible} each is possible", stated.symbol),
        format!("write the unit that the recorder used for {names}"),
    ))
}

/// A factor that no unit explains: what a sensor, or physics, may do is left to the diagnosis.
fn off(run: &Run, link: &Link, evidence: &str) -> Finding {
    let channel = link.about.channel();
    Finding::whole(run, channel, Fault::WrongUnit, Severity::Remark).saying(
        format!("{evidence}; no unit explains it"),
        format!("check the calibration of {channel}; it is diagnosed as it is"),
    )
}

fn unexplained(run: &Run, link: &Link, evidence: &str) -> Finding {
    let channel = link.about.channel();
    Finding::whole(run, channel, Fault::Unrelated, Severity::BadData).saying(
        format!("{evidence}; no single sign, unit or swap explains it"),
        format!("check the column, the unit and the calibration of {channel}"),
    )
}
