//! Terms of the grammar as effects of a user's own: expression, states and parameters.

use super::grammar::{Form, Memory, Term, Times};
use super::sizes::written;
use crate::plant::effects::Stage;
use crate::plant::effects::own::{Sense, Stated, StatedParameter};

/// Names of the parameters beside the coefficients: a wave's length, and what a memory needs.
const LENGTH: &str = "length";
const MEMORY: &str = "memory";

impl Term {
    /// Its expression with coefficients of these names.
    fn expression(self, coefficients: &[String]) -> String {
        let state = self.follows.state();
        let slug = self.slug();
        let followed = match self.memory {
            Memory::None | Memory::Relay | Memory::Late => state.to_owned(),
            Memory::Lag => format!("lag({state}, {MEMORY}_{slug})"),
            Memory::Play => format!("play({state}, {MEMORY}_{slug})"),
        };
        let passing = match self.sense {
            Sense::Acceleration => "acceleration",
            _ => "command",
        };
        let product = |coefficient: &str, form: &str| {
            let form = if self.memory == Memory::Relay {
                let relay = format!("relay({state}, {MEMORY}_{slug})");
                if form.is_empty() { relay } else { format!("{relay}*{form}") }
            } else if self.memory == Memory::Late {
                format!("lag({form}, {MEMORY}_{slug})")
            } else {
                form.to_owned()
            };
            match self.times {
                Times::One => format!("{coefficient}*({form})"),
                Times::Against => format!("{coefficient}*({form}*velocity_sign)"),
                Times::Velocity => format!("{coefficient}*({form}*velocity)"),
                Times::Passing => format!("{coefficient}*({form}*{passing})"),
            }
        };
        let s = followed.as_str();
        let relay = self.memory == Memory::Relay;
        let form = match self.form {
            // What memory takes from it: none of it where the motion is slow, or wide.
            Form::Linear if matches!(self.memory, Memory::Lag | Memory::Play) => format!("{s} - {state}"),
            Form::Linear => s.to_owned(),
            Form::Magnitude => format!("abs({s})"),
            Form::OddSquare => format!("{s}*abs({s})"),
            Form::Square => format!("{s}^2"),
            Form::Cube if relay => format!("abs({s}^3)"),
            Form::Cube => format!("{s}^3"),
            Form::Root if self.follows.grows() => format!("sqrt({s})"),
            Form::Root => format!("sign({s})*sqrt(abs({s}))"),
            Form::Direction if relay => String::new(),
            Form::Direction => format!("sign({s})"),
            Form::Wave => {
                let wave = |of: &str| format!("{of}(2*pi*{s}/{LENGTH}_{slug})");
                return coefficients
                    .iter()
                    .zip(["cos", "sin"])
                    .map(|(c, of)| product(c, &wave(of)))
                    .collect::<Vec<_>>()
                    .join(" + ");
            }
        };
        coefficients.first().map_or_else(String::new, |c| product(c, &form))
    }

    /// The name of the parameter that is a wave's length.
    pub(super) fn length_key(self) -> String {
        format!("{LENGTH}_{}", self.slug())
    }
}

/// Where a term of this sense acts.
pub(super) fn stage(sense: Sense) -> Stage {
    match sense {
        Sense::Command => Stage::Command,
        Sense::Gain => Stage::Flow,
        Sense::Force | Sense::ForcePerMass => Stage::Table,
        Sense::Displacement | Sense::Acceleration => Stage::Sensor,
    }
}

/// The name of a sense in an identifier.
fn sense_slug(sense: Sense) -> &'static str {
    match sense {
        Sense::Command => "command",
        Sense::Gain => "gain",
        Sense::ForcePerMass => "force",
        Sense::Force => "newton",
        Sense::Displacement => "displacement",
        Sense::Acceleration => "acceleration",
    }
}

/// Values far beyond any table: a statement's own range, which the fit narrows to what the runs reach.
const WIDE: f64 = 1e9;

/// Some terms at one place as one effect of a user's own. `screening` splits a wave into its one coefficient `of`.
pub(super) fn stated(terms: &[Term], screening: Option<usize>) -> Option<Stated> {
    let sense = terms.first()?.sense;
    let (mut expressions, mut parameters, mut states) = (Vec::new(), Vec::new(), Vec::<String>::new());
    let mut id = format!("term_{}", sense_slug(sense));
    let parameter = |name: String, unit: String, range: [f64; 3]| StatedParameter {
        name,
        unit,
        low: range[0],
        high: range[1],
        start: range[2],
        meaning: "found by a diagnosis".into(),
    };
    for term in terms {
        let slug = term.slug();
        id += &format!("_{slug}");
        let names: Vec<String> = match term.form {
            Form::Wave => vec![format!("even_{slug}"), format!("odd_{slug}")],
            _ => vec![format!("k_{slug}")],
        };
        let mut expression = term.expression(&names);
        let mut kept = names;
        if let (Form::Wave, Some(of)) = (term.form, screening) {
            let part = expression.split(" + ").nth(of)?.to_owned();
            expression = part;
            kept = vec![kept.get(of)?.clone()];
            id += ["_cos", "_sin"].get(of)?;
        }
        parameters.extend(kept.into_iter().map(|name| parameter(name, term.unit(), [-WIDE, WIDE, 0.0])));
        let unit = written(term.follows.dimension().map(|e| 2 * e), false);
        if term.form == Form::Wave {
            parameters.push(parameter(format!("{LENGTH}_{slug}"), unit.clone(), [1e-6, 1e3, 1.0]));
        }
        match term.memory {
            Memory::None => {}
            Memory::Lag | Memory::Late => {
                parameters.push(parameter(format!("{MEMORY}_{slug}"), "s".into(), [1e-4, 1e2, 0.1]));
            }
            _ => parameters.push(parameter(format!("{MEMORY}_{slug}"), unit, [1e-9, 1e2, 0.1])),
        }
        let mut uses = vec![term.follows.state()];
        match term.times {
            Times::One => {}
            Times::Against => uses.push("velocity_sign"),
            Times::Velocity => uses.push("velocity"),
            Times::Passing => uses.push(if sense == Sense::Acceleration { "acceleration" } else { "command" }),
        }
        for state in uses {
            if !states.iter().any(|s| s == state) {
                states.push(state.into());
            }
        }
        expressions.push(expression);
    }
    Some(Stated {
        id,
        stage: stage(sense),
        states,
        expression: expressions.join(" + "),
        parameters,
        mistaken_for: Vec::new(),
    })
}
