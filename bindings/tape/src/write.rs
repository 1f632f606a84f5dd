//! Writes the tape, and plays it on this host.

use shakedown_core::host::{self, Answer, Damaged, Digest, Player};
use shakedown_core::{Controller, OperatorRequest, Sample, Settings};

use crate::passages::{Mishap, Passage, passages};
use crate::table::{Noise, Table};

/// Length of a passage, ticks.
const PASSAGE: u32 = 2500;
/// Samples on the tape: a minute at 1 kHz.
pub const TICKS: u32 = 60_000;

/// What the operator asks for in each passage, and when: what applies and what does not.
const ACTS: &[(u32, OperatorRequest)] = &[
    (2, OperatorRequest::Start),
    (3, OperatorRequest::Reset),
    (70, OperatorRequest::Reset),
    (80, OperatorRequest::Off),
    (200, OperatorRequest::Arm),
    (201, OperatorRequest::Arm),
    (210, OperatorRequest::Start),
    (700, OperatorRequest::Hold),
    (720, OperatorRequest::Start),
    (750, OperatorRequest::Reset),
    (760, OperatorRequest::Arm),
    (770, OperatorRequest::Start),
    (900, OperatorRequest::Resume),
    (1500, OperatorRequest::Stop),
    (1520, OperatorRequest::Resume),
    (1750, OperatorRequest::Arm),
    (1755, OperatorRequest::Start),
    (1960, OperatorRequest::Reset),
    (2110, OperatorRequest::Off),
    (2320, OperatorRequest::Reset),
    (2330, OperatorRequest::Arm),
    (2340, OperatorRequest::Start),
    // Off, for what the next passage's settings exchange.
    (2400, OperatorRequest::Trip),
    (2470, OperatorRequest::Reset),
];

/// Adds a record.
fn record(tape: &mut Vec<u8>, tag: u32, content: &[u8]) {
    tape.extend(tag.to_le_bytes());
    tape.extend((content.len() as u32).to_le_bytes());
    tape.extend(content);
}

