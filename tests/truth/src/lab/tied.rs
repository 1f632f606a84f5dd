//! Effects that the data of a case do not tell apart, by the examiner's own estimate: each rival is set as strong as the
//! flaw, and what the two leave beside the refitted model is compared.

use super::choose::{Ingredient, mates};
use super::forms::{self, Dial};
use super::measure::{Frame, cosine, seek};
use super::plant::Plant;
use super::scene::{Kind, Scene};
use crate::effect::Draw;
use crate::rng::Stream;

/// Largest flaw that is looked at, in standard deviations: what two effects that are most alike leave of a larger one is
/// seen.
const LOOKED_AT: f64 = 100.0;
/// Least that must part two effects, in standard deviations, for the data to tell them apart.
const APART: f64 = 2.0;

/// The group of a single effect, itself first; none where the data tell it from every rival.
pub(super) fn group(scene: &Scene, frame: &Frame, effect: &str, own: &[f64], sigma: f64) -> Option<Vec<String>> {
    if sigma > LOOKED_AT {
        return None;
    }
    let left = frame.left(own);
    let excess = frame.visible(own).excess;
    let mut members = vec![effect.to_string()];
    for rival in mates(effect) {
        let apart = forms::of(rival).into_iter().filter_map(|form| {
            if form.needs.servo && scene.kind != Kind::Servo {
                return None;
            }
            let draw = Draw::new(&mut Stream::new(scene.sensor.seed.0, scene.sensor.seed.1, 0x7469_6564));
            let plant = |s: f64| {
                let mut plant = Plant::baseline(scene.truth);
                Ingredient::Listed(form).build(&mut plant, &Dial { s, draw, scales: scene.scales });
                plant
            };
            let (strength, _) = seek(frame, excess, &plant)?;
            let other = frame.left(&frame.deviation(&plant(strength))?);
            let alike = cosine(&left, &other).max(0.0);
            Some(sigma * (1.0 - alike * alike).max(0.0).sqrt())
        });
        if apart.fold(f64::INFINITY, f64::min) < APART {
            members.push(rival.to_string());
        }
    }
    (members.len() > 1).then_some(members)
}
