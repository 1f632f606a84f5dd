//! A sweep from the highest frequency to the lowest, whose amplitude at each is what the required spectrum needs, up to what the
//! limits leave.
//!
//! The velocity is a sine up to the limit, and beyond it a sine that is clipped there, whose fundamental goes on growing up to 4 / pi
//! of the limit. With the level l at a phase p the velocity is V clip(l sin p, 1) and the displacement V / w times its integral over
//! the phase, zero in the mean; the frequency changes by so little in a cycle that the motion is that to a part in a hundred.

use super::super::super::Motion;
use super::super::super::fit::Limits;
use super::super::{QualifyError, Requirement};
use super::reached;
use std::f64::consts::{FRAC_PI_2, LN_2, PI};

/// Cycles an octave that are tried: a fast sweep first.
pub(super) const CYCLES: [f64; 3] = [30.0, 80.0, 160.0];
/// Points an octave at which the level is corrected.
const POINTS: f64 = 12.0;
/// Corrections.
const ROUNDS: usize = 7;
/// Highest level: nearly a square wave.
const HIGHEST: f64 = 6.0;
/// Share of a limit that a sweep uses: the change of frequency within a cycle, and what differences of samples round.
const ROOM: f64 = 0.975;
/// Longest sweep, s; the first is tried however long it is.
pub(super) const LONGEST: f64 = 900.0;
/// How often a sweep is made where a motion is to be steady: each third of it then holds whole sweeps.
const TIMES: usize = 6;
/// Fades at either end, s.
const FADE: f64 = 2.0;

/// How long a sweep down to a frequency (Hz) takes, s.
pub(super) fn duration(lowest: f64, cycles: f64) -> f64 {
    cycles / (LN_2 * 0.93 * lowest)
}

/// Integral of clip(l sin p, 1) over the phase, zero in the mean.
fn shape(level: f64, phase: f64) -> f64 {
    let p = phase.rem_euclid(2.0 * PI);
    if level <= 1.0 {
        return -level * p.cos();
    }
    let (q, sign) = if p < PI { (p, 1.0) } else { (p - PI, -1.0) };
    let (r, turn) = if q <= FRAC_PI_2 { (q, 1.0) } else { (PI - q, -1.0) };
    let corner = (1.0 / level).asin();
    let value = if r >= corner { r - FRAC_PI_2 } else { corner - FRAC_PI_2 + level * (corner.cos() - r.cos()) };
    sign * turn * value
}

/// The sweep.
pub(super) fn sweep(asked: Requirement<'_>, margin: f64, limits: &Limits, cycles: f64) -> Result<Motion, QualifyError> {
    let Requirement { standard, required, lowest } = asked;
    let (low, high) = (0.93 * lowest, 1.07 * standard.band.1);
    let count = ((high / low).log2() * POINTS).ceil() as usize;
    let frequencies: Vec<f64> = (0..=count).map(|k| low * (high / low).powf(k as f64 / count as f64)).collect();
    let wanted: Vec<f64> =
        frequencies.iter().map(|f| margin * required.at(f.clamp(lowest, standard.band.1)).unwrap_or(0.0)).collect();
    let most: Vec<f64> = frequencies.iter().map(|f| largest(*f, limits)).collect();
    // A steady sine is magnified by 1 / (2 zeta).
    let first = |(w, f): (&f64, &f64)| 2.0 * required.damping * w / (2.0 * PI * f * limits.velocity);
    let mut levels: Vec<f64> = wanted.iter().zip(&frequencies).map(first).zip(&most).map(|(l, m)| l.min(*m)).collect();
    let rate = (8.0 * standard.band.1).max(250.0);
    let mut motion = made(&frequencies, &levels, limits.velocity, cycles, rate);
    let mut best: Option<(f64, Motion)> = None;
    for _ in 0..ROUNDS {
        let got = reached(&motion.acceleration, motion.dt, required.damping, &frequencies)?;
        let inside =
            frequencies.iter().zip(got.iter().zip(&wanted)).filter(|(f, _)| (lowest..=standard.band.1).contains(*f));
        let least = inside.map(|(_, (g, w))| g / w).fold(f64::INFINITY, f64::min);
        if best.as_ref().is_none_or(|(b, _)| least > *b) {
            best = Some((least, motion.clone()));
        }
        if least >= 1.0 {
            break;
        }
        for (level, ((w, g), m)) in levels.iter_mut().zip(wanted.iter().zip(&got).zip(&most)) {
            *level = (*level * (w / g).clamp(0.7, 1.6)).min(*m);
        }
        motion = made(&frequencies, &levels, limits.velocity, cycles, rate);
    }
    let motion = best.map_or(motion, |(_, motion)| motion);
    let used = super::used(&motion, limits);
    Ok(if used > 1.0 && used < 1.05 { motion.scaled(0.999 / used) } else { motion })
}

