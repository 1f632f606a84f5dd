//! The laboratory's indices of a response beside E_a and E_d: once as a table, once as JSON, the same for every command.

use crate::motion::metrics::Indices;
use crate::plant::sensors::GRAVITY;
use crate::report::{Item, Table};
use serde_json::Value;

/// The shape that docs/formats.md states; what is not known is null.
pub(crate) fn value(found: &Indices) -> Value {
    found.json()
}

/// A number, or that there is none; what rounds to zero has no sign.
fn or_none(x: f64, places: usize) -> String {
    let text = if x.is_finite() { format!("{x:.places$}") } else { "\u{2013}".into() };
    let zero = |rest: &&str| rest.chars().all(|c| matches!(c, '0' | '.'));
    text.strip_prefix('-').filter(zero).map(str::to_owned).unwrap_or(text)
}

/// The most telling of them, for the top of a page.
pub(crate) fn tiles(found: &Indices) -> Vec<(String, String)> {
    vec![
        ("waveform error".into(), format!("{:.1} %", 100.0 * found.waveform)),
        ("spectrum beyond 10 %".into(), format!("{:.0} % of periods", 100.0 * found.spectrum)),
        ("peak error".into(), format!("{:+.1} %", 100.0 * found.peak)),
        ("delay".into(), format!("{} ms", or_none(1e3 * found.delay, 1))),
        ("gain".into(), or_none(found.gain, 3)),
        ("coherence".into(), or_none(found.coherence, 3)),
    ]
}

/// All of them, each column a response.
pub(crate) fn tables(columns: &[(&str, &Indices)]) -> Vec<Item> {
    let row = |name: &str, of: &dyn Fn(&Indices) -> String| {
        std::iter::once(name.to_owned()).chain(columns.iter().map(|(_, i)| of(i))).collect::<Vec<_>>()
    };
    let percent = |x: f64| or_none(100.0 * x, 1);
    let g = |x: f64| or_none(x / GRAVITY, 4);
    let mut rows = vec![
        row("waveform error, no shift [%]", &|i| percent(i.waveform)),
        row("periods with S_a beyond 10 % [%]", &|i| percent(i.spectrum)),
        row("periods with S_a beyond 20 % [%]", &|i| percent(i.spectrum_20)),
        row("peak error [%]", &|i| percent(i.peak)),
        row("delay [ms]", &|i| or_none(1e3 * i.delay, 1)),
        row("RMS error [g]", &|i| g(i.rms)),
        row("RMS error, delay taken out [g]", &|i| g(i.rms_less_delay)),
        row("RMS error over peak [%]", &|i| percent(i.rms_of_peak)),
        row("gain, 0.5 to 15 Hz", &|i| or_none(i.gain, 3)),
        row("coherence, 0.5 to 15 Hz", &|i| or_none(i.coherence, 3)),
    ];
    if let Some((_, first)) = columns.first() {
        for (k, band) in first.bands.iter().enumerate() {
            let of = |i: &Indices| i.bands.get(k).map_or_else(String::new, |b| g(b.rms));
            rows.push(row(&format!("RMS error, {} to {} Hz [g]", band.from, band.to), &of));
        }
    }
    let head = |first: &str| std::iter::once(first.to_owned()).chain(columns.iter().map(|(n, _)| (*n).to_owned()));
    let indices = Table {
        caption:
            "Waveform, spectrum and peak (the three indices of NCREE, in our definitions), delay, gain and coherence"
                .into(),
        columns: head("index").collect(),
        rows,
    };
    vec![Item::Table(indices)].into_iter().chain(columns.iter().filter_map(transfer)).collect()
}

fn transfer((name, found): &(&str, &Indices)) -> Option<Item> {
    let rows = found.transfer.iter().map(|at| {
        vec![format!("{:.1}", at.frequency), or_none(at.gain, 3), or_none(at.phase, 1), or_none(at.coherence, 3)]
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| {
        Item::Table(Table {
            caption: format!("Transfer from reference to {name}; hidden where the coherence is below 0.8"),
            columns: ["frequency [Hz]", "gain", "phase [deg]", "coherence"].map(String::from).into(),
            rows,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::or_none;

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(or_none(-0.04, 1), "0.0");
        assert_eq!(or_none(-0.06, 1), "-0.1");
        assert_eq!(or_none(f64::NAN, 1), "\u{2013}");
    }
}