/// The numbers of a record's sample, in the order of [`Sample`], and its flags.
fn content(sample: &Sample) -> [u8; 40] {
    let numbers = [
        sample.reference,
        sample.displacement,
        sample.acceleration,
        sample.external,
        sample.velocity,
        sample.pressure_difference,
        sample.reference_velocity,
        sample.reference_acceleration,
        sample.second_displacement,
    ];
    let flags = u32::from(sample.limit_switch) | u32::from(sample.relay_closed) << 1;
    let words = numbers.map(f32::to_bits).into_iter().chain([flags]);
    let mut bytes = [0; 40];
    for (four, word) in bytes.chunks_exact_mut(4).zip(words) {
        four.copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

/// What passes while the tape is written.
struct Writer {
    tape: Vec<u8>,
    controller: Controller,
    settings: Settings,
    table: Table,
    noise: Noise,
    before: f32,
    stood: Sample,
}

/// The whole tape.
pub fn write() -> Vec<u8> {
    let mut writer = Writer {
        tape: Vec::new(),
        controller: Controller::inert(),
        settings: Settings::default(),
        table: Table::new(),
        noise: Noise::new(107),
        before: 0.0,
        stood: Sample::default(),
    };
    let passages = passages();
    for (place, passage) in passages.iter().enumerate() {
        let next = passages.get(place + 1).or(passages.first());
        for k in 0..PASSAGE {
            writer.orders(k, passage, next);
            writer.tick(k, place as u32 * PASSAGE + k, passage.mishap);
        }
    }
    writer.tape
}

impl Writer {
    /// Settings and requests ahead of tick `k` of a passage.
    fn orders(&mut self, k: u32, passage: &Passage, next: Option<&Passage>) {
        match k {
            0 => self.settle(if passage.anew { 1 } else { 2 }, &passage.settings),
            1000 => self.settle(2, next.map_or("", |next| &next.settings)),
            1300 => self.settle(2, &passage.settings),
            1400 => self.settle(2, passage.refused),
            _ => {}
        }
        for (_, request) in ACTS.iter().filter(|(at, _)| *at == k) {
            self.ask(*request);
        }
        if k == 1900 && passage.mishap == Mishap::Operator {
            self.ask(OperatorRequest::Trip);
        }
    }

    fn settle(&mut self, tag: u32, text: &str) {
        record(&mut self.tape, tag, text.as_bytes());
        if tag == 1 {
            self.controller = Controller::inert();
            self.table = Table::new();
        }
        if let Ok(settings) = host::settings(text)
            && self.controller.retune(&settings).is_ok()
        {
            self.settings = settings;
        }
    }

    fn ask(&mut self, request: OperatorRequest) {
        let number = host::REQUESTS.iter().position(|known| *known == request).unwrap_or_default() as u32;
        record(&mut self.tape, 3, &number.to_le_bytes());
        host::request(&mut self.controller, number);
    }

    fn tick(&mut self, k: u32, tick: u32, mishap: Mishap) {
        let t = tick as f32;
        let reference = 0.04 * libm::sinf(t * 0.0075) + 0.01 * libm::sinf(t * 0.041);
        let mut sample = self.table.sample(reference, self.before);
        self.before = reference;
        spoil(k, &mut sample);
        self.mishap(k, mishap, &mut sample);
        record(&mut self.tape, 4, &content(&sample));
        let command = self.controller.step(&sample);
        self.table.advance(&self.settings, command.valve, command.status.relay);
    }

    /// What the passage's mishap does, from 1.9 s on.
    fn mishap(&mut self, k: u32, mishap: Mishap, sample: &mut Sample) {
        if k < 1900 {
            self.stood = *sample;
        }
        self.table.stuck = (mishap == Mishap::ValveStuck && (1900..2100).contains(&k)).then_some(-0.1);
        if k < 1900 {
            return;
        }
        match (mishap, k - 1900) {
            (Mishap::LvdtLost, 0..40) => sample.displacement = f32::NAN,
            (Mishap::LvdtStuck, 0..100) => sample.displacement = self.stood.displacement,
            (Mishap::AccelerationJumps, 0..30) => sample.acceleration += 40.0,
            (Mishap::AccelerationStuck, 0..400) => sample.acceleration = self.stood.acceleration,
            (Mishap::ReferenceJumps, 0..60) => sample.reference += 0.5,
            (Mishap::LimitSwitch, 0..20) => sample.limit_switch = true,
            (Mishap::SensorsDisagree, 0..100) => sample.second_displacement += 0.02,
            (Mishap::RelayAstray, 0..100) => sample.relay_closed = !sample.relay_closed,
            (Mishap::Pressure, 0..60) => sample.pressure_difference += 6e6,
            (Mishap::Noisy, 0..80) => sample.displacement += 4e-3 * self.noise.next(),
            _ => {}
        }
    }
}

/// Readings that are none, or hardly any, in every passage; gaps far enough apart not to be a loose contact, which trips.
fn spoil(k: u32, sample: &mut Sample) {
    match k {
        430..=433 => sample.displacement = f32::from_bits(0xffc1_2345),
        0 | 450..=451 => (sample.reference, sample.external) = (f32::NAN, f32::INFINITY),
        470..=478 => sample.acceleration = 1e4,
        490 => sample.external = 3.0,
        500..=503 => sample.velocity = f32::NEG_INFINITY,
        520 => sample.pressure_difference = f32::from_bits(0x7f80_0001),
        530 => sample.reference_velocity = 21.0,
        540 => sample.reference_acceleration = 1001.0,
        550..=555 => sample.second_displacement = f32::NAN,
        560 => *sample = Sample::new(-0.0, -0.0, -0.0),
        // Subnormal numbers: 1.4e-45 and up. A host that flushes them to zero answers otherwise.
        600..=639 => (sample.acceleration, sample.velocity) = (tiny(k), -tiny(k)),
        640..=659 => (sample.pressure_difference, sample.reference_velocity) = (tiny(k), tiny(k + 1)),
        1600..=1619 => (sample.reference_acceleration, sample.external) = (-tiny(k), tiny(k)),
        _ => {}
    }
}

/// A subnormal number.
fn tiny(k: u32) -> f32 {
    f32::from_bits(1 + (k.wrapping_mul(0x9E37_79B9) >> 9))
}

/// The records of a tape: tag and content.
pub fn records(tape: &[u8]) -> impl Iterator<Item = (u32, &[u8])> {
    let mut rest = tape;
    core::iter::from_fn(move || {
        let (head, after) = rest.split_first_chunk::<8>()?;
        let [a, b, c, d, e, f, g, h] = *head;
        let (content, after) = after.split_at_checked(u32::from_le_bytes([e, f, g, h]) as usize)?;
        rest = after;
        Some((u32::from_le_bytes([a, b, c, d]), content))
    })
}

/// Plays a tape on this host: every answer, and their digest.
pub fn play(tape: &[u8]) -> Result<(Vec<Answer>, Digest), Damaged> {
    let (mut player, mut digest) = (Player::new(), Digest::new());
    let answers = records(tape).map(|(tag, content)| player.play(tag, content)).collect::<Result<Vec<_>, _>>()?;
    for answer in &answers {
        digest.answer(*answer);
    }
    Ok((answers, digest))
}
