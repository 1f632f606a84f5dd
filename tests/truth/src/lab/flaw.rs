//! Flaws in a plant: each at the strength asked for, then all together, measured by what each adds to the others.

use super::answer::{Tie, TrueEffect};
use super::choose::{Chosen, Ingredient};
use super::forms::Dial;
use super::law::Gate;
use super::measure::{Frame, Visible, cosine, seek};
use super::plant::Plant;
use super::scene::Scene;
use super::setup::noise::in_loop_of;
use super::tied;
use super::unlisted::block;
use crate::effect::Draw;
use crate::rng::Stream;

/// A plant with its flaws, and what the answer says of them.
pub(super) struct Flawed {
    pub(super) plant: Plant,
    pub(super) effects: Vec<TrueEffect>,
    pub(super) unlisted: Vec<TrueEffect>,
    pub(super) alike: Option<f64>,
    pub(super) excess: f64,
    pub(super) groups: Vec<Vec<String>>,
    pub(super) tie: Option<Tie>,
    sets: Vec<Set>,
}

impl Flawed {
    /// The plant as it is.
    pub(super) fn none(plant: Plant) -> Self {
        let (effects, unlisted, groups, sets) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { plant, effects, unlisted, alike: None, excess: 0.0, groups, tie: None, sets }
    }
}

/// An ingredient at its strength, and where it acts.
struct Set {
    ingredient: Ingredient,
    dial: Dial,
    gate: Option<Gate>,
}

impl Set {
    /// Puts it into a plant; gives parameters and block.
    fn add(&self, plant: &mut Plant) -> (Vec<(&'static str, f64)>, &'static str) {
        let before = plant.clone();
        let parameters = self.ingredient.build(plant, &self.dial);
        if let Some(gate) = self.gate {
            plant.gate_from(&before, gate);
        }
        let places = plant.places_since(&before);
        let inner = if plant.delay == before.delay { "actuator" } else { "command" };
        let at = if places.is_empty() { inner } else { block(&places) };
        (parameters, if at == "table" && self.ingredient.id().contains("payload") { "payload" } else { at })
    }
}

/// Seeks each ingredient's strength by itself, then puts all together.
pub(super) fn flaw(scene: &Scene, frame: &Frame, chosen: &Chosen, rng: &mut Stream) -> Option<Flawed> {
    let baseline = Plant::baseline(scene.truth);
    let mut sets = Vec::new();
    for (ingredient, target) in &chosen.list {
        let gate = chosen.gate(&scene.scales, rng);
        let mut set =
            Set { ingredient: *ingredient, dial: Dial { s: 0.0, draw: Draw::new(rng), scales: scene.scales }, gate };
        let build = |s: f64| {
            let mut plant = baseline.clone();
            Set { dial: Dial { s, ..set.dial }, ..set }.add(&mut plant);
            plant
        };
        (set.dial.s, _) = seek(frame, *target, &build)?;
        sets.push(set);
    }
    if sets.is_empty() {
        return Some(Flawed::none(baseline));
    }
    let flawed = together(scene, frame, &baseline, &sets)?;
    Some(Flawed { sets, ..flawed })
}

/// The flaws at the strengths found, weighed by the noise that there is with them in the loop.
pub(super) fn weighed(scene: Scene, flawed: Flawed) -> (Scene, Flawed) {
    let again = || {
        let own = if flawed.sets.is_empty() { None } else { in_loop_of(&flawed.plant, &scene) }?;
        let measured = together(&own, &Frame::new(&own), &Plant::baseline(own.truth), &flawed.sets)?;
        Some((own, measured))
    };
    again().unwrap_or((scene, flawed))
}

/// All flaws at once, each measured as what it adds to the others.
fn together(scene: &Scene, frame: &Frame, baseline: &Plant, sets: &[Set]) -> Option<Flawed> {
    let with = |left_out: Option<usize>| {
        let mut plant = baseline.clone();
        for (_, set) in sets.iter().enumerate().filter(|(i, _)| Some(*i) != left_out) {
            set.add(&mut plant);
        }
        plant
    };
    let mut flawed = Flawed::none(with(None));
    if flawed.plant.clashes() {
        return None;
    }
    let all = frame.deviation(&flawed.plant)?;
    flawed.excess = frame.refitted(&all);
    let mut left = Vec::new();
    for (i, set) in sets.iter().enumerate() {
        let without = if sets.len() == 1 { vec![0.0; all.len()] } else { frame.deviation(&with(Some(i)))? };
        let own: Vec<f64> = all.iter().zip(&without).map(|(a, b)| a - b).collect();
        let there = present(set, baseline, frame.visible(&own));
        if set.ingredient.listed() { &mut flawed.effects } else { &mut flawed.unlisted }.push(there);
        left.push(frame.left(&own));
    }
    if let ([effect], [set]) = (&flawed.effects[..], sets)
        && set.gate.is_none()
    {
        flawed.groups.extend(tied::group(scene, frame, &effect.id, &all, effect.sigma));
    }
    for i in 0..left.len() {
        for j in 0..i {
            let c = cosine(&left[i], &left[j]);
            if flawed.alike.is_none_or(|most: f64| c.abs() > most.abs()) {
                flawed.alike = Some(c);
            }
        }
    }
    Some(flawed)
}

fn present(set: &Set, baseline: &Plant, visible: Visible) -> TrueEffect {
    let mut plant = baseline.clone();
    let (parameters, block) = set.add(&mut plant);
    let (form, source) = set.ingredient.form();
    let gate = plant.gate_since(baseline);
    TrueEffect {
        id: set.ingredient.id(),
        form,
        source,
        parameters,
        block,
        gate,
        tolerated: set.ingredient.tolerated(),
        excess: visible.excess,
        sigma: visible.sigma,
    }
}
