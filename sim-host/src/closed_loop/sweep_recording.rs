//! A sweep of the simulated table as a laboratory would record it: sines held one after the other at one amplitude, the
//! LVDT's steps, the accelerometer's noise and hum in the samples; written as files with an experiment beside them.

use super::{Clock, ClosedLoopError, PlainPi, run};
use crate::plant::paper::{FixedStep, Paper};
use crate::plant::sensors::{SensorModel, Sensors};
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Held sines at one amplitude.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Amplitude of the reference, m.
    pub amplitude: f64,
    /// Frequencies in the order they are held, Hz.
    pub frequencies: Vec<f64>,
    /// Least time each is held, s; whole cycles are held, three at the least.
    pub hold: f64,
    /// Displacement gains, 1 and 1/s.
    pub gains: (f64, f64),
    /// Control and recording rate, Hz.
    pub rate: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// What was recorded, one value a tick.
#[derive(Debug, Clone, Default)]
pub struct Recorded {
    /// Time between values, s.
    pub dt: f64,
    /// Reference, m.
    pub reference: Vec<f64>,
    /// What the LVDT read, m.
    pub displacement: Vec<f64>,
    /// What the accelerometer read, the mean over a sample, m/s2.
    pub acceleration: Vec<f64>,
    /// Valve command, m.
    pub command: Vec<f64>,
}

impl Sweep {
    /// The paper's frequencies, 0.1 to 6 Hz, in nine sines at the gains in use.
    pub fn paper(amplitude: f64, seed: u64) -> Self {
        let frequencies = vec![0.2, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0];
        Self { amplitude, frequencies, hold: 3.0, gains: (3.70205, 0.61701), rate: 500.0, seed }
    }

    /// The reference: rest for a second, the sines, rest for a second.
    pub fn reference(&self) -> Vec<f64> {
        let rest = vec![0.0; self.rate as usize];
        let sines = self.frequencies.iter().flat_map(|&frequency| {
            let cycles = (self.hold * frequency).ceil().max(3.0);
            let n = (cycles / frequency * self.rate).round() as usize;
            (0..n).map(move |k| self.amplitude * (TAU * cycles * k as f64 / n as f64).sin())
        });
        rest.iter().copied().chain(sines).chain(rest.iter().copied()).collect()
    }

    /// Runs it on the paper's plant with the paper's laboratory noise.
    pub fn record(&self, paper: Paper) -> Result<Recorded, ClosedLoopError> {
        let clock = Clock::new(self.rate, 2)?;
        let mut plant = FixedStep::new(paper, clock.plant_step(), 0.0)?;
        let mut law = PlainPi::new(self.gains.0, self.gains.1, self.rate);
        let mut sensors = Sensors::new(SensorModel::laboratory(self.seed));
        let trace = run(&mut plant, &mut law, &mut sensors, &self.reference(), clock);
        // The trace's own measured acceleration is the mean over the tick before; recordings hold the mean around it.
        let mut accelerometer = Sensors::new(SensorModel::laboratory(self.seed + 1_000_000));
        let noisy = |(k, a): (usize, &f64)| accelerometer.acceleration(k as f64 * trace.dt, *a);
        Ok(Recorded {
            dt: trace.dt,
            acceleration: trace.acceleration.iter().enumerate().map(noisy).collect(),
            reference: trace.reference,
            displacement: trace.measured_displacement,
            command: trace.command,
        })
    }
}

impl Recorded {
    /// As a file of columns.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time [s],reference [m],displacement [m],acceleration [m/s2],command\n");
        for k in 0..self.reference.len() {
            let (time, x, a, u) = (k as f64 * self.dt, self.displacement[k], self.acceleration[k], self.command[k]);
            let _ = writeln!(text, "{time:.6},{:.7},{x:.7},{a:.5},{u:.8}", self.reference[k]);
        }
        text
    }
}

/// Amplitudes of the runs to fit and of the hold-out run, m.
const AMPLITUDES: [(f64, &str); 4] = [(0.005, "fit"), (0.02, "fit"), (0.075, "fit"), (0.04, "holdout")];

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The loop could not be set up.
    #[error(transparent)]
    Loop(#[from] ClosedLoopError),
    /// A file could not be written.
    #[error("{path}: cannot write: {cause}")]
    File {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        cause: std::io::Error,
    },
}

/// Writes sweeps at four amplitudes and the experiment that identifies the table from them; gives the experiment's path.
/// Its starting values are off on purpose.
pub fn write(folder: &Path, paper: Paper, seed: u64) -> Result<PathBuf, WriteError> {
    let file = |name: &str, text: &str| {
        let path = folder.join(name);
        let written = crate::files::write_whole(&path, text.as_bytes());
        written.map(|()| path.clone()).map_err(|cause| WriteError::File { path, cause })
    };
    std::fs::create_dir_all(folder).map_err(|cause| WriteError::File { path: folder.to_path_buf(), cause })?;
    let mut text = String::from(
        "name = \"sweeps of the simulated table\"\n\n[model]\nkind = \"servo\"\n\
         # Starting values, off on purpose; `identify` finds the table's.\n\
         b1 = 0.5\nb0 = 100.0\na1 = 40.0\nvelocity_limit = 0.3\nfit = [\"b1\", \"b0\", \"a1\", \"velocity_limit\"]\n\n\
         [channels]\ntime = { column = \"time\", unit = \"s\" }\nreference = { column = \"reference\", unit = \"m\" }\n\
         displacement = { column = \"displacement\", unit = \"m\", noise = 2e-5 }\n\
         acceleration = { column = \"acceleration\", unit = \"m/s2\", noise = 0.21 }\n\
         command = { column = \"command\", unit = \"1\" }\n",
    );
    for (i, (amplitude, purpose)) in AMPLITUDES.into_iter().enumerate() {
        let sweep = Sweep::paper(amplitude, seed + i as u64);
        let name = format!("sweep_{:03.0}mm.csv", amplitude * 1e3);
        file(&name, &sweep.record(paper)?.to_csv())?;
        let (kp, ki) = sweep.gains;
        let _ = write!(
            text,
            "\n[[runs]]\nfile = \"{name}\"\ncontroller = {{ kp = {kp}, ki = {ki} }}\nuse = \"{purpose}\"\n"
        );
    }
    file("experiment.toml", &text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_whole_and_meet_without_a_jump() {
        let sweep = Sweep::paper(0.01, 1);
        let reference = sweep.reference();
        let fastest = TAU * 6.0 * 0.01 / sweep.rate;
        assert!(reference.windows(2).all(|w| (w[1] - w[0]).abs() <= 1.001 * fastest));
        assert!((reference.iter().fold(0.0f64, |m, x| m.max(x.abs())) - 0.01).abs() < 1e-5);
    }

    #[test]
    fn noise_is_the_laboratorys_and_differs_by_seed() {
        let record = |seed| Sweep::paper(0.005, seed).record(Paper::default()).unwrap();
        let (one, two) = (record(1), record(2));
        assert!(one.displacement.iter().all(|x| (x / 4e-5 - (x / 4e-5).round()).abs() < 1e-6));
        let rest = &one.acceleration[..400];
        let rms = (rest.iter().map(|a| a * a).sum::<f64>() / 400.0).sqrt();
        assert!((0.15..0.3).contains(&rms), "{rms}");
        assert!(one.acceleration != two.acceleration);
    }
}
