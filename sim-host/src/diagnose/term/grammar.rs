//! The grammar of terms: place x state x form x memory, each term an effect of the user's own that is linear in its coefficients.

use crate::plant::effects::Stage;
use crate::plant::effects::own::{Sense, Stated, StatedParameter};
use crate::plant::model::Kind;

/// What a term follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Follows {
    /// Displacement, m.
    Place,
    /// Velocity, m/s.
    Velocity,
    /// What the accelerometer would show, m/s2.
    Acceleration,
    /// The command.
    Command,
    /// Way travelled since the start, m.
    Path,
    /// Time since the start, s.
    Time,
}

/// How it follows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// In proportion.
    Linear,
    /// With its magnitude.
    Magnitude,
    /// With its square, its sign kept.
    OddSquare,
    /// With its square.
    Square,
    /// With its cube.
    Cube,
    /// With its root, its sign kept.
    Root,
    /// With its direction alone.
    Direction,
    /// As a wave along it.
    Wave,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Memory {
    /// Nothing.
    None,
    /// It follows with a first-order lag.
    Lag,
    /// It follows with a play.
    Play,
    /// A relay with hysteresis gives it its sign.
    Relay,
}

/// What multiplies it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Times {
    /// Nothing.
    One,
    /// The sign of the velocity, as a dry contact has it.
    Against,
    /// The velocity.
    Velocity,
    /// What passes the place: the command at the valve, the acceleration at the accelerometer.
    Passing,
}

/// One term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Term {
    /// What its expression gives, and so where it acts.
    pub(super) sense: Sense,
    /// What it follows.
    pub(super) follows: Follows,
    /// How.
    pub(super) form: Form,
    /// What it remembers.
    pub(super) memory: Memory,
    /// What multiplies it.
    pub(super) times: Times,
}

/// Sizes of what terms follow, on the runs that are fitted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// m.
    pub(super) place: f64,
    /// m/s.
    pub(super) velocity: f64,
    /// m/s2.
    pub(super) acceleration: f64,
    /// Unit of u.
    pub(super) command: f64,
    /// s.
    pub(super) time: f64,
    /// 1, or kilograms of a rigid mass.
    pub(super) mass: f64,
}

impl Follows {
    fn state(self) -> &'static str {
        match self {
            Self::Place => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Command => "command",
            Self::Path => "path",
            Self::Time => "time",
        }
    }

    /// Exponents of metre, second and the command's unit.
    fn dimension(self) -> [i32; 3] {
        match self {
            Self::Place | Self::Path => [1, 0, 0],
            Self::Velocity => [1, -1, 0],
            Self::Acceleration => [1, -2, 0],
            Self::Command => [0, 0, 1],
            Self::Time => [0, 1, 0],
        }
    }

    pub(super) fn reach(self, reach: &Reach) -> f64 {
        match self {
            Self::Place => reach.place,
            Self::Velocity => reach.velocity,
            Self::Acceleration => reach.acceleration,
            Self::Command => reach.command,
            // The way of a run is many times its stroke.
            Self::Path => 0.3 * reach.velocity * reach.time,
            Self::Time => reach.time,
        }
    }

    /// It only grows.
    fn grows(self) -> bool {
        matches!(self, Self::Path | Self::Time)
    }
}

/// Names of the parameters beside the coefficients: a wave's length, and what a memory needs.
const LENGTH: &str = "length";
const MEMORY: &str = "memory";

impl Term {
    /// Every term without memory that a model of this kind may lack, waves left out.
    pub(super) fn plain(kind: Kind) -> Vec<Self> {
        let mut all = Vec::new();
        for sense in senses(kind) {
            for follows in states(sense, kind) {
                let forms: &[Form] = if follows.grows() {
                    &[Form::Linear, Form::Square, Form::Root]
                } else {
                    &[Form::Linear, Form::Magnitude, Form::OddSquare, Form::Square, Form::Cube, Form::Root, Form::Direction]
                };
                let one = forms.iter().map(|&form| (form, Times::One));
                let products: &[(Form, Times)] = match (sense, follows) {
                    (Sense::Force | Sense::ForcePerMass, Follows::Velocity) => &[],
                    (Sense::Force | Sense::ForcePerMass, _) => &[
                        (Form::Linear, Times::Against),
                        (Form::Magnitude, Times::Against),
                        (Form::Square, Times::Against),
                        (Form::Linear, Times::Velocity),
                        (Form::Square, Times::Velocity),
                    ],
                    (Sense::Command, Follows::Command) | (Sense::Acceleration, Follows::Acceleration) => &[],
                    (Sense::Command | Sense::Acceleration, _) => {
                        &[(Form::Linear, Times::Passing), (Form::Magnitude, Times::Passing), (Form::Square, Times::Passing)]
                    }
                    _ => &[],
                };
                let product = |&(form, _): &(Form, Times)| !(follows.grows() && form == Form::Magnitude);
                for (form, times) in one.chain(products.iter().copied().filter(product)) {
                    all.push(Self { sense, follows, form, memory: Memory::None, times });
                }
            }
        }
        all.retain(|term| !term.is_listed());
        all
    }

