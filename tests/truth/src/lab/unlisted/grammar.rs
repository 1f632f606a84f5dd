//! Unlisted physics by a grammar: a place, the states it depends on, a form, a memory. Sentences that say what the library
//! holds are left out. Which kinds a campaign has follows from its lock.

use crate::lab::forms::{ACCELEROMETER, ANY, Dial, Needs, SERVO};
use crate::lab::law::{Law, Now, Place};
use crate::lab::plant::Plant;
use crate::rng::Stream;
use std::f64::consts::TAU;

/// State that the flaw depends on, scaled to about one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum On {
    Displacement,
    Velocity,
    Command,
    Time,
    Path,
    Pull,
}

/// Form of the dependence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Cubic,
    Square,
    Root,
    Wave,
    Step,
    Bell,
    Product,
}

/// Memory between state and form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Memory {
    None,
    Play,
    Relay,
    Lag,
}

const PLACES: [Place; 6] =
    [Place::Command, Place::Valve, Place::Flow, Place::Force, Place::Displacement, Place::Acceleration];
const STATES: [On; 6] = [On::Displacement, On::Velocity, On::Command, On::Time, On::Path, On::Pull];
const FORMS: [Form; 7] = [Form::Cubic, Form::Square, Form::Root, Form::Wave, Form::Step, Form::Bell, Form::Product];
const MEMORIES: [Memory; 4] = [Memory::None, Memory::Play, Memory::Relay, Memory::Lag];

/// A kind of the grammar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Built {
    place: Place,
    on: On,
    with: On,
    form: Form,
    memory: Memory,
    number: f64,
}

impl Built {
    /// Kind `index` under a lock.
    pub fn draw(lock: u64, index: usize) -> Self {
        let mut rng = Stream::new(lock, index as u64, 0x6772_616d);
        loop {
            let built = Self {
                place: rng.pick(PLACES),
                on: rng.pick(STATES),
                with: rng.pick(STATES),
                form: rng.pick(FORMS),
                memory: rng.pick(MEMORIES),
                number: rng.unit(),
            };
            if !built.listed() {
                return built;
            }
        }
    }

    /// Whether the library has it, or an approximation of it that no recording tells apart.
    fn listed(&self) -> bool {
        let grows = matches!(self.form, Form::Cubic | Form::Root | Form::Step);
        let by_itself = self.memory == Memory::None || self.memory == Memory::Lag;
        let held = match self.place {
            // Dry and viscous friction, spring.
            Place::Force => by_itself && grows && matches!(self.on, On::Velocity | On::Displacement),
            // Drift of a gain.
            Place::Flow | Place::Valve if self.on == On::Time || self.on == On::Path => self.form != Form::Wave,
            // Overlap and asymmetric gain.
            Place::Valve | Place::Command => self.on == On::Command && (grows || self.form == Form::Bell),
            Place::Displacement => self.on == On::Displacement || self.on == On::Time,
            // Tilt, hum and offset.
            Place::Acceleration => self.on == On::Displacement || (self.on == On::Time),
            _ => false,
        };
        held || (self.form == Form::Product && self.on == self.with)
    }

    /// The sentence.
    pub fn name(&self) -> String {
        let with = if self.form == Form::Product { format!(" and {:?}", self.with) } else { String::new() };
        format!("{:?}: {:?} in {:?}{with}, memory {:?}", self.place, self.form, self.on, self.memory).to_lowercase()
    }

    /// What it asks for.
    pub fn needs(&self) -> Needs {
        match self.place {
            Place::Acceleration => ACCELEROMETER,
            Place::Flow => SERVO,
            _ => ANY,
        }
    }

    /// Puts it into a plant.
    pub fn build(&self, plant: &mut Plant, dial: &Dial) {
        plant.add(self.place, Sentence { built: *self, dial: *dial });
    }
}

/// A sentence at work. Memories: the state after its memory.
#[derive(Debug, Clone, Copy)]
struct Sentence {
    built: Built,
    dial: Dial,
}

impl Sentence {
    fn state(&self, on: On, now: &Now) -> f64 {
        let scales = &self.dial.scales;
        match on {
            On::Displacement => now.x / scales.stroke,
            On::Velocity => now.v / scales.velocity,
            On::Command => now.command / scales.command,
            On::Time => 2.0 * now.t / scales.duration - 1.0,
            On::Path => now.path / (4.0 * scales.stroke),
            On::Pull => (now.reference - now.x) / (0.2 * scales.stroke),
        }
    }

    fn form(&self, s: f64, now: &Now) -> f64 {
        let c = self.built.number;
        match self.built.form {
            Form::Cubic => s.clamp(-2.0, 2.0).powi(3),
            Form::Square => s.clamp(-2.0, 2.0).powi(2),
            Form::Root => s.signum() * s.abs().sqrt(),
            Form::Wave => (TAU * (1.0 + 2.0 * c) * s).sin(),
            Form::Step => (12.0 * (s - 0.4 + 0.8 * c)).tanh(),
            Form::Bell => (-((s - 0.5 + c) / 0.25).powi(2)).exp(),
            Form::Product => (s * self.state(self.built.with, now)).clamp(-3.0, 3.0),
        }
    }
}

impl Law for Sentence {
    fn memories(&self) -> usize {
        1
    }

    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        let s = self.state(self.built.on, now);
        m[0] = match self.built.memory {
            Memory::None => s,
            Memory::Play => m[0].clamp(s - 0.3, s + 0.3),
            Memory::Relay if s > 0.3 => 1.0,
            Memory::Relay if s < -0.3 => -1.0,
            Memory::Relay => m[0],
            Memory::Lag => {
                let time = 0.5 / self.dial.scales.top;
                m[0] + (s - m[0]) * (1.0 - (-h / time).exp())
            }
        };
    }

    fn out(&self, now: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        let s = if self.built.memory == Memory::None { self.state(self.built.on, now) } else { m[0] };
        let value = self.dial.s * self.dial.draw.sign * self.form(s, now);
        let scales = &self.dial.scales;
        match self.built.place {
            Place::Command => input + 0.3 * value * scales.command,
            Place::Force => input + 2.0 * value * scales.acceleration,
            Place::Displacement => input + 0.1 * value * scales.stroke,
            Place::Acceleration => input + value * scales.acceleration,
            _ => input * (1.0 + 0.6 * value).max(0.1),
        }
    }
}
