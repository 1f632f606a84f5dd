//! The loop on a table that goes where it is told: v = 2.4 u, at most 0.242 m/s.
extern crate std;

use super::*;

struct Bench {
    x: f32,
    v: f32,
    a: f32,
    farthest: f32,
    closed: bool,
}

/// Runs for `ticks`, the key on from `on` to `off`, along a square wave of 30 mm.
fn bench(ticks: u32, on: u32, off: u32) -> Bench {
    let mut table = Table::new().unwrap();
    let mut b = Bench { x: 0.0, v: 0.0, a: 0.0, farthest: 0.0, closed: false };
    let code = |value: f32, unit: f32| (value / unit + f32::from(MIDDLE) + 0.5) as u16;
    for k in 0..ticks {
        let reference = if k % 2000 < 1000 { 0.03 } else { -0.03 };
        let codes = [code(reference, METRE), code(b.x, METRE), code(b.a, ACCELERATION)];
        let (valve, closed) = table.tick(codes, (on..off).contains(&k));
        b.closed = closed;
        let u = (f32::from(valve) - f32::from(MIDDLE)) * METRE;
        let flow = if closed { (2.4 * u).clamp(-0.242, 0.242) } else { 0.0 };
        b.a = (flow - b.v) * 50.0;
        b.v += b.a * 0.001;
        b.x += b.v * 0.001;
        b.farthest = b.farthest.max(b.x.abs());
    }
    b
}

#[test]
fn the_table_follows_and_comes_to_rest() {
    let end = bench(20_000, 10, 15_000);
    assert!(end.farthest > 0.025 && end.farthest < 0.06, "{}", end.farthest);
    assert!(!end.closed && end.v.abs() < 1e-3, "{}", end.v);
}

/// A power failure during a test must not end in a table that starts when the power is back.
#[test]
fn a_key_that_is_on_when_the_power_comes_arms_nothing() {
    let end = bench(10_000, 0, 10_000);
    assert!(!end.closed && end.farthest == 0.0);
}
