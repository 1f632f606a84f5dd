//! A model with the effects it has, and which of its parameters a fit may move.

mod details;

pub use super::signal_scales::SignalScales;
use crate::plant::effects::{ENTRIES, Entry, Role};
use crate::plant::model::Kind;

/// By what share of its stated value a positive parameter may well change that means something else beside an effect.
const REDEFINED: f64 = 0.02;

/// One parameter's value and how a fit treats it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// Smallest value a fit may give it.
    pub low: f64,
    /// Largest value a fit may give it.
    pub high: f64,
    /// Fitted by its logarithm.
    pub positive: bool,
    /// A fit may move it.
    pub free: bool,
    /// What is known of it beforehand.
    pub prior: Option<Prior>,
}

/// What is known of a value before a fit: where its coordinate is, and how surely.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior {
    /// The coordinate.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
    /// True where an effect freed the value, for as long as it is there.
    pub lent: bool,
}

impl Value {
    /// A value that no fit moves.
    pub fn fixed(value: f64) -> Self {
        Self { value, low: value, high: value, positive: false, free: false, prior: None }
    }

    /// The coordinate a fit works in.
    pub fn coordinate(&self) -> f64 {
        if self.positive { self.value.max(f64::MIN_POSITIVE).ln() } else { self.value }
    }

    /// Sets the value from its coordinate, within bounds.
    pub fn set_coordinate(&mut self, coordinate: f64) {
        let value = if self.positive { coordinate.exp() } else { coordinate };
        self.value = value.clamp(self.low, self.high);
    }

    /// Derivative of the value by its coordinate.
    pub fn slope(&self) -> f64 {
        if self.positive { self.value } else { 1.0 }
    }
}

/// An effect a model has.
#[derive(Debug, Clone)]
pub struct ModelEffect {
    /// What it is.
    pub entry: &'static Entry,
    /// Its parameters in the order of the entry; those of `PerRun` live with the runs.
    pub values: Vec<Value>,
}

/// A model with the effects it has.
#[derive(Debug, Clone)]
pub struct Model {
    /// Which equations.
    pub kind: Kind,
    /// The model's own parameters in the order of [`Kind::parameters`].
    pub own: Vec<Value>,
    /// Pressure per acceleration, where pressure is measured and the model does not state it.
    pub scale: Option<Value>,
    /// The effects, in the order of the registry.
    pub effects: Vec<ModelEffect>,
    /// What it may be missing beside the library's effects: the user's own, and a clock at another rate.
    pub library: Vec<&'static Entry>,
    /// True over stated sampling period, less one, by what a controller's law makes of its recorded command; none where that says nothing.
    pub clock_told: Option<f64>,
}

impl ModelEffect {
    /// Its parameters' values, in the order of the entry.
    pub fn numbers(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.value).collect()
    }

    /// An effect at the `index`-th combination of its starting values; none past the last.
    pub fn start(entry: &'static Entry, index: usize, signal_scales: &SignalScales) -> Option<Self> {
        let mut rest = index;
        let mut values = Vec::with_capacity(entry.parameters.len());
        for parameter in entry.parameters {
            let start = parameter.starts.get(rest % parameter.starts.len())?;
            rest /= parameter.starts.len();
            let size = signal_scales.size(parameter.signal_scale);
            values.push(Value {
                value: start * size,
                low: parameter.low * size,
                high: parameter.high * size,
                positive: parameter.positive,
                free: parameter.role == Role::Shared,
                prior: None,
            });
        }
        (rest == 0).then_some(Self { entry, values })
    }
}

impl Model {
    /// Its own parameters, in the order of [`Kind::parameters`], and nothing beside them.
    pub fn bare(kind: Kind, own: Vec<Value>) -> Self {
        Self { kind, own, scale: None, effects: Vec::new(), library: Vec::new(), clock_told: None }
    }

    /// This model with one more effect, kept in the order of the registry.
    pub fn with(&self, effect: ModelEffect) -> Self {
        let mut model = self.clone();
        for (own, parameter) in model.own.iter_mut().zip(self.kind.parameters()) {
            if effect.entry.frees.contains(&parameter.key) && !own.free {
                own.free = true;
                own.prior = Some(Prior { mean: own.coordinate(), std: REDEFINED, lent: true });
            }
        }
        model.effects.push(effect);
        // A user's own come last, in the order in which they were added.
        let place = |p: &ModelEffect| ENTRIES.iter().position(|e| e.id == p.entry.id).unwrap_or(ENTRIES.len());
        model.effects.sort_by_key(place);
        model
    }

    /// This model without one effect; what only that effect freed is what was known of it again.
    pub fn without(&self, id: &str) -> Self {
        let mut model = self.clone();
        model.effects.retain(|p| p.entry.id != id);
        let freed = |key| model.effects.iter().any(|p| p.entry.frees.contains(&key));
        for (own, parameter) in model.own.iter_mut().zip(self.kind.parameters()) {
            if let Some(known) = own.prior.filter(|prior| prior.lent && !freed(parameter.key)) {
                own.set_coordinate(known.mean);
                (own.free, own.prior) = (false, None);
            }
        }
        model
    }