/// The same sweep again and again; it begins and ends at rest.
pub(super) fn repeated(motion: &Motion) -> Motion {
    Motion {
        dt: motion.dt,
        displacement: motion.displacement.repeat(TIMES),
        velocity: motion.velocity.repeat(TIMES),
        acceleration: motion.acceleration.repeat(TIMES),
    }
}

/// The largest level within the limits at a frequency, Hz.
fn largest(frequency: f64, limits: &Limits) -> f64 {
    let w = 2.0 * PI * frequency;
    let inside = |level: f64| {
        let mut worst = 0.0_f64;
        for k in 0..=64 {
            let p = FRAC_PI_2 * f64::from(k) / 64.0;
            let v = (level * p.sin()).min(1.0);
            let a = if level * p.sin() < 1.0 { level * p.cos() * w * limits.velocity } else { 0.0 };
            let x = shape(level, p).abs() * limits.velocity / w;
            worst = worst.max(v);
            worst = worst.max(limits.stroke.map_or(0.0, |most| x / most));
            worst = worst.max(limits.acceleration.map_or(0.0, |most| a / most));
            worst = worst.max(limits.stall.map_or(0.0, |stall| v * v + a / stall));
        }
        worst <= ROOM
    };
    // Beyond the limit a clipped sine still has its velocity within it, but for the room that is kept.
    let clipped = |level: f64| {
        let scaled = Limits { velocity: limits.velocity * ROOM, ..*limits };
        level > 1.0 && within_clipped(level, w, &scaled)
    };
    let fits = |level: f64| if level <= 1.0 { inside(level) } else { clipped(level) };
    let (mut low, mut high) = (0.0, HIGHEST);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if fits(middle) { low = middle } else { high = middle }
    }
    low
}

fn within_clipped(level: f64, w: f64, limits: &Limits) -> bool {
    let corner = (1.0 / level).asin();
    (0..=64).all(|k| {
        let p = corner * f64::from(k) / 64.0;
        let (v, a) = (level * p.sin(), level * p.cos() * w * limits.velocity);
        let x = shape(level, p).abs() * limits.velocity / w;
        limits.stroke.is_none_or(|most| x <= ROOM * most)
            && limits.acceleration.is_none_or(|most| a <= ROOM * most)
            && limits.stall.is_none_or(|stall| (v * ROOM).powi(2) + a / stall <= ROOM)
    })
}

/// The motion: levels at frequencies, interpolated in the logarithm of the frequency.
fn made(frequencies: &[f64], levels: &[f64], velocity: f64, cycles: f64, rate: f64) -> Motion {
    let (low, high) = (frequencies[0], frequencies[frequencies.len() - 1]);
    // df/dt = -f^2 ln 2 / cycles: as many cycles in every octave.
    let chirp = LN_2 / cycles;
    let duration = (1.0 / low - 1.0 / high) / chirp;
    let dt = 1.0 / rate;
    let rest = 1.0;
    let total = duration + 2.0 * rest;
    let count = (total / dt).ceil() as usize;
    let spacing = (high / low).ln() / (frequencies.len() - 1) as f64;
    let displacement: Vec<f64> = (0..=count)
        .map(|k| {
            let t = k as f64 * dt - rest;
            if !(0.0..=duration).contains(&t) {
                return 0.0;
            }
            let f = 1.0 / (1.0 / high + chirp * t);
            // The integral of the frequency.
            let phase = 2.0 * PI * (1.0 + high * chirp * t).ln() / chirp;
            let place = ((f / low).ln() / spacing).clamp(0.0, (frequencies.len() - 1) as f64);
            let i = (place as usize).min(frequencies.len() - 2);
            let level = levels[i] + (levels[i + 1] - levels[i]) * (place - i as f64);
            let fade = (t / FADE.min(0.2 * duration)).min((duration - t) / (1.5 / low)).clamp(0.0, 1.0);
            let smooth = fade * fade * (3.0 - 2.0 * fade);
            // A clipped velocity that fades is one that is clipped less.
            let level = level * smooth;
            0.985 * velocity / (2.0 * PI * f) * shape(level, phase)
        })
        .collect();
    let acceleration: Vec<f64> = (0..=count)
        .map(|k| {
            let at = |i: usize| displacement[i.min(count)];
            (at(k + 1) - 2.0 * at(k) + at(k.saturating_sub(1))) / (dt * dt)
        })
        .collect();
    Motion::from_acceleration(dt, acceleration)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shape_is_the_integral_of_the_clipped_sine_and_has_no_mean() {
        for level in [0.5, 1.0, 1.7, 5.0] {
            let mut sum = 0.0;
            for k in 0..2000 {
                let p = 2.0 * PI * (f64::from(k) + 0.5) / 2000.0;
                let slope = (shape(level, p + 1e-5) - shape(level, p - 1e-5)) / 2e-5;
                assert!((slope - (level * p.sin()).clamp(-1.0, 1.0)).abs() < 1e-3, "{level} {p}: {slope}");
                sum += shape(level, p);
            }
            assert!(sum.abs() < 1e-6, "{level}: {sum}");
        }
    }
}
