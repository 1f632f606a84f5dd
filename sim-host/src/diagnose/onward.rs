//! Grows the accepted model on where no search did: judging puts models first, fitted to their end, with details of their forms or in
//! the place of what they are mistaken for, that were poorer or not there when the search grew the next size.

use super::calibration::CALIBRATION;
use super::finish::simplify;
use super::judged::ScoredModel;
use super::ranking::Ranking;
use super::search::{CHANCE, MOST, Search, grow_onward};
use super::split::Weighing;
use super::standing::kept;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Models with one effect more than the accepted one, the most credible first; none where the search grew it, where it leaves little, or
/// where it leaves so much that it is not what is there.
pub(super) fn onward(
    weighing: &Weighing,
    search: &Search,
    before: &ScoredModel,
    after: &ScoredModel,
    count: usize,
) -> Result<Vec<ScoredModel>, SimulateError> {
    let little = after.hold.chi2.max(after.fit.chi2()) < 1.0 + CALIBRATION.hidden;
    let most = kept(before, after) < (1.0 - CALIBRATION.most).powi(2);
    if little || !most || after.added.len() >= MOST || is_grown(search, after) {
        return Ok(Vec::new());
    }
    let grown = grow_onward(&after.fit, search, weighing.fitted())?;
    let judged = grown.into_par_iter().take(count).map(|fit| ScoredModel::of(fit, weighing));
    let mut judged = judged.collect::<Result<Vec<_>, _>>()?;
    simplify(before, &mut judged, weighing)?;
    Ranking::new(before, &judged).sort(&mut judged);
    Ok(judged)
}

/// True where the search knows a model that holds these effects and others and leaves less than these alone.
fn is_grown(search: &Search, after: &ScoredModel) -> bool {
    let mut larger = search.grown.iter().skip(after.added.len()).flatten();
    let ours = after.fit.model.ids();
    let holds = |ids: &[&'static str]| ours.iter().all(|id| ids.contains(id));
    let less = after.fit.squares - CHANCE;
    larger.any(|fit| fit.squares < less && holds(&fit.model.ids()))
}

#[cfg(test)]
mod tests;
