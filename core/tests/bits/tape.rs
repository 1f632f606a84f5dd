//! What is written down of a run, and the inputs that runs are made of.

use std::fmt::Write as _;
use std::path::PathBuf;

/// How many of a run's numbers are shown in full, evenly over it.
const SHOWN: usize = 4;

/// Every number that a run gave, in order.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Tape(Vec<u32>);

impl Tape {
    /// A number, bit by bit: a negative zero is not a zero.
    pub(crate) fn note(&mut self, value: f32) {
        self.0.push(value.to_bits());
    }

    pub(crate) fn note_all<const N: usize>(&mut self, values: [f32; N]) {
        for value in values {
            self.note(value);
        }
    }

    /// A count, a set of flags, an answer.
    pub(crate) fn count(&mut self, value: impl Into<u32>) {
        self.0.push(value.into());
    }

    /// What is compared by its words.
    pub(crate) fn word(&mut self, value: &impl std::fmt::Debug) {
        self.0.extend(format!("{value:?}").bytes().map(u32::from));
    }

    /// One line: name, how many numbers, a sum over all of them (FNV-1a, 64 bits), and some of them to read.
    fn line(&self, name: &str) -> String {
        let fold = |sum: u64, word: &u32| (sum ^ u64::from(*word)).wrapping_mul(0x0100_0000_01b3);
        let sum = self.0.iter().fold(0xcbf2_9ce4_8422_2325, fold);
        let mut line = format!("{name:<34} {:>7} {sum:016x}", self.0.len());
        for place in 1..=SHOWN {
            let word = self.0[place * self.0.len() / SHOWN - 1];
            let _ = write!(line, " {word:08x}");
        }
        line
    }
}

/// Holds runs to what `tests/golden/bits-<group>.txt` says of them.
pub(crate) fn hold(group: &str, runs: &[(&str, Tape)]) {
    let lines: Vec<String> = runs.iter().map(|(name, tape)| tape.line(name)).collect();
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/bits-{group}.txt"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, lines.join("\n") + "\n").unwrap();
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    let old: Vec<&str> = written.lines().collect();
    let changed: Vec<String> = lines
        .iter()
        .enumerate()
        .filter(|(k, line)| old.get(*k) != Some(&line.as_str()))
        .map(|(k, line)| format!("was {}\nis  {line}", old.get(k).unwrap_or(&"nothing")))
        .collect();
    assert!(
        changed.is_empty() && old.len() == lines.len(),
        "{} of {} runs in {group} gave other bits than are written down:\n{}",
        changed.len(),
        lines.len(),
        changed.join("\n")
    );
}

/// A run, written on a tape of its own.
pub(crate) fn run(name: &str, write: impl FnOnce(&mut Tape)) -> (&str, Tape) {
    let mut tape = Tape::default();
    write(&mut tape);
    (name, tape)
}

/// Numbers without a pattern (xorshift, Marsaglia 2003), the same on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Noise(u32);

impl Noise {
    pub(crate) fn new(seed: u32) -> Self {
        let mut noise = Self(seed.wrapping_mul(0x9E37_79B9) | 1);
        for _ in 0..8 {
            noise.bits();
        }
        noise
    }

    pub(crate) fn bits(&mut self) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0
    }

    /// Evenly in -1 to 1.
    pub(crate) fn next(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 8_388_608.0 - 1.0
    }

    /// One of a few values, so that what is compared is often equal.
    pub(crate) fn of<T: Copy>(&mut self, values: &[T]) -> T {
        values[(self.bits() >> 8) as usize % values.len()]
    }
}

/// Noise of the given size on a slow sine of the same.
pub(crate) fn signal(seed: u32, size: f32, ticks: u32) -> impl Iterator<Item = f32> {
    let mut noise = Noise::new(seed);
    (0..ticks).map(move |k| size * (libm::sinf(k as f32 * 0.02) + noise.next()))
}

/// One bit of one number of one run, and its line is another.
#[test]
fn another_bit_would_be_seen() {
    let tape = |last: f32| {
        run("", |tape| {
            signal(1, 1.0, 100).for_each(|x| tape.note(x));
            tape.note(last);
            tape.note(1.0);
        })
        .1
    };
    let (x, y) = (tape(0.5), tape(0.5_f32.next_up()));
    assert_ne!(x.line("x"), y.line("x"));
    assert_ne!(tape(0.0).line("x"), tape(-0.0).line("x"));
}
