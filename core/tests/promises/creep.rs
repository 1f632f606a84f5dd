//! The witness of an LVDT that creeps, at its limits and where its two bounds on the table's gain disagree. One turn at a time;
//! `s`, `h`, `m` and the rest are those of `core/src/guard/creep.rs`.

use shakedown_core::blocks::guard::{Creep, ValveMonitor, ValveMonitorState};
use shakedown_core::settings::ValveMonitorSettings;

/// Powers of two, so that every sum below is exact but for one rounding: time of a turn (s) and allowance (m).
const DT: f32 = 1.0 / 256.0;
const MISMATCH: f32 = 1.0 / 64.0;
const MEMORY: f32 = 0.5;
/// Way of an unknown null in a turn, m: 4 % of the allowance a memory.
const NULL: f32 = 0.04 * MISMATCH / MEMORY * DT;

/// What is said at the end of a table that is asked for nothing, of an LVDT that reads `readings` (m) turn by turn.
fn at_rest(readings: &[f32]) -> Creep {
    let settings = ValveMonitorSettings { mismatch: MISMATCH, memory: MEMORY };
    let monitor = ValveMonitor::new(&settings, 0.0, 64.0, DT).unwrap();
    let mut state = ValveMonitorState::default();
    for &x in readings {
        monitor.advance(&mut state, 0.0, 64.0, 0.0, x);
    }
    monitor.creep(&state)
}

/// How far the table may be from its reading on the `side` (1 below, -1 above) of a possible creep, and on the other, m.
fn of_a_side(creep: Creep, side: f32) -> (f32, f32) {
    let Creep::Possible { below, above } = creep else { panic!("{creep:?}") };
    if side > 0.0 { (below, above) } else { (above, below) }
}

/// The largest reading that a table at rest at zero with an unknown null makes `way` (m) of, to the last bit.
fn largest_reading(way: f32) -> f32 {
    let mut reading = way + NULL;
    while reading - NULL > way {
        reading = reading.next_down();
    }
    while reading.next_up() - NULL <= way {
        reading = reading.next_up();
    }
    assert_eq!(reading - NULL, way, "no reading meets the limit to the last bit");
    reading
}

/// Half of the allowance is explained, to the last bit, where no gain had a part in it, and twice of it is not yet certain.
#[test]
fn at_its_limit_a_creep_is_not_said() {
    for side in [1.0, -1.0] {
        let possible = largest_reading(0.5 * MISMATCH);
        assert_eq!(at_rest(&[0.0, side * possible]), Creep::None);
        assert!(matches!(at_rest(&[0.0, side * possible.next_up()]), Creep::Possible { .. }));
        let certain = largest_reading(2.0 * MISMATCH);
        assert!(matches!(at_rest(&[0.0, side * certain]), Creep::Possible { .. }));
        assert_eq!(at_rest(&[0.0, side * certain.next_up()]), Creep::Certain);
    }
}

/// An LVDT that goes as an unknown null does has not begun to creep: what it does later is counted from there.
#[test]
fn an_unknown_null_hides_nothing_before_a_creep() {
    let step = 0.75 * MISMATCH;
    for side in [1.0, -1.0] {
        let (at_once, other) = of_a_side(at_rest(&[0.0, 0.0, side * step]), side);
        let after = of_a_side(at_rest(&[0.0, side * NULL, side * (NULL + step)]), side);
        // What it may be is the step less one null, and the two that may have hidden some of it.
        assert!((at_once - (step + NULL)).abs() < 0.01 * NULL, "{at_once}");
        assert!((after.0 - at_once).abs() < 0.01 * NULL, "{after:?} for {at_once}");
        assert_eq!((other, after.1), (0.0, 0.0));
    }
}

/// A command to one side while nothing is known of the gain, and back while there is an estimate: each by itself could be explained
/// by a gain, but not both by the same one. Seen once no gain of the model leaves less than the allowance, and the table is nowhere
/// beyond what the least of them allows.
#[test]
fn a_creep_that_no_gain_explains_is_seen() {
    const TURN: f32 = 0.003;
    // Allowance 20 mm, null 4 mm/s; the LVDT gains 40 mm/s on command and null.
    let (speed, null, gained) = (0.2_f32, 0.004_f32, 0.04_f32);
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.02, memory: 0.2 }, 0.0, 0.242, TURN).unwrap();
    for side in [1.0, -1.0] {
        let (mut state, mut x, mut asked) = (ValveMonitorState::default(), 0.0, 0.0);
        let found = (1..=200_u16).find_map(|turn| {
            let velocity = if turn <= 100 { speed } else { -speed };
            x += TURN * (velocity + gained + null);
            asked += TURN * velocity;
            monitor.advance(&mut state, side * velocity, 0.242, side * velocity, side * x);
            match monitor.creep(&state) {
                Creep::None => None,
                creep => Some((f32::from(turn) * TURN, of_a_side(creep, side).0, asked)),
            }
        });
        let (t, way, asked) = found.unwrap();
        // s + m - 1.35 m = 20 mm, of a gain of 1.
        let least = gained * t - 0.35 * asked;
        assert!((least - 0.02).abs() < 0.001 && asked > 0.002, "{least} m, {asked} m asked for");
        let farthest = gained * t + 2.0 * null * t + asked - 0.65 * asked;
        assert!((way - farthest).abs() < 0.001, "{way} m for {farthest} m");
    }
}

/// An LVDT that creeps away and part of the way back may be wrong to either side: to the first by what is left, to the other by what
/// it came back. Neither hides the other, whichever is longer.
#[test]
fn a_creep_that_turns_back_is_judged_on_both_sides() {
    // Steps that the witness follows within a turn, m; allowance 15.6 mm, of which half is possible and twice certain.
    let (away, back) = (1.5 * MISMATCH, [0.6 * MISMATCH, 0.9 * MISMATCH]);
    for side in [1.0, -1.0] {
        for back in back {
            let (first, other) = of_a_side(at_rest(&[0.0, side * away, side * (away - back)]), side);
            assert!((first - (away - back)).abs() < 4.0 * NULL, "{first} m for {} m", away - back);
            assert!((other - back).abs() < 4.0 * NULL, "{other} m for {back} m");
        }
    }
}

/// A gain that becomes known while an LVDT creeps was learned of the creep, and bounds nothing: the table is not farther from its reading
/// than what is said, before that and after it.
#[test]
fn a_gain_that_was_learned_of_a_creep_bounds_nothing() {
    const TURN: f32 = 0.003;
    // A table that does what the model says, and an LVDT that gains 30 mm/s on it.
    let (speed, gained) = (0.06_f32, 0.03_f32);
    let monitor = ValveMonitor::new(&ValveMonitorSettings { mismatch: 0.02, memory: 0.2 }, 0.0, 0.242, TURN).unwrap();
    for side in [1.0, -1.0] {
        let (mut state, mut said) = (ValveMonitorState::default(), 0);
        for turn in 1..=2500_u16 {
            let t = f32::from(turn) * TURN;
            let reading = gained - speed;
            monitor.advance(&mut state, -side * speed, 0.242, side * reading, side * reading * t);
            let creep = monitor.creep(&state);
            if !matches!(creep, Creep::None | Creep::Certain) {
                let (way, _) = of_a_side(creep, side);
                assert!(way > gained * t, "{way} m for {} m after {t} s", gained * t);
                said += 1;
            }
        }
        // From the first second on, long past the two of motion in which a gain is learned.
        assert!(said > 1000, "said in {said} turns");
    }
}
