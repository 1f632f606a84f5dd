//! What the ties of a seed are like: number, stratum, rows, the true effect with how visible it is, and its rivals with how far
//! they stay apart, in standard deviations.
//!
//! `cargo run --release -p shakedown-truth --example ties [SEED [CASES]]`

use shakedown_truth::lab::{answer::Answer, case, plan};
use std::io::Write as _;
use std::time::Instant;

fn main() -> std::io::Result<()> {
    let mut numbers = std::env::args().skip(1).map(|a| a.parse::<usize>().unwrap_or(1));
    let seed = numbers.next().unwrap_or(1) as u64;
    let wanted = numbers.next().unwrap_or(8);
    let stored = std::env::temp_dir().join(format!("ties-{}", std::process::id()));
    std::fs::write(&stored, "answered")?;
    let mut out = std::io::stdout().lock();
    let ties = (0..).filter(|n| plan::stratum(seed, *n) == plan::Stratum::Confounded);
    for number in ties.take(wanted) {
        let begun = Instant::now();
        let dealt = case(seed, number);
        let rows: usize = dealt.experiment.sheets.iter().filter_map(|s| s.values.first()).map(Vec::len).sum();
        let opened = dealt.sealed.open_after(&stored).map_err(std::io::Error::other)?;
        let text = line(&opened.answer);
        writeln!(out, "{number:5}  {rows:6} rows  {text}  {:.1} s", begun.elapsed().as_secs_f64())?;
    }
    std::fs::remove_file(&stored)
}

fn line(answer: &Answer) -> String {
    let effects = answer.effects.iter().map(|p| format!("{} ({}), adds {:.1} to chi2", p.id, p.form, p.excess));
    let mut text = format!("{}: {}", answer.stratum, effects.collect::<Vec<_>>().join(", "));
    if let Some(tie) = &answer.tie {
        let rivals = tie.rivals.iter().map(|(id, apart)| format!("{id} {apart:.2}"));
        text += &format!("; seen {:.0}; {}; deal {}", tie.seen, rivals.collect::<Vec<_>>().join(", "), tie.deals);
    }
    text
}
