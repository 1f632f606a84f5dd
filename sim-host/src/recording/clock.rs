//! From time stamps that may jitter, repeat or leave rows out to an even grid.
//!
//! A simulation steps evenly, so rows are placed on a grid: of the mean step over all rows, which is exact where none is missing,
//! or of the mean of the steps near the median one, whichever strains the stamps less. A stamp a little off its place is jitter and keeps its row; one beyond 0.7 of a step leaves the places between
//! empty (NaN); a stamp that does not advance keeps its row where the next stamp has moved on by two, else the row is
//! a double and goes. What was found is kept, for the quality checks.

/// What the stamps of a run were like.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Clock {
    /// Standard deviation of the stamps about the grid, s.
    pub jitter: f64,
    /// Largest distance of a stamp from the grid, s.
    pub jitter_peak: f64,
    /// Stamps that repeat the one before, s.
    pub repeated: Vec<f64>,
    /// Stamps earlier than the one before, s.
    pub backwards: Vec<f64>,
    /// Rows that were left out because their stamp was there already, s.
    pub doubled: Vec<f64>,
    /// Stamps far ahead of their place, the next being back on its own, s.
    pub misread: Vec<f64>,
    /// Rows without a stamp (NaN), by their place in the grid, s.
    pub unstamped: Vec<f64>,
    /// Stretches with no row: the last stamp before, the first after, s.
    pub gaps: Vec<(f64, f64)>,
    /// The stamps' own resolution is coarser than the step, so that rows were placed by their order alone.
    pub coarse: bool,
    /// How far each place of the grid lies before the stamp of its row, s; empty where no stamp is off.
    pub offsets: Vec<f64>,
}

impl Clock {
    /// How many places the stamps are irregular in.
    pub fn irregular(&self) -> usize {
        self.gaps.len() + self.doubled.len() + self.misread.len()
    }
}

/// Rows placed on an even grid.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    /// Time of the first place, s.
    pub(crate) start: f64,
    /// Step, s.
    pub(crate) dt: f64,
    /// The row at each place, none where there is no row.
    pub(crate) rows: Vec<Option<usize>>,
    /// What the stamps were like.
    pub(crate) clock: Clock,
}

impl Grid {
    /// How far the stamps are from their places: squares in steps, an irregular place counting as one step. A grid that is a little too
    /// wide swallows what is missing, and every row lies off its place.
    fn strain(&self) -> f64 {
        self.rows.len() as f64 * (self.clock.jitter / self.dt).powi(2) + self.clock.irregular() as f64
    }
}

/// Why no grid can be laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum NoGrid {
    /// Fewer than two stamps are numbers.
    TooFew,
    /// The last stamp is not later than the first.
    Still {
        /// First stamp, s.
        first: f64,
        /// Last stamp, s.
        last: f64,
    },
    /// The gaps would need more places than can be kept.
    TooSparse {
        /// Median step, s.
        step: f64,
        /// Stamped duration, s.
        span: f64,
    },
}

/// Beyond this part of a step a stamp is no longer jitter.
const GAP: f64 = 0.7;

/// Lays the grid under stamps in seconds.
pub(crate) fn lay(stamps: &[f64]) -> Result<Grid, NoGrid> {
    let known: Vec<f64> = stamps.iter().copied().filter(|t| t.is_finite()).collect();
    let (Some(&first), Some(&last)) = (known.first(), known.last()) else { return Err(NoGrid::TooFew) };
    if known.len() < 2 {
        return Err(NoGrid::TooFew);
    }
    if last <= first {
        return Err(NoGrid::Still { first, last });
    }
    let Some(step) = typical_step(&known) else { return Ok(by_order(stamps, first, last)) };
    // Where no row is missing the mean step is exact; where some are, the mean of the steps near the median one is near.
    let mean = (last - first) / (stamps.len() - 1) as f64;
    [mean, step]
        .into_iter()
        .filter(|dt| (0.5 * step..1.5 * step).contains(dt))
        .filter_map(|dt| place(stamps, first, dt))
        .min_by(|a, b| a.strain().total_cmp(&b.strain()))
        .ok_or(NoGrid::TooSparse { step, span: last - first })
}

