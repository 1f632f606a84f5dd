//! The test that would settle what is open: of a catalogue of short runs, the one that is predicted to hold the accepted
//! model and its closest rival furthest apart, the rival's values free to follow as far as the runs at hand let them.

mod catalogue;

use super::calibration::CALIBRATION;
use super::planned::Planned;
use super::result::NextTest;
use super::term::Modelled;
use super::verdict::Conclusion;
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, predict};
use crate::identify::fit::Fit;
use crate::identify::model::Model;
use crate::identify::prepare::Prepared;
use crate::plant::effects::{entry, remainder};
use crate::plant::simulate::SimulateError;
use catalogue::{GainScaling, Reach, Shape};
use rayon::prelude::*;

/// Tests named beside the best one.
const NAMED: usize = 4;
/// Other models of the accepted one's size that a test is to exclude, at most.
const OTHERS: usize = 2;
/// Share of the accepted model's belief below which another needs no test.
const EXCLUDED: f64 = 0.02;
/// The largest chance that is stated: no equation is the table's own, and what its form leaves may look like its rival.
const SUREST: f64 = 0.95;
/// The least chance of settling the question that a test is proposed for.
const WORTH_RUNNING: f64 = 0.05;

/// What is to be run next.
#[derive(Debug)]
pub(super) enum Proposal {
    /// Nothing is open.
    Nothing,
    /// A test that would settle what is open.
    Test(NextTest),
    /// No test within the reach of these runs would; in a sentence.
    Untold(String),
}

impl Proposal {
    /// The test, and why there is none though something is open.
    pub(super) fn parts(self) -> (Option<NextTest>, Option<String>) {
        match self {
            Self::Nothing => (None, None),
            Self::Test(test) => (Some(test), None),
            Self::Untold(why) => (None, Some(why)),
        }
    }
}

/// The accepted model and those that a test is to tell from it, the closest first.
struct Alternatives<'a> {
    accepted: &'a Fit,
    others: Vec<&'a Fit>,
}

impl Alternatives<'_> {
    fn closest(&self) -> Option<&Fit> {
        self.others.first().copied()
    }
}

/// A test with the least distance it is predicted to make between the accepted model and another, in standard deviations.
struct PredictedTest {
    shape: Shape,
    gains: GainScaling,
    distance: f64,
}

/// Proposes a test; none where nothing is open, or where none would settle it.
pub(super) fn next_test(
    prepared: &Prepared,
    conclusion: &Conclusion,
    modelled: Option<&Modelled>,
) -> Result<Proposal, SimulateError> {
    let Some(rivals) = rivals(conclusion, modelled) else { return Ok(Proposal::Nothing) };
    let Some(pattern) = prepared.fit.first() else { return Ok(Proposal::Nothing) };
    if pattern.motion.is_some() || !pattern.law.simulates_reference() {
        return Ok(by_the_book(&rivals).map_or(Proposal::Nothing, Proposal::Test));
    }
    let reach = Reach::of(prepared, &rivals.accepted.model);
    let as_it_ran =
        foresee_all(&rivals, pattern, &reach, &catalogue::shapes(pattern, &reach), GainScaling::AsTheyWere)?;
    let best: Vec<Shape> = as_it_ran.iter().take(NAMED).map(|f| f.shape).collect();
    let mut all = foresee_all(&rivals, pattern, &reach, &best, GainScaling::Halved)?;
    all.extend(as_it_ran);
    all.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    all.truncate(NAMED + 1);
    // Each of the best is simulated with the rival as the truth too: what one follows the other may not.
    let turned = turned(&rivals, pattern, &reach, &all)?;
    for (test, distance) in all.iter_mut().zip(turned) {
        test.distance = test.distance.min(distance);
    }
    all.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    Ok(proposed(&rivals, pattern, &reach, &all))
}

/// The best test, where it is worth its run.
fn proposed(rivals: &Alternatives, pattern: &Run, reach: &Reach, all: &[PredictedTest]) -> Proposal {
    let Some(best) = all.first() else { return Proposal::Nothing };
    if settles(best.distance) < WORTH_RUNNING {
        return Proposal::Untold(format!(
            "No test within the reach of these runs is expected to tell {}: the best is predicted to hold them {:.1} standard \
             deviations of the noise apart",
            sides(rivals),
            best.distance
        ));
    }
    Proposal::Test(NextTest {
        why: why(rivals, best.distance),
        record: catalogue::in_words(best.shape, best.gains, reach),
        separation: Some(best.distance),
        chance: Some(settles(best.distance)),
        planned: Some(Planned::of(
            &catalogue::run(pattern, best.shape, best.gains, reach),
            best.gains == GainScaling::Halved,
        )),
        others: all
            .iter()
            .skip(1)
            .take(NAMED)
            .map(|f| (catalogue::in_words(f.shape, f.gains, reach), f.distance))
            .collect(),
    })
}

/// The accepted model and the one that comes closest to it with as many effects; curves, where the library holds neither.
fn rivals<'a>(conclusion: &'a Conclusion, modelled: Option<&'a Modelled>) -> Option<Alternatives<'a>> {
    if conclusion.consistent() {
        return None;
    }
    if conclusion.unlisted {
        let modelled = modelled?;
        return Some(Alternatives { accepted: &modelled.judged.fit, others: vec![modelled.rival.as_ref()?] });
    }
    // Both as fitted to the training, so that their squares compare.
    let accepted = &conclusion.decision.accepted;
    let other = |c: &&super::judged::ScoredModel| c.added.len() == accepted.added.len() && c.added != accepted.added;
    let all: Vec<_> = conclusion.decision.candidates.iter().filter(other).collect();
    let open = |c: &&&super::judged::ScoredModel| c.probability > EXCLUDED * accepted.probability;
    let others: Vec<&Fit> =
        all.iter().take(1).chain(all.iter().skip(1).filter(open)).take(OTHERS).map(|c| &c.fit).collect();
    (!others.is_empty()).then_some(Alternatives { accepted: &accepted.fit, others })
}