    /// One of its own values by its key.
    pub fn own_mut(&mut self, key: &str) -> Option<&mut Value> {
        let place = self.kind.parameters().iter().position(|p| p.key == key)?;
        self.own.get_mut(place)
    }

    /// Its effects' identifiers, each with its parameters' values.
    pub fn placements(&self) -> impl Iterator<Item = (&'static str, Vec<f64>)> {
        self.effects.iter().map(|p| (p.entry.id, p.numbers()))
    }

    /// The identifiers of its effects.
    pub fn ids(&self) -> Vec<&'static str> {
        self.effects.iter().map(|p| p.entry.id).collect()
    }

    /// The identifiers of its effects that are not among `stated`.
    pub fn ids_beside(&self, stated: &[&'static str]) -> Vec<&'static str> {
        self.ids().into_iter().filter(|id| !stated.contains(id)).collect()
    }

    /// The effects that a model of this kind may be missing.
    pub fn candidates(&self) -> Vec<&'static Entry> {
        let present = self.ids();
        let fits = |e: &&Entry| e.kinds.contains(&self.kind) && !present.contains(&e.id);
        ENTRIES.iter().chain(&self.library).copied().filter(fits).collect()
    }

    /// True where the equation of one of its effects is a case of another's.
    pub fn is_redundant(&self) -> bool {
        let ids = self.ids();
        self.effects.iter().any(|p| p.entry.contains.iter().any(|id| ids.contains(id)))
    }

    /// Every shared value, in a fixed order: own, scale, effects.
    pub fn values(&self) -> impl Iterator<Item = &Value> {
        self.own.iter().chain(&self.scale).chain(self.effects.iter().flat_map(|p| &p.values))
    }

    /// The same, to change.
    pub fn values_mut(&mut self) -> impl Iterator<Item = &mut Value> {
        self.own.iter_mut().chain(&mut self.scale).chain(self.effects.iter_mut().flat_map(|p| &mut p.values))
    }

    /// How many of the shared values are fitted.
    pub fn free_values(&self) -> usize {
        self.values().filter(|v| v.free).count()
    }

    /// The names of the shared values, in the order of [`Model::values`]: `b0`, `scale`, `coulomb_friction.force`.
    pub fn names(&self) -> Vec<String> {
        let own = self.kind.parameters().iter().map(|p| p.key.to_owned());
        let scale = self.scale.iter().map(|_| "pressure_scale".to_owned());
        let effects = self.effects.iter().flat_map(|placed| {
            placed.entry.parameters.iter().map(|parameter| format!("{}.{}", placed.entry.id, parameter.key))
        });
        own.chain(scale).chain(effects).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::effects::entry;

    #[test]
    fn what_an_effect_freed_is_known_again_without_it() {
        let own = [0.69, 138.0, 57.65, 0.242].map(Value::fixed);
        let own = own.map(|v| Value { low: 0.1 * v.value, high: 10.0 * v.value, positive: true, ..v }).to_vec();
        let stated = Model::bare(Kind::Servo, own);
        let placed = |id: &str| ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
        let mut soft = stated.with(placed("flow_softening")).with(placed("null_bias"));
        let limit = soft.own_mut("velocity_limit").unwrap();
        assert!(limit.free, "softening frees the limit");
        limit.value = 0.25;
        assert_eq!(soft.without("null_bias").own, soft.own);
        let hard = soft.without("flow_softening").own;
        assert!((hard[3].value - 0.242).abs() < 1e-12 && !hard[3].free && hard[3].prior.is_none(), "{:?}", hard[3]);
        assert_eq!(hard[..3], stated.own[..3]);
    }

    /// A stated value that may be fitted stays where it was fitted and free, however much is known of it: every fit of a model less
    /// one of its effects rests on that.
    #[test]
    fn a_fitted_value_stays_free_without_an_effect() {
        let mut own = [0.69, 138.0, 57.65, 0.242].map(Value::fixed);
        own[1].free = true;
        own[1].prior = Some(Prior { mean: own[1].coordinate(), std: 0.25, lent: false });
        let stated = Model::bare(Kind::Servo, own.to_vec());
        let mut biased =
            stated.with(ModelEffect::start(entry("null_bias").unwrap(), 0, &SignalScales::TYPICAL).unwrap());
        biased.own_mut("b0").unwrap().value = 150.0;
        assert_eq!(biased.without("null_bias").own, biased.own);
    }

    #[test]
    fn a_law_beside_one_that_contains_it_is_redundant() {
        let own = [0.69, 138.0, 57.65, 0.242].map(Value::fixed).to_vec();
        let stated = Model::bare(Kind::Servo, own);
        let placed = |id: &str| ModelEffect::start(entry(id).unwrap(), 0, &SignalScales::TYPICAL).unwrap();
        let friction = stated.with(placed("stribeck_friction"));
        assert!(!friction.is_redundant() && !friction.with(placed("viscous_friction")).is_redundant());
        assert!(friction.with(placed("coulomb_friction")).is_redundant());
    }
}
