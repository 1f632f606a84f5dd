//! What goes wrong with recordings on their way to a disk.

use crate::answer::Fault;
use crate::closed_loop::Controller;
use crate::rng::Stream;
use crate::scene::rounded;
use crate::sheet::Sheets;

/// A fault of the data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Corruption {
    /// The stated unit is not that of the numbers.
    WrongUnit,
    /// A sensor wired the wrong way round.
    FlippedSign,
    /// Two columns stated the wrong way round.
    SwappedChannels,
    /// A sensor that holds its last value for a while.
    Stuck,
    /// A converter at the end of its range.
    Clipped,
    /// Time stamps that repeat and scatter.
    ShakyTime,
    /// Rows that were never written.
    MissingStretch,
    /// Gains other than those that ran.
    MisstatedGains,
    /// One channel later than the others.
    ShiftedChannel,
}

use Corruption as C;

impl Corruption {
    /// All of them.
    pub const ALL: [Self; 9] = [
        C::WrongUnit,
        C::FlippedSign,
        C::SwappedChannels,
        C::Stuck,
        C::Clipped,
        C::ShakyTime,
        C::MissingStretch,
        C::MisstatedGains,
        C::ShiftedChannel,
    ];

    /// Spoils an experiment; says what it did.
    pub fn spoil(self, data: &mut Sheets, rng: &mut Stream) -> Fault {
        let run = rng.below(data.sheets.len());
        let channel = match self {
            C::FlippedSign | C::Stuck | C::WrongUnit => rng.pick(["displacement", "acceleration"]),
            C::MisstatedGains | C::SwappedChannels => "command",
            C::ShakyTime | C::MissingStretch => "time",
            C::Clipped | C::ShiftedChannel => "acceleration",
        };
        let place = data.columns.iter().position(|c| c.channel == channel).unwrap_or(0);
        let everywhere = matches!(self, C::WrongUnit | C::FlippedSign | C::SwappedChannels | C::MisstatedGains);
        let file = (!everywhere).then(|| data.sheets[run].file.clone());
        let problem = match self {
            C::WrongUnit => wrong_unit(data, place),
            C::FlippedSign => {
                for sheet in &mut data.sheets {
                    sheet.values[place].iter_mut().for_each(|v| *v = -*v);
                }
                "sign flipped"
            }
            C::SwappedChannels => swapped(data),
            C::MisstatedGains => misstated(data, rng),
            _ => self.spoil_run(&mut data.sheets[run].values, place, rng),
        };
        Fault { problem, channel, run: file }
    }

    fn spoil_run(self, values: &mut [Vec<f64>], place: usize, rng: &mut Stream) -> &'static str {
        let rows = values[0].len();
        let dt = values[0][1] - values[0][0];
        let samples = |seconds: f64| ((seconds / dt) as usize).min(rows / 3);
        match self {
            C::Stuck => {
                // In motion, or it would not be a fault.
                let from = busiest(&values[place], samples(1.0));
                let to = (from + samples(rng.uniform(1.0, 3.0))).min(rows);
                let held = values[place][from];
                values[place][from..to].fill(held);
                "stuck"
            }
            C::Clipped => {
                let range = rng.uniform(0.35, 0.6) * values[place].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                values[place].iter_mut().for_each(|v| *v = v.clamp(-range, range));
                "clipped"
            }
            C::ShakyTime => {
                for _ in 0..20 + rng.below(40) {
                    let k = 1 + rng.below(rows - 2);
                    values[0][k] = values[0][k - 1];
                }
                for v in values[0].iter_mut().skip(1) {
                    *v += 0.3 * dt * rng.normal();
                }
                "time stamps repeat and scatter"
            }
            C::MissingStretch => {
                let from = busiest(&values[1], samples(1.0));
                let gap = samples(rng.uniform(0.5, 2.0));
                for column in values.iter_mut() {
                    column.drain(from..(from + gap).min(rows));
                }
                "rows missing"
            }
            _ => {
                let late = samples(rng.uniform(0.05, 0.15));
                values[place].rotate_right(late);
                values[place][..late].fill(0.0);
                "one channel late"
            }
        }
    }
}

fn wrong_unit(data: &mut Sheets, place: usize) -> &'static str {
    let (from, to) = match data.columns[place].unit {
        "m" => ("m", "mm"),
        "mm" => ("mm", "m"),
        "g" => ("g", "m/s2"),
        _ => ("m/s2", "g"),
    };
    debug_assert_eq!(data.columns[place].unit, from);
    data.columns[place].unit = to;
    "wrong unit stated"
}

/// The columns of displacement and command change places under their headers.
fn swapped(data: &mut Sheets) -> &'static str {
    let place = |channel| data.columns.iter().position(|c| c.channel == channel).unwrap_or(0);
    let (a, b) = (place("displacement"), place("command"));
    for sheet in &mut data.sheets {
        sheet.values.swap(a, b);
    }
    "displacement and command swapped"
}

fn misstated(data: &mut Sheets, rng: &mut Stream) -> &'static str {
    let factor = if rng.chance(0.5) { rng.uniform(1.15, 1.6) } else { rng.uniform(0.6, 0.87) };
    for sheet in &mut data.sheets {
        sheet.controller = match sheet.controller {
            Controller::Pi { kp, ki } => Controller::Pi { kp: rounded(kp * factor, 3), ki },
            Controller::Cascade { kp, kv } => Controller::Cascade { kp: rounded(kp * factor, 5), kv },
        };
    }
    "gains misstated"
}

/// Where the greatest change over `width` samples begins.
fn busiest(values: &[f64], width: usize) -> usize {
    let last = values.len().saturating_sub(3 * width + 1).max(1);
    (width..last.max(width + 1))
        .max_by(|&a, &b| {
            let change = |k: usize| values.get(k + width).map_or(0.0, |v| (v - values[k]).abs());
            change(a).total_cmp(&change(b))
        })
        .unwrap_or(0)
}
