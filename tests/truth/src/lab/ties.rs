//! Ties: a visible effect that the recordings of its case do not tell from others, in tests that show little.
//!
//! The true effect is clear by the measure of every other stratum, and by what the stated model leaves under the commands that
//! ran. A rival belongs to the tie where its best form, with its own parameters and those of the stated model fitted, follows the
//! recordings so nearly that twice the difference of the log likelihoods is below four: two standard deviations.

pub mod likelihood;
pub mod rival;
pub mod table;

use super::answer::Tie;
use super::choose::{Chosen, Ingredient, mates};
use super::flaw::{Flawed, flaw, weighed};
use super::forms;
use super::measure::Frame;
use super::plan::{Stratum, turn};
use super::scene::{Kind, Scene, Wish};
use crate::plan::Strength;
use crate::rng::Stream;
use likelihood::Recordings;
use rival::{left_by, left_by_none};
use table::{ROWS, Row};

/// Most deals of a case.
const DEALS: u64 = 24;
/// Deals of one row of the table before the next has its turn.
const EACH: u64 = 4;
/// Twice the difference of the expected log likelihoods below which two effects are not told apart: two standard deviations.
const TOLD: f64 = 4.0;
/// Least that the true effect adds to chi2, as in clear cases.
const CLEAR: f64 = 5.0;

/// A tie for case `number` of `seed`; a visible effect by itself where none came out in the deals there are.
pub(super) fn deal(seed: u64, number: u64) -> Option<(Scene, Flawed)> {
    let mut alone = None;
    for deals in 1..=DEALS {
        let mut rng = Stream::new(seed, number, 0x6c61_6274_6965 + deals);
        let row = &ROWS[(turn(seed, number) + ((deals - 1) / EACH) as usize) % ROWS.len()];
        let Some((scene, flawed)) = visible(row, (seed, number), &mut rng) else { continue };
        let Some(tie) = tie(row, deals, &scene, &flawed) else { continue };
        if !tie.rivals.is_empty() {
            return Some((scene, tied(flawed, tie)));
        }
        alone = Some((scene, flawed));
    }
    alone
}

fn tied(mut flawed: Flawed, tie: Tie) -> Flawed {
    let mut group: Vec<String> = flawed.effects.iter().map(|p| p.id.clone()).collect();
    group.extend(tie.rivals.iter().map(|(id, _)| (*id).to_string()));
    flawed.groups = vec![group];
    flawed.tie = Some(tie);
    flawed
}

/// A test of a row with one of its effects in it; none where the effect is not clear.
fn visible(row: &Row, case: (u64, u64), rng: &mut Stream) -> Option<(Scene, Flawed)> {
    let all = forms::of(row.effects[rng.below(row.effects.len())]);
    let form = Ingredient::Listed(all[rng.below(all.len())]);
    let chosen = Chosen { what: Stratum::Confounded, list: vec![(form, rng.log_uniform(7.5, 25.0))] };
    let wish = Wish {
        kind: Kind::Servo,
        saturating: false,
        accelerometer: row.test.accelerometer,
        damping_known: false,
        perfect: rng.chance(0.1),
        test: Some(row.test),
    };
    let scene = Scene::draw(wish, case, rng)?;
    let flawed = flaw(&scene, &Frame::new(&scene), &chosen, rng)?;
    let (scene, flawed) = weighed(scene, flawed);
    (Strength::of(1.0 + flawed.excess) != Strength::Faint).then_some((scene, flawed))
}

/// The rivals of the true effect, those of its row first; none where the recordings show too little of it to anybody who has the
/// commands.
fn tie(row: &Row, deals: u64, scene: &Scene, flawed: &Flawed) -> Option<Tie> {
    let effect = &flawed.effects.first()?.id;
    let recordings = Recordings::of(scene, &flawed.plant)?;
    let seen = left_by_none(scene, &recordings)?;
    if seen < CLEAR * recordings.values() as f64 {
        return None;
    }
    let apart = |rival: &'static str| {
        let left = forms::of(rival).into_iter().filter_map(|form| left_by(scene, &recordings, &form, TOLD));
        let least = left.fold(f64::INFINITY, f64::min);
        (least < TOLD).then(|| (rival, least.sqrt()))
    };
    let own = row.effects.iter().copied().filter(|id| id != effect);
    let mut rivals: Vec<_> = own.filter_map(apart).collect();
    if !rivals.is_empty() {
        // Whoever names another that is as good is right as well: all that act there or look like it are tried.
        rivals.extend(mates(effect).into_iter().filter(|id| !row.effects.contains(id)).filter_map(apart));
    }
    Some(Tie { deals, seen: seen.sqrt(), rivals })
}