    /// Terms at the same place that follow the same, with memory, and the wave along it.
    pub(super) fn richer(self) -> Vec<Self> {
        use Form::{Cube, Direction, Linear, Magnitude, OddSquare, Root, Square};
        let base = Self { times: Times::One, memory: Memory::None, ..self };
        let mut all = vec![Self { form: Form::Wave, ..base }];
        let remembers = !self.follows.grows() && self.sense != Sense::Acceleration;
        let with = |form, memory| Self { form, memory, ..base };
        if remembers {
            let forms = [Linear, Magnitude, OddSquare, Square, Cube, Root];
            all.extend(forms.map(|form| with(form, Memory::Lag)));
            all.extend(forms.map(|form| with(form, Memory::Play)));
            all.extend([Direction, Magnitude, Square, Cube].map(|form| with(form, Memory::Relay)));
            all.push(with(Form::Wave, Memory::Lag));
        }
        all
    }

    /// True where the library has the same under a name of its own.
    fn is_listed(self) -> bool {
        let force = matches!(self.sense, Sense::Force | Sense::ForcePerMass);
        match (self.follows, self.form, self.times) {
            (Follows::Velocity, Form::Linear | Form::Direction, Times::One) => force,
            (Follows::Place, Form::Linear | Form::Cube, Times::One) if force => true,
            (Follows::Command, Form::Linear, Times::One) => self.sense == Sense::Command,
            (Follows::Place, Form::Linear, Times::One) => {
                matches!(self.sense, Sense::Displacement | Sense::Acceleration)
            }
            (Follows::Place, Form::Cube, Times::One) => self.sense == Sense::Displacement,
            (Follows::Acceleration, Form::Linear, Times::One) => true,
            (Follows::Time, Form::Linear, Times::One) => self.sense == Sense::Gain,
            _ => false,
        }
    }

    /// How many parameters it has.
    pub(super) fn parameters(self) -> usize {
        let wave = self.form == Form::Wave;
        1 + 2 * usize::from(wave) + usize::from(self.memory != Memory::None)
    }

    /// Values that its parameters beside the coefficients are tried at.
    pub(super) fn shapes(self, reach: &Reach) -> Vec<Vec<f64>> {
        let size = self.follows.reach(reach);
        let lengths: &[f64] = match (self.form == Form::Wave, self.follows.grows()) {
            (false, _) => &[],
            (true, false) => &[0.06, 0.1, 0.15, 0.22, 0.32, 0.45, 0.65, 0.95, 1.4, 2.0],
            (true, true) => &[0.02, 0.03, 0.045, 0.07, 0.1, 0.15, 0.22, 0.32, 0.5, 0.75],
        };
        let memories: Vec<f64> = match self.memory {
            Memory::None => Vec::new(),
            Memory::Lag => vec![0.01, 0.05, 0.25],
            Memory::Play => [0.05, 0.15, 0.4].iter().map(|share| share * size).collect(),
            Memory::Relay => [0.03, 0.2].iter().map(|share| share * size).collect(),
        };
        match (lengths.is_empty(), memories.is_empty()) {
            (true, true) => vec![Vec::new()],
            (false, true) => lengths.iter().map(|l| vec![l * size]).collect(),
            (true, false) => memories.iter().map(|&m| vec![m]).collect(),
            (false, false) => lengths.iter().step_by(2).map(|l| vec![l * size, 0.05]).collect(),
        }
    }

    /// A short name, unlike that of any other term.
    pub(super) fn slug(self) -> String {
        let form = match self.form {
            Form::Linear => "linear",
            Form::Magnitude => "magnitude",
            Form::OddSquare => "odd_square",
            Form::Square => "square",
            Form::Cube => "cube",
            Form::Root => "root",
            Form::Direction => "direction",
            Form::Wave => "wave",
        };
        let memory = match self.memory {
            Memory::None => "",
            Memory::Lag => "_lag",
            Memory::Play => "_play",
            Memory::Relay => "_relay",
        };
        let times = match self.times {
            Times::One => "",
            Times::Against => "_dry",
            Times::Velocity => "_damping",
            Times::Passing => "_gain",
        };
        let state = match self.follows {
            Follows::Place => "x",
            Follows::Velocity => "v",
            Follows::Acceleration => "a",
            Follows::Command => "u",
            Follows::Path => "path",
            Follows::Time => "time",
        };
        format!("{state}_{form}{memory}{times}")
    }