/// The mean of the steps near the median one; none where the median does not advance.
fn typical_step(stamps: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = stamps.windows(2).map(|w| w[1] - w[0]).collect();
    let mut sorted = steps.clone();
    let middle = sorted.len() / 2;
    let (_, &mut median, _) = sorted.select_nth_unstable_by(middle, f64::total_cmp);
    // A median that the arithmetic cannot tell from zero is a clock coarser than the rows.
    let near: Vec<f64> = steps.into_iter().filter(|s| (0.5 * median..1.5 * median).contains(s)).collect();
    (median > 0.0 && !near.is_empty()).then(|| near.iter().sum::<f64>() / near.len() as f64)
}

fn by_order(stamps: &[f64], first: f64, last: f64) -> Grid {
    let dt = (last - first) / (stamps.len() - 1) as f64;
    let clock = Clock { coarse: true, ..Clock::default() };
    Grid { start: first, dt, rows: (0..stamps.len()).map(Some).collect(), clock }
}

/// Places every row; none where the gaps would need far more places than there are rows.
fn place(stamps: &[f64], first: f64, dt: f64) -> Option<Grid> {
    let most = 4 * stamps.len() + 1_000_000;
    let mut clock = Clock::default();
    let mut rows: Vec<Option<usize>> = Vec::with_capacity(stamps.len());
    let (mut origin, mut squares, mut counted) = (first, 0.0, 0usize);
    let mut previous = f64::NEG_INFINITY;
    let mut offsets: Vec<f64> = Vec::with_capacity(stamps.len());
    for (row, &stamp) in stamps.iter().enumerate() {
        let here = rows.len() as f64;
        if !stamp.is_finite() {
            clock.unstamped.push(origin + here * dt);
            rows.push(Some(row));
            offsets.push(0.0);
            continue;
        }
        if stamp == previous {
            clock.repeated.push(stamp);
        } else if stamp < previous {
            clock.backwards.push(stamp);
        }
        let off = (stamp - origin) / dt - here;
        if off < -GAP && !next_moved_on(&stamps[row + 1..], origin, dt, here) {
            clock.doubled.push(stamp);
            continue;
        }
        if off > GAP && row > 0 {
            if next_is_back(&stamps[row + 1..], origin, dt, here) {
                clock.misread.push(stamp);
                rows.push(Some(row));
                offsets.push(0.0);
                continue;
            }
            clock.gaps.push((previous, stamp));
            let missing = off.round();
            if rows.len() as f64 + missing > most as f64 {
                return None;
            }
            rows.extend(std::iter::repeat_n(None, missing as usize));
            offsets.resize(rows.len(), 0.0);
        }
        let off = (stamp - origin) / dt - rows.len() as f64;
        rows.push(Some(row));
        offsets.push(if off.abs() <= GAP { off * dt } else { 0.0 });
        previous = previous.max(stamp);
        if off.abs() <= GAP {
            // Follows a slow drift of the stamps against the mean step.
            origin += 0.05 * off * dt;
            squares += off * off;
            counted += 1;
            clock.jitter_peak = clock.jitter_peak.max(off.abs() * dt);
        }
    }
    clock.jitter = dt * (squares / counted.max(1) as f64).sqrt();
    if clock.jitter > 1e-6 * dt {
        clock.offsets = offsets;
    }
    Some(Grid { start: first, dt, rows, clock })
}

/// True where the next stamp stands on the place after this one, so that this stamp, far ahead, was misread.
fn next_is_back(rest: &[f64], origin: f64, dt: f64, here: f64) -> bool {
    rest.iter().find(|t| t.is_finite()).is_some_and(|next| ((next - origin) / dt - here - 1.0).abs() <= GAP)
}

