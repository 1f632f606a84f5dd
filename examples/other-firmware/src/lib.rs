//! A firmware that is not shakedown's own: a plain timer interrupt at 500 Hz, a 16-bit converter of +/-10 V behind a
//! trait of its own, no RTIC, no allocator. It shows that the core needs nothing but numbers in and numbers out.
#![no_std]

use shakedown_core::{Controller, Modification, OperatorRequest, Relay, Sample, Settings, SettingsError, State};
use shakedown_core::settings::{Detection, GuardSettings};

/// Metres per volt of the LVDT and of the reference, and of the output.
const STROKE_PER_VOLT: f32 = 0.0125;
/// m/s2 per volt of the accelerometer.
const ACCELERATION_PER_VOLT: f32 = 2.0 * 9.806_65;
/// Volts per code of a 16-bit converter of +/-10 V.
const VOLT_PER_CODE: f32 = 20.0 / 65_536.0;

/// The board, as this firmware sees it.
pub trait Board {
    /// Codes of reference, LVDT and accelerometer.
    fn read(&mut self) -> [i16; 3];
    /// Code for the valve amplifier.
    fn write(&mut self, code: i16);
    /// The relay of the hydraulic block.
    fn relay(&mut self, closed: bool);
    /// The operator's key: turned on it runs the test, off it stops it. One that is on when the power comes, or after a trip,
    /// runs nothing before it was off.
    fn key(&self) -> bool;
}

/// What the timer interrupt owns.
pub struct Table<B> {
    board: B,
    controller: Controller,
    /// Whether the key has been off since the power came or the test tripped.
    released: bool,
}

impl<B: Board> Table<B> {
    /// The paper's strong controller with causal record modification and the guard, at 500 Hz.
    pub fn new(board: B) -> Result<Self, SettingsError> {
        let mut settings = Settings {
            rate: 500.0,
            modification: Modification::Causal,
            saturation: Some(Detection::default()),
            guard: Some(GuardSettings::default()),
            anti_windup: true,
            ..Settings::default()
        };
        settings.displacement.proportional = 10.0;
        settings.displacement.integral = 1.0;
        Ok(Self { board, controller: Controller::new(&settings)?, released: false })
    }

    /// The timer interrupt.
    pub fn tick(&mut self) {
        let [reference, displacement, acceleration] = self.board.read().map(|code| f32::from(code) * VOLT_PER_CODE);
        let command = self.controller.step(&Sample::new(
            reference * STROKE_PER_VOLT,
            displacement * STROKE_PER_VOLT,
            acceleration * ACCELERATION_PER_VOLT,
        ));
        // A command beyond the converter is cut there; `as` saturates.
        self.board.write((command.valve / (STROKE_PER_VOLT * VOLT_PER_CODE)) as i16);
        self.board.relay(command.status.relay == Relay::Closed);
        let (key, state) = (self.board.key(), command.status.state);
        self.released = state != State::Tripped && (self.released || !key);
        let wanted = match (key, state) {
            (true, State::Off) if self.released => Some(OperatorRequest::Arm),
            (true, State::Ready) => Some(OperatorRequest::Start),
            (false, State::Running) => Some(OperatorRequest::Stop),
            (false, State::Ready) => Some(OperatorRequest::Off),
            _ => None,
        };
        if let Some(request) = wanted {
            // Refused: asked again at the next tick.
            let _ = self.controller.request(request);
        }
    }

    /// The board, to look at.
    pub fn board(&self) -> &B {
        &self.board
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table that goes where it is told: v = 2.4 u, at most 0.242 m/s.
    struct Bench {
        tick: u32,
        x: f32,
        v: f32,
        a: f32,
        oil: bool,
        farthest: f32,
        /// The tick at which the key is turned on.
        turned: u32,
    }

    impl Board for Bench {
        fn read(&mut self) -> [i16; 3] {
            self.tick += 1;
            let reference = if self.tick % 1000 < 500 { 0.03 } else { -0.03 };
            [reference / STROKE_PER_VOLT, self.x / STROKE_PER_VOLT, self.a / ACCELERATION_PER_VOLT]
                .map(|volt| (volt / VOLT_PER_CODE) as i16)
        }

        fn write(&mut self, code: i16) {
            let u = f32::from(code) * VOLT_PER_CODE * STROKE_PER_VOLT;
            let flow = if self.oil { (2.4 * u).clamp(-0.242, 0.242) } else { 0.0 };
            self.a = (flow - self.v) * 50.0;
            self.v += self.a * 0.002;
            self.x += self.v * 0.002;
            self.farthest = self.farthest.max(self.x.abs());
        }

        fn relay(&mut self, closed: bool) {
            self.oil = closed;
        }

        fn key(&self) -> bool {
            (self.turned..10_000).contains(&self.tick)
        }
    }

    /// At rest, with the key off until tick `turned`.
    fn bench(turned: u32) -> Bench {
        Bench { tick: 0, x: 0.0, v: 0.0, a: 0.0, oil: false, farthest: 0.0, turned }
    }

    /// A power failure during a test must not end in a table that starts when the power is back.
    #[test]
    fn a_key_that_is_on_when_the_power_comes_arms_nothing() {
        let mut table = Table::new(bench(0)).unwrap();
        for _ in 0..9000 {
            table.tick();
            assert!(!table.board().oil);
        }
    }

    #[test]
    fn the_table_follows_and_comes_to_rest() {
        let mut table = Table::new(bench(10)).unwrap();
        for _ in 0..15_000 {
            table.tick();
        }
        let bench = table.board();
        assert!(bench.farthest > 0.025 && bench.farthest < 0.12, "{}", bench.farthest);
        assert!(!bench.oil && bench.v.abs() < 1e-3);
    }
}
