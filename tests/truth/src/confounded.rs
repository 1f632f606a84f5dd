//! Effects that small, slow motion makes look alike: found by what each leaves once the baseline has done what it can.

use crate::effect::{Draw, Effect};
use crate::plant::Physics;
use crate::refit::{Refit, dot, least_squares, less, tangents};
use crate::rng::Stream;
use crate::scene::Scene;
use crate::strength::{Sized, measure, paired};

/// Families whose members resemble each other in slow motion.
const FAMILIES: [&[Effect]; 2] = [
    &[Effect::CommandDelay, Effect::ValveLag, Effect::Leakage, Effect::OilCompliance, Effect::DisplacementLag],
    &[Effect::CoulombFriction, Effect::ValveDeadband],
];

/// A true effect with the others that explain these data as well.
#[derive(Debug, Clone)]
pub struct Group {
    /// The one that is there, at its strength.
    pub effect: Effect,
    /// Its strength.
    pub strength: f64,
    /// All that cannot be told apart, the true one first.
    pub members: Vec<Effect>,
    /// Its traces without noise.
    pub sized: Sized,
}

/// A rival passes as indistinguishable where it leaves less than this of the sum of squares: two standard deviations.
const TELLING: f64 = 4.0;

/// Looks for a group in the scene; none where the data tell all apart.
pub fn find(scene: &Scene, draw: &Draw, rng: &mut Stream) -> Option<Group> {
    let family = FAMILIES[rng.below(FAMILIES.len())];
    let truth = family[rng.below(family.len())];
    // Dry friction and overlap differ in a twentieth of what they do: only where both are barely seen are they one.
    let target = if family.len() > 2 { rng.log_uniform(50.0, 150.0) } else { rng.log_uniform(25.0, 50.0) };
    let (strength, sized, mine) = at_misfit(scene, truth, draw, target)?;
    let mut members = vec![truth];
    for &rival in family.iter().filter(|e| **e != truth) {
        let Some((_, _, theirs)) = at_misfit(scene, rival, draw, target) else { continue };
        let along = dot(&mine, &theirs) / dot(&theirs, &theirs);
        if along > 0.0 && dot(&mine, &mine) - along * along * dot(&theirs, &theirs) < TELLING {
            members.push(rival);
        }
    }
    (members.len() > 1).then_some(Group { effect: truth, strength, members, sized })
}

/// The strength at which the flaw leaves a sum of squares of `target` (in noise units), and what it leaves.
fn at_misfit(scene: &Scene, effect: Effect, draw: &Draw, target: f64) -> Option<(f64, Sized, Vec<f64>)> {
    let mut strength = 0.02;
    for _ in 0..5 {
        let mut physics = Physics::baseline(scene.truth);
        effect.apply(strength, draw, &scene.scales, &mut physics);
        let sized = measure(scene, &physics)?;
        let left = projected(scene, &sized)?;
        let size = dot(&left, &left);
        if (size / target).ln().abs() < 0.3 {
            return Some((strength, sized, left));
        }
        strength = (strength * (target / size.max(1e-6)).sqrt().clamp(0.1, 10.0)).clamp(1e-4, 1.0);
    }
    None
}

/// Residuals over all runs less what the baseline's parameters explain of them.
fn projected(scene: &Scene, sized: &Sized) -> Option<Vec<f64>> {
    let runs = paired(&scene.runs, &sized.traces);
    let base = Refit { machine: scene.truth, offset: 0.0 };
    let (r, columns) = tangents(&base, &scene.fit, &runs, &scene.sigma, 1);
    let x = least_squares(&columns, &r)?;
    Some(less(&r, &columns, &x))
}
