//! Where the reply says that model and recordings part, against where the flaw acts.

use super::super::record::{Region, Reply, Stretch, TrueRegion, Truth};

/// Whether the block is one at which a flaw acts.
pub(super) fn block(reply: &Reply, truth: &Truth) -> bool {
    let said = reply.location.as_ref().and_then(|l| l.block.as_deref());
    said.is_some_and(|said| truth.location.blocks.iter().any(|b| b == said))
}

/// F1 over time, over the runs in which the reply says anything: twice what both hold over what either holds.
pub(super) fn over_time(reply: &Reply, truth: &Truth) -> Option<f64> {
    if truth.location.time.is_empty() {
        return None;
    }
    let said = reply.location.as_ref().map_or(&[][..], |l| &l.time);
    let mut runs: Vec<&str> = said.iter().filter_map(|s| s.run.as_deref()).collect();
    runs.sort_unstable();
    runs.dedup();
    let (mut both, mut sum) = (0.0, 0.0);
    for run in runs {
        let of = |list: &[Stretch]| {
            let own = list.iter().filter(|s| s.run.as_deref().is_none_or(|name| name == run));
            joined(own.map(|s| (s.from_s, s.to_s)).collect())
        };
        let (mine, its) = (of(said), of(&truth.location.time));
        both += mine.iter().flat_map(|a| its.iter().map(|b| (a.1.min(b.1) - a.0.max(b.0)).max(0.0))).sum::<f64>();
        sum += mine.iter().chain(&its).map(|s| s.1 - s.0).sum::<f64>();
    }
    Some(if sum > 0.0 { 2.0 * both / sum } else { 0.0 })
}

/// Stretches without overlap.
fn joined(mut list: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (from, to) in list {
        match out.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.max(to),
            _ => out.push((from, to)),
        }
    }
    out
}

/// F1 over the rows that lie in the region, by the best of the reply's regions of the same variable.
pub(super) fn over_state(reply: &Reply, truth: &Truth) -> Option<f64> {
    let region = truth.location.state.first()?;
    let said = reply.location.as_ref().map_or(&[][..], |l| &l.state);
    let own = said.iter().filter(|s| s.variable == region.variable || (region.magnitude && s.variable == "speed"));
    Some(own.filter_map(|s| f1(region, s)).fold(0.0, f64::max))
}

fn f1(truth: &TrueRegion, said: &Region) -> Option<f64> {
    let (from, to) = ends(said)?;
    let (mut both, mut sum) = (0.0, 0.0);
    for value in &truth.quantiles {
        let magnitude = if truth.magnitude { value.abs() } else { *value };
        let there = (truth.low..=truth.high).contains(&magnitude);
        let of = if said.variable == "speed" { value.abs() } else { *value };
        let in_it = (from..=to).contains(&of);
        both += f64::from(there && in_it);
        sum += f64::from(there) + f64::from(in_it);
    }
    (sum > 0.0).then(|| 2.0 * both / sum)
}

/// The region's ends: as numbers, or the last two numbers of its words.
fn ends(said: &Region) -> Option<(f64, f64)> {
    if let (Some(from), Some(to)) = (said.from, said.to) {
        return Some((from, to));
    }
    let numbers: Vec<f64> = said.words.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [.., from, to] => Some((from, to)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::record::{Location, Region, Reply, Stretch, TrueRegion, Truth};
    use super::{over_state, over_time};

    fn stretch(run: Option<&str>, from_s: f64, to_s: f64) -> Stretch {
        Stretch { run: run.map(Into::into), from_s, to_s }
    }

    fn replied(location: Location) -> Reply {
        Reply { location: Some(location), ..Reply::default() }
    }

    #[test]
    fn f1_over_time_counts_what_both_hold() {
        let mut truth = Truth::default();
        assert!(over_time(&Reply::default(), &truth).is_none());
        truth.location.time = vec![stretch(None, 2.0, 4.0)];
        assert_eq!(over_time(&Reply::default(), &truth), Some(0.0));
        let said = |list: Vec<Stretch>| replied(Location { time: list, ..Location::default() });
        assert_eq!(over_time(&said(vec![stretch(Some("a"), 2.0, 4.0)]), &truth), Some(1.0));
        // Overlapping stretches count once; half of what is said is there: 2 * 2 / (4 + 2).
        let twice = said(vec![stretch(Some("a"), 0.0, 3.0), stretch(Some("a"), 1.0, 4.0)]);
        assert!((over_time(&twice, &truth).unwrap() - 4.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn f1_over_state_counts_rows() {
        let mut truth = Truth::default();
        truth.location.state = vec![TrueRegion {
            variable: "displacement".into(),
            low: 0.0,
            high: 9.0,
            quantiles: vec![-2.0, -1.0, 1.0, 2.0],
            ..TrueRegion::default()
        }];
        let said = |words: &str, variable: &str| {
            let region = Region { variable: variable.into(), words: words.into(), ..Region::default() };
            replied(Location { state: vec![region], ..Location::default() })
        };
        assert_eq!(over_state(&said("strongest from 5e-1 to 3e0", "displacement"), &truth), Some(1.0));
        assert_eq!(over_state(&said("strongest from 1.5e0 to 3e0", "displacement"), &truth), Some(2.0 / 3.0));
        assert_eq!(over_state(&said("strongest from 5e-1 to 3e0", "velocity"), &truth), Some(0.0));
    }
}
