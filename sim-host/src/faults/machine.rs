//! The table of a run: Eq. 7 with its limiter, the oil column where there is one, the hydraulic block, and what breaks.
//!
//! ```text
//! z' = -a1 z + (b0 - b1 a1) u,   w = clamp(z + b1 u, +/- limit) sqrt(supply)          flow over piston area, m/s
//! stiff:  v = w                   oil:  v' = omega^2 (q - x) + 2 zeta omega (w - v) + push,   q' = w
//! ```
//! The relay's opening shuts the block [`BLOCK`] later or sooner: no oil flows, and the oil column holds the table where it is. A
//! second valve that never fails gets the same commands: what the table should have done.

use super::spoil::{BITS, Converter};
use serde::Serialize;

/// From the relay's opening to no oil at the valve at most, s, as it is declared.
pub const BLOCK: f64 = 0.03;
/// The output's converter, in m of command: wide open three times over.
pub const OUTPUT: Converter = Converter { bits: BITS[1], span: 0.3 };
/// Integration steps a second, at least one a tick.
const STEPS: f64 = 5000.0;

/// An oil column: frequency, rad/s, and damping ratio, 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Oil {
    /// Frequency with the payload on the table, rad/s.
    pub omega: f64,
    /// Damping ratio, 1.
    pub damping: f64,
}

/// What a table is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Table {
    /// Direct feed of Eq. 7, 1/s.
    pub b1: f64,
    /// Gain of Eq. 7, 1/s2.
    pub b0: f64,
    /// Pole of Eq. 7, 1/s.
    pub a1: f64,
    /// Largest speed, m/s.
    #[serde(rename = "velocity_limit")]
    pub limit: f64,
    /// Command at which no oil flows, m.
    #[serde(rename = "null_bias")]
    pub null: f64,
    /// Its oil column; none is stiff.
    pub oil: Option<Oil>,
}

/// What may break about a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlantFault {
    /// The valve goes on with this command, m.
    Stuck(f64),
    /// The valve stays where it is.
    Frozen,
    /// This bit of the output's converter stands, at 1 or at 0.
    Bit(u32, bool),
    /// The supply falls with this time constant, s.
    Supply(f64),
    /// The payload comes off: this share of the moving mass, knocking with this acceleration (m/s2) at each of so many
    /// blows of so long (s).
    Payload {
        /// Its mass over the table's, 1.
        mass: f64,
        /// Acceleration of the table at a blow, m/s2.
        blow: f64,
        /// Length of a blow, s.
        length: f64,
        /// Blows.
        count: u32,
    },
}

/// A table at work.
#[derive(Debug, Clone)]
pub struct Machine {
    table: Table,
    lag: f64,
    healthy_lag: f64,
    /// Displacement, m.
    pub x: f64,
    /// Velocity, m/s.
    pub v: f64,
    flowed: f64,
    supply: f64,
    /// Length of a step, s, and what of the lag's state is left after it.
    decay: (f64, f64),
    broken: Option<PlantFault>,
    /// From the relay's opening to no oil, s.
    pub block: f64,
    /// Whether the relay's contact stays closed.
    pub welded: bool,
    stuck: Option<f64>,
    command: f64,
    /// Time since the break, s.
    since: f64,
    open_for: f64,
    /// Way that the command does not explain since the break, m.
    pub unexplained: f64,
}

impl Machine {
    /// `table` at rest at `x` (m).
    pub fn new(table: Table, x: f64) -> Self {
        Self {
            table,
            lag: 0.0,
            healthy_lag: 0.0,
            x,
            v: 0.0,
            flowed: x,
            supply: 1.0,
            decay: (0.0, 1.0),
            broken: None,
            block: BLOCK,
            welded: false,
            stuck: None,
            command: 0.0,
            since: 0.0,
            open_for: 0.0,
            unexplained: 0.0,
        }
    }

    /// Something breaks.
    pub fn fail(&mut self, how: PlantFault) {
        self.broken = Some(how);
        self.healthy_lag = self.lag;
        self.stuck = match how {
            PlantFault::Stuck(at) => Some(at),
            PlantFault::Frozen => Some(self.command),
            _ => None,
        };
    }

    /// Moves on by `dt` (s) under `command` (m), with the relay open or closed.
    pub fn advance(&mut self, command: f64, relay_open: bool, dt: f64) {
        let steps = (STEPS * dt).round().max(1.0);
        let h = dt / steps;
        if h != self.decay.0 {
            self.decay = (h, (-self.table.a1 * h).exp());
        }
        let decay = self.decay.1;
        self.command = command - self.table.null;
        for _ in 0..steps as usize {
            self.open_for = if relay_open && !self.welded { self.open_for + h } else { 0.0 };
            self.since += if self.broken.is_some() { h } else { 0.0 };
            self.step(h, decay);
        }
    }

