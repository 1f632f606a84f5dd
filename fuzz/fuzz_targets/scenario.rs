//! A closed-loop test in TOML: refused with a message, or played on a short motion; what is played is made of numbers. An odd
//! first byte has the others choose a scenario's numbers, so that every key is reached with numbers of any size.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::fit::{Motion, Recipe, Step};
use shakedown::simulate::Scenario;
use std::borrow::Cow;
use std::path::Path;

/// Numbers as people write them, and as nobody should.
const NUMBERS: [&str; 24] = [
    "0.0", "-0.0", "1.0", "0.1", "1e-3", "0.242", "50.0", "1e3", "1e6", "1e12", "1e-12", "1e37", "1e-37", "1e308",
    "1e-308", "-1.0", "nan", "inf", "-inf", "2.0", "5e2", "3.0", "1e20", "-1e20",
];

/// A scenario with a `#` for every number that is not its own.
const TEMPLATE: &str = "rate_hz = #
modification = { preview = { seconds = # } }
steps = 2
conditioning = [
  { do = 'scale', factor = # },
  { do = 'rest', before_s = #, after_s = # },
  { do = 'filter', filter = { band = { band-pass = [#, #] }, order = 3 }, pass = 'zero-phase' },
  { do = 'similitude', length_scale = # },
  { do = 'resample', rate_hz = #, between = 'band-limited' },
  { do = 'trim', from_s = #, to_s = # },
  { do = 'velocity-baseline', degree = 2 },
  { do = 'scale-to-peak', peak = # },
  { do = 'fit-stroke', stroke = # },
  { do = 'fit-velocity', limit = # },
]
[plant]
b1 = #
b0 = #
a1 = #
velocity_limit = #
[sensors]
displacement_step = #
acceleration_noise = #
[[sensors.displacement_lines]]
shape = 'saw-tooth'
frequency_hz = #
amplitude = #
";

/// Longest motion, samples, and most plant steps that are worth an execution.
const SAMPLES: usize = 20_000;
const STEPS: usize = 20_000;

/// The template with the numbers that the bytes choose; a line for which the byte 255 chooses is left out.
fn chosen(bytes: &[u8]) -> String {
    let mut bytes = bytes.iter().copied();
    let mut text = String::new();
    'lines: for line in TEMPLATE.split_inclusive('\n') {
        let mut written = String::new();
        for part in line.split_inclusive('#') {
            written.push_str(part.trim_end_matches('#'));
            if part.ends_with('#') {
                match bytes.next().unwrap_or(2) {
                    u8::MAX => continue 'lines,
                    choice => written.push_str(NUMBERS[usize::from(choice) % NUMBERS.len()]),
                }
            }
        }
        text.push_str(&written);
    }
    text
}

fuzz_target!(|bytes: &[u8]| {
    let text = match bytes.split_first() {
        Some((first, rest)) if first & 1 == 1 => Cow::from(chosen(rest)),
        Some((_, rest)) => match std::str::from_utf8(rest) {
            Ok(text) => Cow::from(text),
            Err(_) => return,
        },
        None => return,
    };
    let setup = Scenario::from_text(Path::new("/nowhere/fuzz.toml"), &text).and_then(|scenario| {
        let setup = scenario.setup()?;
        Ok((scenario.recipe(setup.rate(), 0.01), setup))
    });
    let (recipe, setup) = match setup {
        Ok(read) => read,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let mut motion = Motion::from_acceleration(0.01, (0..64).map(|i| f64::from(i % 9) - 4.0).collect());
    for step in recipe.steps {
        // Allowed, and slow: an hour at 1 kHz takes its seconds.
        if matches!(step, Step::Resample { rate_hz, .. } if motion.duration() * rate_hz > SAMPLES as f64) {
            return;
        }
        motion = match (Recipe { steps: vec![step] }).apply_to(motion) {
            Ok(motion) if motion.len() <= SAMPLES => motion,
            Ok(_) => return,
            Err(error) => return assert!(!error.to_string().is_empty()),
        };
    }
    if motion.duration() * setup.rate() * setup.steps as f64 > STEPS as f64 {
        return;
    }
    match setup.play(&motion) {
        Ok(trial) => {
            assert!(trial.trace.displacement.iter().chain(&trial.trace.command).all(|value| value.is_finite()))
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
