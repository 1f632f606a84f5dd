//! One run: channels in SI on an even grid, the controller that ran, and what the run is used for.

use super::channel::{Channel, PerChannel};
use super::clock::Clock;
use super::law::{RecordedLaw, Shaping, commands_of_pi};
use super::signal::filled;
use std::path::PathBuf;

/// Time over which what was sent before a run may still act in it, s.
const BEFORE: f64 = 1.0;

/// What a run is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Use {
    /// Parameters may be fitted to it.
    Fit,
    /// It only judges.
    HoldOut,
}

/// One recording, or a part of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The file as the experiment names it; where several runs share a file, with the part in seconds.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Sampling step, s.
    pub dt: f64,
    /// Time of each sample by the file's clock, evenly `dt` apart, s.
    pub time: Vec<f64>,
    /// The other channels in SI, each as long as `time`; NaN where a sample is missing.
    pub channels: PerChannel<Vec<f64>>,
    /// Stated standard deviation of each channel's noise, SI, quantisation included.
    pub noise: PerChannel<f64>,
    /// Stated standard deviation of the displacement noise that the controller saw, m; that of the channel where it is none.
    pub loop_noise: Option<f64>,
    /// The controller that ran.
    pub law: RecordedLaw,
    /// What surrounds it.
    pub shaping: Shaping,
    /// Rate of that controller, Hz; the recording's where the experiment does not say.
    pub controller_rate_hz: Option<f64>,
    /// What the run is used for.
    pub purpose: Use,
    /// True where the run is a part of its file that does not begin with the file: it need not start at rest.
    pub cut: bool,
    /// Integral of reference less displacement from the start of the file to where this run begins, m s: what a controller's
    /// integral holds there. Zero for a run that begins with its file.
    pub error_before: f64,
    /// Commands sent before this run begins, one second of them at most, in the command's unit: what is on its way then. As they
    /// were recorded, else as a PI law makes them of what it saw; empty where neither is known.
    pub sent_before: Vec<f64>,
    /// Time from the start of the file to where this run begins, s: how long the table was at work before.
    pub elapsed: f64,
    /// What the time stamps were like.
    pub clock: Clock,
}

impl Run {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// True where there is no sample; a loaded run always has some.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// True where the reference and the stated controller drive a simulation: the recorded displacement and command are then compared
    /// and nothing else.
    pub(crate) fn simulates_its_loop(&self) -> bool {
        self.law != RecordedLaw::Open && self.channel(Channel::Reference).is_some()
    }

    /// A channel's samples in SI.
    pub fn channel(&self, channel: Channel) -> Option<&[f64]> {
        self.channels.get(channel).map(Vec::as_slice)
    }

    /// Length of the run, s.
    pub fn duration(&self) -> f64 {
        self.dt * self.len() as f64
    }

    /// The run from sample `from` up to, not including, `to`.
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        let (to, from) = (to.min(self.len()), from.min(to).min(self.len()));
        let mut channels = PerChannel::default();
        for (channel, samples) in self.channels.iter() {
            channels.set(channel, samples[from..to].to_vec());
        }
        let mut clock = self.clock.clone();
        clock.offsets = clock.offsets.get(from..to).unwrap_or_default().to_vec();
        let error_before = self.error_before + self.error_until(from);
        let sent_before = self.sent_until(from);
        let time = self.time[from..to].to_vec();
        let elapsed = self.elapsed + from as f64 * self.dt;
        Self { time, channels, cut: self.cut || from > 0, error_before, sent_before, elapsed, clock, ..self.clone() }
    }

    /// The commands sent before this sample, as far back as they matter.
    fn sent_until(&self, sample: usize) -> Vec<f64> {
        let recorded = self.channel(Channel::Command).map(|command| filled(&command[..sample]));
        let Some(sent) = recorded.or_else(|| self.law_until(sample)) else { return Vec::new() };
        lately(self.sent_before.iter().copied().chain(sent).collect(), self.dt)
    }

    /// What a PI law alone makes of reference and displacement before this sample. Of a cascade, which differentiates what it sees, noise
    /// makes most of the command.
    fn law_until(&self, sample: usize) -> Option<Vec<f64>> {
        let RecordedLaw::ProportionalIntegral { kp, ki } = self.law else { return None };
        let Shaping { kvf, notch: None, late_command: 0, late_displacement: 0, .. } = self.shaping else { return None };
        let of = |channel| self.channel(channel).map(|samples| filled(&samples[..sample]));
        let (reference, displacement) = (of(Channel::Reference)?, of(Channel::Displacement)?);
        let until = (self.error_before, 2.0 * reference.first()? - reference.get(1)?);
        Some(commands_of_pi([kp, ki, kvf], [&reference, &displacement], until, self.dt))
    }

    /// The run by a clock whose period is `factor` times what the stamps say; the stamps stay as they are.
    pub(crate) fn by_clock(&mut self, factor: f64) {
        self.dt *= factor;
        self.error_before *= factor;
        self.controller_rate_hz = self.controller_rate_hz.map(|rate| rate / factor);
    }

    /// Integral of reference less displacement over the samples before this one, m s; zero where either is not recorded.
    fn error_until(&self, sample: usize) -> f64 {
        let of = |channel| self.channel(channel).map(filled);
        let (Some(reference), Some(displacement)) = (of(Channel::Reference), of(Channel::Displacement)) else {
            return 0.0;
        };
        reference.iter().zip(&displacement).take(sample).map(|(r, x)| (r - x) * self.dt).sum()
    }
}

/// Of commands sent before a run those that may still act in it; none where they are not known.
pub(super) fn lately(mut sent: Vec<f64>, dt: f64) -> Vec<f64> {
    let late = sent.split_off(sent.len().saturating_sub((BEFORE / dt) as usize));
    if late.iter().all(|command| command.is_finite()) { late } else { Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::doubt::tests::experiment;

    /// What was on its way when a part begins is known from the command, and where nobody recorded that from the law.
    #[test]
    fn a_part_knows_what_was_sent_before_it() {
        let law = RecordedLaw::ProportionalIntegral { kp: 4.0, ki: 1.0 };
        let shaping = Shaping { kvf: 0.3, ..Shaping::default() };
        let run = Run { shaping, ..experiment(&law, shaping, 3).runs[0].clone() };
        let recorded = run.part(3000, 6000).part(100, 2000).sent_before;
        assert_eq!(recorded.len(), (BEFORE / run.dt) as usize);
        assert_eq!(recorded.last(), Some(&run.channel(Channel::Command).unwrap()[3099]));
        let mut without = run;
        without.channels.remove(Channel::Command);
        let told = without.part(3000, 6000).part(100, 2000).sent_before;
        let most = recorded.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let apart = recorded.iter().zip(&told).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // The reference before a part is extrapolated.
        assert!(apart < 0.02 * most && told.len() == recorded.len(), "{apart} of {most}");
    }
}
