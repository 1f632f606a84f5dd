//! How far apart two plants are for whoever has all of the recordings: the commands that ran, noise and all, are sent to both,
//! and what their sensors show is compared in units of the sensors' own noise.
//!
//! Half the sum of squares is what the expected log likelihoods differ by. A comparison in the closed loop without noise would
//! miss what the noise that the loop feeds back tells of a plant.

use crate::lab::engine::{replay, simulate};
use crate::lab::plant::Plant;
use crate::lab::scene::Scene;
use crate::lab::setup::sensing::Channel;
use crate::lab::stated::Run;

/// The recordings of a case, as its plant would give them to perfect sensors under the commands that ran.
pub struct Recordings<'a> {
    runs: &'a [Run],
    commands: Vec<Vec<f64>>,
    displacement: Option<Channel>,
    acceleration: Option<Channel>,
    shown: Vec<f64>,
}

impl<'a> Recordings<'a> {
    /// Of `plant` in the loop of `scene`; none where the loop runs away.
    pub fn of(scene: &'a Scene, plant: &Plant) -> Option<Self> {
        let noisy = |run| simulate(plant, run, Some(&scene.sensor)).map(|traces| traces.command);
        let [displacement, acceleration, _] = scene.says.channels;
        let mut made = Self {
            runs: &scene.runs,
            commands: scene.runs.iter().map(noisy).collect::<Option<_>>()?,
            displacement: displacement.then_some(scene.sensor.displacement),
            acceleration: acceleration.then_some(scene.sensor.acceleration),
            shown: Vec::new(),
        };
        made.shown = made.shown_by(plant)?;
        Some(made)
    }

    /// The first run alone.
    pub fn first(&self) -> Recordings<'a> {
        let channels = usize::from(self.displacement.is_some()) + usize::from(self.acceleration.is_some());
        let rows = self.runs.first().map_or(0, |run| run.reference.len());
        Self {
            runs: self.runs.get(..1).unwrap_or_default(),
            commands: self.commands.iter().take(1).cloned().collect(),
            displacement: self.displacement,
            acceleration: self.acceleration,
            shown: self.shown.iter().take(channels * rows).copied().collect(),
        }
    }

    /// What is recorded less what `plant` shows under the same commands, in standard deviations; none where it runs away.
    pub fn less(&self, plant: &Plant) -> Option<Vec<f64>> {
        let made = self.shown_by(plant)?;
        let away: Vec<f64> = self.shown.iter().zip(&made).map(|(a, b)| a - b).collect();
        away.iter().all(|v| v.is_finite()).then_some(away)
    }

    /// Number of values recorded.
    pub fn values(&self) -> usize {
        self.shown.len()
    }

    /// What an offset of the displacement sensor of 1 m shows, in standard deviations; none without such a sensor.
    pub fn offset(&self) -> Option<Vec<f64>> {
        let channel = self.displacement?;
        let mut out = Vec::with_capacity(self.shown.len());
        for run in self.runs {
            whitened(&vec![1.0; run.reference.len()], &channel, &mut out);
            if self.acceleration.is_some() {
                out.extend(std::iter::repeat_n(0.0, run.reference.len()));
            }
        }
        Some(out)
    }

    fn shown_by(&self, plant: &Plant) -> Option<Vec<f64>> {
        let mut out = Vec::with_capacity(self.shown.len());
        for (run, commands) in self.runs.iter().zip(&self.commands) {
            let traces = replay(plant, run, commands)?;
            for (channel, signal) in
                [(&self.displacement, &traces.displacement), (&self.acceleration, &traces.acceleration)]
            {
                if let Some(channel) = channel {
                    whitened(signal, channel, &mut out);
                }
            }
        }
        Some(out)
    }
}

/// A signal in standard deviations of its sensor's noise, each sample less what the one before foretells of its noise. Drift,
/// hum, spikes and a noise that grows only hide more: they are left out.
fn whitened(signal: &[f64], channel: &Channel, out: &mut Vec<f64>) {
    let phi = channel.colour;
    // Counts add white noise; with a coloured noise they are left out, which makes two plants seem further apart.
    let counts = if phi > 0.0 { 0.0 } else { channel.step * channel.step / 12.0 };
    let sigma = (channel.white * channel.white + counts).sqrt();
    let fresh = sigma * (1.0 - phi * phi).sqrt();
    let mut before = None;
    for &value in signal {
        out.push(before.map_or(value / sigma, |last: f64| (value - phi * last) / fresh));
        before = Some(value);
    }
}