/// The chance that a test settles the question: that the log odds of the true model over another, which are distributed about
/// half the squared distance with the distance as their deviation, pass what counts as a tie.
fn settles(distance: f64) -> f64 {
    if distance <= 0.0 {
        return 0.0;
    }
    let z = (0.5 * distance * distance - CALIBRATION.tie) / distance;
    // The logistic curve that comes nearest to the normal distribution's: within a hundredth.
    SUREST / (1.0 + (-1.702 * z).exp())
}

/// What the library says of a pair that cannot be simulated from a reference.
fn by_the_book(rivals: &Alternatives) -> Option<NextTest> {
    let id = differ(&rivals.accepted.model, &rivals.closest()?.model).into_iter().next()?;
    let why = format!("{}; its size was not predicted, for these runs are driven by what was measured", aim(rivals));
    Some(NextTest {
        why,
        record: entry(id)?.test.to_owned(),
        separation: None,
        chance: None,
        planned: None,
        others: Vec::new(),
    })
}

/// Distances that tests are predicted to make between the accepted model, as the truth, and the closest of the others.
fn foresee_all(
    rivals: &Alternatives,
    pattern: &Run,
    reach: &Reach,
    shapes: &[Shape],
    gains: GainScaling,
) -> Result<Vec<PredictedTest>, SimulateError> {
    let foreseen = |&shape: &Shape| -> Result<PredictedTest, SimulateError> {
        let run = played(&rivals.accepted.model, catalogue::run(pattern, shape, gains, reach))?;
        let parted = rivals.others.iter().map(|other| Ok(other.parted_by(&run)?.sqrt()));
        let parted = parted.collect::<Result<Vec<f64>, SimulateError>>()?;
        Ok(PredictedTest { shape, gains, distance: parted.into_iter().fold(f64::INFINITY, f64::min) })
    };
    let mut all = shapes.par_iter().map(foreseen).collect::<Result<Vec<_>, _>>()?;
    all.retain(|f| f.distance.is_finite());
    all.sort_by(|a, b| b.distance.total_cmp(&a.distance));
    Ok(all)
}

/// The same for the best tests with each other model as the truth and the accepted one following it.
fn turned(
    rivals: &Alternatives,
    pattern: &Run,
    reach: &Reach,
    tests: &[PredictedTest],
) -> Result<Vec<f64>, SimulateError> {
    let turn = |test: &PredictedTest| -> Result<f64, SimulateError> {
        let parted = rivals.others.iter().map(|other| {
            let run = played(&other.model, catalogue::run(pattern, test.shape, test.gains, reach))?;
            let distance = rivals.accepted.parted_by(&run)?.sqrt();
            Ok(if distance.is_finite() { distance } else { 0.0 })
        });
        Ok(parted.collect::<Result<Vec<f64>, SimulateError>>()?.into_iter().fold(f64::INFINITY, f64::min))
    };
    tests.par_iter().map(turn).collect()
}

/// A test as it would be recorded were this model the table.
fn played(model: &Model, mut run: Run) -> Result<Run, SimulateError> {
    let seen = predict(model, &run, &Local::start(model, &run))?;
    for (measured, values) in run.measured.iter_mut().zip(seen.channels) {
        measured.judged &= values.iter().all(|v| v.is_finite());
        measured.values = values;
    }
    Ok(run)
}

/// Effects of the first model that the second has not.
fn differ(model: &Model, other: &Model) -> Vec<&'static str> {
    let others = other.ids();
    model.ids().into_iter().filter(|id| !others.contains(id)).collect()
}

/// The accepted model and its closest rival, by what each has that the other has not.
fn sides(rivals: &Alternatives) -> String {
    let side = |model: &Model, other: &Model| {
        let ids = differ(model, other);
        if ids.is_empty() { "the rest of the model".to_owned() } else { ids.join(" with ") }
    };
    let accepted = &rivals.accepted.model;
    let Some(rival) = rivals.closest().map(|fit| &fit.model) else { return String::new() };
    format!("{} from {}", side(accepted, rival), side(rival, accepted))
}

fn aim(rivals: &Alternatives) -> String {
    let curve = remainder::entries().any(|e| rivals.accepted.model.ids().contains(&e.id));
    let what = if curve { "to tell what the unlisted part follows, " } else { "to part " };
    format!("{what}{}", sides(rivals))
}

fn why(rivals: &Alternatives, distance: f64) -> String {
    let squares = rivals.closest().map_or(f64::NAN, |fit| fit.squares);
    let at_hand = (squares - rivals.accepted.squares).max(0.0).sqrt();
    format!(
        "{}: predicted to hold them {distance:.1} standard deviations of the noise apart, which settles the question with a \
         chance of {:.0} %; the runs fitted hold them {at_hand:.1} apart",
        aim(rivals),
        100.0 * settles(distance)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_that_holds_models_no_further_apart_than_noise_settles_nothing() {
        assert!(settles(0.0) == 0.0 && settles(1.0) < 0.02, "{}", settles(1.0));
        // At log odds of a tie it is as likely as not.
        let even = (2.0 * CALIBRATION.tie).sqrt();
        assert!((settles(even) - 0.5 * SUREST).abs() < 1e-9);
        assert!(settles(20.0) > 0.99 * SUREST && settles(20.0) <= SUREST);
    }
}
