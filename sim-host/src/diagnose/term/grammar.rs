//! The grammar of terms: place x state x form x memory, each term an effect of the user's own that is linear in its coefficients.

use crate::plant::effects::own::Sense;
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
    /// What it gives comes with a first-order lag.
    Late,
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
#[derive(Debug, Clone, Copy, Default)]
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
    pub(super) fn state(self) -> &'static str {
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
    pub(super) fn dimension(self) -> [i32; 3] {
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
    pub(super) fn grows(self) -> bool {
        matches!(self, Self::Path | Self::Time)
    }
}

impl Term {
    /// Every term without memory that a model of this kind may lack, waves left out.
    pub(super) fn plain(kind: Kind) -> Vec<Self> {
        let mut all = Vec::new();
        for sense in senses(kind) {
            for follows in states(sense, kind) {
                let forms: &[Form] = if follows.grows() {
                    &[Form::Linear, Form::Square, Form::Root]
                } else {
                    &[
                        Form::Linear,
                        Form::Magnitude,
                        Form::OddSquare,
                        Form::Square,
                        Form::Cube,
                        Form::Root,
                        Form::Direction,
                    ]
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
                    (Sense::Command | Sense::Acceleration, _) => &[
                        (Form::Linear, Times::Passing),
                        (Form::Magnitude, Times::Passing),
                        (Form::Square, Times::Passing),
                    ],
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
        let with = |form, memory| Self { form, memory, ..base };
        if self.may_remember() {
            let forms = [Linear, Magnitude, OddSquare, Square, Cube, Root];
            all.extend(forms.map(|form| with(form, Memory::Lag)));
            all.extend(forms[1..].iter().map(|&form| with(form, Memory::Late)));
            all.extend(forms.map(|form| with(form, Memory::Play)));
            all.extend([Direction, Magnitude, Square, Cube].map(|form| with(form, Memory::Relay)));
            all.push(with(Form::Wave, Memory::Late));
        }
        all
    }

    /// Terms that remember the last turn, one of each kind at every place: what they do looks like no term without memory that
    /// follows the same.
    pub(super) fn turning(kind: Kind) -> Vec<Self> {
        let forms = [(Form::Linear, Memory::Play), (Form::Square, Memory::Relay)];
        let mut all = Vec::new();
        for sense in senses(kind) {
            for follows in states(sense, kind) {
                all.extend(forms.map(|(form, memory)| Self { sense, follows, form, memory, times: Times::One }));
            }
        }
        all.retain(|term| term.may_remember());
        all
    }

    /// True where memory adds something to what a term follows: what only grows has no last turn.
    fn may_remember(self) -> bool {
        !self.follows.grows() && self.sense != Sense::Acceleration
    }

    /// True where it bends what the valve is asked for or lets through, and is no force in another place.
    pub(super) fn is_of_the_valve(self) -> bool {
        let by_command = self.sense == Sense::Command && self.follows == Follows::Command;
        by_command || (self.sense == Sense::Gain && self.follows != Follows::Velocity)
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
            Memory::Lag | Memory::Late => vec![0.01, 0.05, 0.25],
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