    fn step(&mut self, h: f64, decay: f64) {
        let t = self.table;
        let mut u = self.stuck.unwrap_or(self.command);
        if let Some(PlantFault::Bit(bit, set)) = self.broken {
            u = OUTPUT.pass_with(u + t.null, bit, set) - t.null;
        }
        let through = |lag: &mut f64, u: f64| {
            *lag = decay * *lag + (1.0 - decay) / t.a1 * (t.b0 - t.b1 * t.a1) * u;
            (*lag + t.b1 * u).clamp(-t.limit, t.limit)
        };
        let shut = self.open_for >= self.block;
        if let Some(PlantFault::Supply(time)) = self.broken {
            self.supply *= (-h / time).exp();
        }
        let flow = if shut { 0.0 } else { through(&mut self.lag, u) * self.supply.sqrt() };
        if self.broken.is_some() {
            let healthy = if shut { 0.0 } else { through(&mut self.healthy_lag, self.command) };
            self.unexplained += h * (flow - healthy);
        }
        let Some(oil) = t.oil else {
            self.v = flow;
            self.x += h * flow;
            return;
        };
        let (share, push) = self.payload();
        let square = oil.omega * oil.omega * share;
        self.flowed += h * flow;
        let damping = 2.0 * oil.damping * oil.omega * share;
        self.v += h * (square * (self.flowed - self.x) + damping * (flow - self.v) + push);
        self.x += h * self.v;
    }

    /// Whether a payload that came off has a blow left.
    pub fn knocked(&self) -> bool {
        matches!(self.broken, Some(PlantFault::Payload { length, count, .. })
            if self.since < length * (3.0 * f64::from(count) - 2.0))
    }

    /// Moving mass before over after the payload came off, and what it does to the table on its way, m/s2.
    fn payload(&self) -> (f64, f64) {
        let Some(PlantFault::Payload { mass, blow, length, count }) = self.broken else { return (1.0, 0.0) };
        // A blow every three lengths, from alternate sides.
        let beat = self.since / (3.0 * length);
        let (number, within) = (beat.floor(), beat.fract());
        let on = within < 1.0 / 3.0 && number < f64::from(count);
        let side = if (number as u64).is_multiple_of(2) { 1.0 } else { -1.0 };
        (1.0 + mass, if on { side * blow * (3.0 * std::f64::consts::PI * within).sin() } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper(oil: Option<Oil>) -> Table {
        Table { b1: 0.69, b0: 138.0, a1: 57.65, limit: 0.242, null: 0.0, oil }
    }

    fn run(machine: &mut Machine, command: f64, relay_open: bool, ticks: usize) {
        (0..ticks).for_each(|_| machine.advance(command, relay_open, 1e-3));
    }

    #[test]
    fn a_small_command_settles_at_its_speed_and_a_large_one_at_the_limit() {
        for oil in [None, Some(Oil { omega: 150.0, damping: 0.2 })] {
            let mut machine = Machine::new(paper(oil), 0.0);
            run(&mut machine, 0.05, false, 1000);
            assert!((machine.v - 0.05 * 138.0 / 57.65).abs() < 1e-4, "{}", machine.v);
            run(&mut machine, 5.0, false, 500);
            assert!((machine.v - 0.242).abs() < 1e-4, "{}", machine.v);
        }
    }

    #[test]
    fn an_open_relay_stops_a_stuck_valve_after_the_blocks_latency() {
        let mut machine = Machine::new(paper(None), 0.0);
        machine.fail(PlantFault::Stuck(5.0));
        run(&mut machine, 0.0, false, 100);
        let (x, unexplained) = (machine.x, machine.unexplained);
        assert!((x - 0.0242).abs() < 1e-3 && (x - unexplained).abs() < 1e-9, "{x} {unexplained}");
        run(&mut machine, 0.0, true, 200);
        assert!((machine.x - x - 0.242 * BLOCK).abs() < 1e-3);
        assert_eq!(machine.v, 0.0);
    }

    #[test]
    fn a_supply_that_is_gone_moves_nothing() {
        let mut machine = Machine::new(paper(None), 0.0);
        machine.fail(PlantFault::Supply(0.05));
        run(&mut machine, 5.0, false, 3000);
        assert!(machine.v < 1e-6);
    }

    #[test]
    fn a_payload_that_comes_off_knocks_and_leaves_a_stiffer_table() {
        let mut machine = Machine::new(paper(Some(Oil { omega: 150.0, damping: 0.2 })), 0.0);
        machine.fail(PlantFault::Payload { mass: 1.0, blow: 20.0, length: 0.01, count: 1 });
        run(&mut machine, 0.0, false, 5);
        assert!(machine.v > 0.01 && machine.knocked(), "{}", machine.v);
        run(&mut machine, 0.0, false, 6);
        assert!(!machine.knocked());
        run(&mut machine, 0.0, false, 994);
        assert!(machine.x.abs() < 1e-6 && machine.payload() == (2.0, 0.0));
    }
}