/// True where the next stamp stands on the place after this one, so that this row is no double.
fn next_moved_on(rest: &[f64], origin: f64, dt: f64, here: f64) -> bool {
    rest.iter().find(|t| t.is_finite()).is_none_or(|next| (next - origin) / dt > here + 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn even(n: usize, dt: f64) -> Vec<f64> {
        (0..n).map(|k| 3.0 + k as f64 * dt).collect()
    }

    #[test]
    fn rows_that_are_missing_do_not_widen_the_step() {
        let stamps: Vec<f64> = (0..3000)
            .filter(|k| !(1000..1014).contains(k) && !(1500..1519).contains(k))
            .map(|k| f64::from(k) * 0.01)
            .collect();
        let grid = lay(&stamps).unwrap();
        assert!((grid.dt - 0.01).abs() < 1e-9 && grid.clock.jitter < 1e-9, "{} {}", grid.dt, grid.clock.jitter);
        assert_eq!(grid.rows.iter().filter(|row| row.is_none()).count(), 33);
    }

    /// A single row that is missing is no place less irregular than all others a third of a step off theirs.
    #[test]
    fn a_wide_step_does_not_swallow_a_row() {
        let lost = [(243, 1), (908, 20), (1342, 8), (1715, 2)];
        let is_lost = |k: &i32| lost.iter().any(|&(first, count)| (first..first + count).contains(k));
        let stamps: Vec<f64> = (0..2048).filter(|k| !is_lost(k)).map(|k| f64::from(k) / 256.0).collect();
        let grid = lay(&stamps).unwrap();
        assert_eq!((grid.rows.len(), grid.clock.gaps.len()), (2048, 4));
        assert!(grid.clock.jitter < 1e-9, "{}", grid.clock.jitter);
    }

    #[test]
    fn even_stamps_keep_their_rows() {
        let grid = lay(&even(1000, 0.004_882_812_5)).unwrap();
        assert!((grid.dt - 0.004_882_812_5).abs() < 1e-15);
        assert!(grid.rows.iter().enumerate().all(|(k, row)| *row == Some(k)));
        assert!(grid.clock.gaps.is_empty() && grid.clock.jitter < 1e-9);
    }

    #[test]
    fn a_dropped_stretch_leaves_its_places_empty() {
        let mut stamps = even(200, 0.01);
        stamps.drain(50..57);
        let grid = lay(&stamps).unwrap();
        assert_eq!(grid.rows.len(), 200);
        assert_eq!(grid.rows[49..58].iter().filter(|r| r.is_none()).count(), 7);
        assert_eq!(grid.rows[57], Some(50));
        assert_eq!(grid.clock.gaps.len(), 1);
    }

    #[test]
    fn a_doubled_row_goes_and_a_misread_stamp_stays() {
        let mut doubled = even(100, 0.01);
        doubled.insert(40, doubled[39]);
        let grid = lay(&doubled).unwrap();
        assert_eq!((grid.rows.len(), grid.clock.doubled.len(), grid.rows[40]), (100, 1, Some(41)));
        let mut misread = even(100, 0.01);
        misread[40] = misread[39];
        let grid = lay(&misread).unwrap();
        assert_eq!((grid.rows.len(), grid.clock.doubled.len(), grid.clock.repeated.len()), (100, 0, 1));
        assert_eq!(grid.rows[41], Some(41));
    }

    #[test]
    fn one_wild_stamp_makes_no_gap() {
        let mut stamps = even(100, 0.01);
        stamps[40] = 1e9;
        let grid = lay(&stamps).unwrap();
        assert_eq!((grid.rows.len(), grid.clock.misread.len(), grid.clock.gaps.len()), (100, 1, 0));
    }

    #[test]
    fn a_clock_coarser_than_the_rows_goes_by_order() {
        let stamps: Vec<f64> = (0..300).map(|k| (f64::from(k) / 100.0).floor()).collect();
        let grid = lay(&stamps).unwrap();
        assert!(grid.clock.coarse && grid.rows.len() == 300);
    }

    #[test]
    fn time_that_stands_still_is_refused() {
        assert_eq!(lay(&[1.0; 5]), Err(NoGrid::Still { first: 1.0, last: 1.0 }));
        assert_eq!(lay(&[f64::NAN; 5]), Err(NoGrid::TooFew));
        assert!(matches!(lay(&[0.0, 1e-9, 2e-9, 1e9]), Err(NoGrid::TooSparse { .. })));
    }

    proptest! {
        #[test]
        fn jitter_moves_no_row(offsets in prop::collection::vec(-0.3..0.3f64, 100..300), dt in 1e-4..0.1f64) {
            let stamps: Vec<f64> = offsets.iter().enumerate().map(|(k, o)| (k as f64 + o) * dt).collect();
            let grid = lay(&stamps).unwrap();
            prop_assert!(grid.rows.iter().enumerate().all(|(k, row)| *row == Some(k)));
            prop_assert!((grid.dt / dt - 1.0).abs() < 0.007);
        }

        #[test]
        fn no_stamps_crash_it(stamps in prop::collection::vec(any::<f64>(), 0..60)) {
            let _ = lay(&stamps);
        }
    }
}