    /// Its expression with coefficients of these names.
    fn expression(self, coefficients: &[String]) -> String {
        let state = self.follows.state();
        let slug = self.slug();
        let followed = match self.memory {
            Memory::None | Memory::Relay => state.to_owned(),
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
                return coefficients.iter().zip(["cos", "sin"]).map(|(c, of)| product(c, &wave(of))).collect::<Vec<_>>().join(" + ");
            }
        };
        coefficients.first().map_or_else(String::new, |c| product(c, &form))
    }

    /// Unit of its coefficients.
    fn unit(self) -> String {
        let power = match self.form {
            Form::Linear | Form::Magnitude => 2,
            Form::OddSquare | Form::Square => 4,
            Form::Cube => 6,
            Form::Root => 1,
            Form::Direction | Form::Wave => 0,
        };
        // Twice the exponents, for roots.
        let mut twice = self.follows.dimension().map(|e| -power * e);
        let gives: [i32; 3] = match self.sense {
            Sense::ForcePerMass | Sense::Acceleration => [1, -2, 0],
            Sense::Force | Sense::Gain => [0, 0, 0],
            Sense::Command => [0, 0, 1],
            Sense::Displacement => [1, 0, 0],
        };
        let times: [i32; 3] = match self.times {
            Times::One | Times::Against => [0, 0, 0],
            Times::Velocity => [1, -1, 0],
            Times::Passing if self.sense == Sense::Acceleration => [1, -2, 0],
            Times::Passing => [0, 0, 1],
        };
        for i in 0..3 {
            twice[i] += 2 * (gives[i] - times[i]);
        }
        written(twice, self.sense == Sense::Force)
    }

    /// Largest coefficient that makes sense: twenty times what passes the place.
    pub(super) fn most(self, reach: &Reach) -> f64 {
        let s = self.follows.reach(reach);
        let form = match self.form {
            Form::Linear | Form::Magnitude => s,
            Form::OddSquare | Form::Square => s * s,
            Form::Cube => s.powi(3),
            Form::Root => s.sqrt(),
            Form::Direction | Form::Wave => 1.0,
        };
        let gives = match self.sense {
            Sense::ForcePerMass | Sense::Acceleration => reach.acceleration.max(1.0),
            Sense::Force => reach.mass * reach.acceleration.max(1.0),
            Sense::Gain => 0.2,
            Sense::Command => reach.command,
            Sense::Displacement => reach.place,
        };
        let times = match self.times {
            Times::One | Times::Against => 1.0,
            Times::Velocity => reach.velocity,
            Times::Passing if self.sense == Sense::Acceleration => reach.acceleration,
            Times::Passing => reach.command,
        };
        20.0 * gives / (form * times).max(1e-12)
    }

    /// What it is, in words.
    pub(super) fn words(self) -> String {
        let state = match self.follows {
            Follows::Place => "displacement",
            Follows::Velocity => "velocity",
            Follows::Acceleration => "acceleration",
            Follows::Command => "command",
            Follows::Path => "the way travelled",
            Follows::Time => "time",
        };
        let form = match self.form {
            Form::Linear => format!("in proportion to {state}"),
            Form::Magnitude => format!("with the magnitude of {state}"),
            Form::OddSquare => format!("odd in {state}, with its square"),
            Form::Square => format!("even in {state}, with its square"),
            Form::Cube => format!("with the cube of {state}"),
            Form::Root => format!("with the square root of {state}"),
            Form::Direction => format!("with the direction of {state} alone"),
            Form::Wave => format!("a wave along {state}"),
        };
        let memory = match self.memory {
            Memory::None => "no memory",
            Memory::Lag => "behind a first-order lag",
            Memory::Play => "behind a play",
            Memory::Relay => "switched by a relay with hysteresis",
        };
        let times = match self.times {
            Times::One => "",
            Times::Against => ", against the motion",
            Times::Velocity => ", times velocity",
            Times::Passing => ", times what passes there",
        };
        format!("{form}{times}, {memory}")
    }
}

/// The places of a model of this kind, by what a term gives there.
fn senses(kind: Kind) -> Vec<Sense> {
    match kind {
        Kind::Servo => vec![Sense::Command, Sense::Gain, Sense::ForcePerMass, Sense::Displacement, Sense::Acceleration],
        Kind::RigidMass => vec![Sense::Command, Sense::Force, Sense::Displacement, Sense::Acceleration],
        Kind::ForceBalance => vec![Sense::ForcePerMass],
    }
}

fn states(sense: Sense, kind: Kind) -> Vec<Follows> {
    let mut all = vec![Follows::Place, Follows::Velocity, Follows::Path, Follows::Time];
    if kind != Kind::ForceBalance {
        all.push(Follows::Command);
    }
    if sense == Sense::Acceleration {
        all.push(Follows::Acceleration);
    }
    all
}

/// A unit from twice its exponents of metre, second and the command's unit; `newton` puts N before them.
fn written(twice: [i32; 3], newton: bool) -> String {
    let part = |sign: i32| {
        let mut factors: Vec<String> = Vec::new();
        for (name, e) in ["m", "s", "u"].iter().zip(twice) {
            let e = e * sign;
            if e == 2 {
                factors.push((*name).to_owned());
            } else if e > 0 {
                factors.push(format!("{name}{}", f64::from(e) / 2.0));
            }
        }
        factors
    };
    let mut above = part(1);
    if newton {
        above.insert(0, "N".into());
    }
    let below = part(-1);
    let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    match below.as_slice() {
        [] => above,
        [one] => format!("{above}/{one}"),
        many => format!("{above}/({})", many.join(" ")),
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
            expression = expression.split(" + ").nth(of)?.to_owned();
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
            Memory::Lag => parameters.push(parameter(format!("{MEMORY}_{slug}"), "s".into(), [1e-4, 1e2, 0.1])),
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
