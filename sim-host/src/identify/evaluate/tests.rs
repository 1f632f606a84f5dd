use super::*;
use crate::identify::model::{ModelEffect as Effect, SignalScales};
use crate::plant::effects::entry;
use crate::plant::model::Kind;
use crate::plant::simulate::{Shaping, SimulatedLaw};

const DT: f64 = 0.005;

/// Every parameter of these is free: 27 with the servo's own.
const EFFECTS: [&str; 12] = [
    "null_bias",
    "valve_lag",
    "asymmetric_gain",
    "flow_softening",
    "asymmetric_limit",
    "supply_droop",
    "oil_compliance",
    "viscous_friction",
    "stribeck_friction",
    "spring",
    "end_stop",
    "payload_resonance",
];

fn model(free: impl Fn(usize) -> bool) -> Model {
    let own = [0.69, 138.0, 57.65, 0.242].map(|value| Value { positive: true, ..Value::fixed(value) });
    let bare = Model::bare(Kind::Servo, own.to_vec());
    let start =
        |id: &str| Effect::start(entry(id).unwrap(), 0, &SignalScales { displacement: 0.05, ..SignalScales::TYPICAL });
    let mut model = EFFECTS.iter().fold(bare, |model, id| model.with(start(id).unwrap()));
    let values = model.own.iter_mut().chain(model.effects.iter_mut().flat_map(|effect| &mut effect.values));
    for (place, value) in values.enumerate() {
        (value.free, value.low, value.high) = (free(place), f64::NEG_INFINITY, f64::INFINITY);
    }
    model
}

fn run() -> Run {
    let n = 700;
    let tone = |t: f64, hz: f64, size: f64| size * (std::f64::consts::TAU * hz * t).sin();
    let input: Vec<f64> = (0..n).map(|k| f64::from(k) * DT).map(|t| tone(t, 0.8, 0.05) + tone(t, 3.1, 0.005)).collect();
    let shown = |channel, share: f64, noise| {
        let mut values: Vec<f64> = input.iter().map(|x| share * x).collect();
        values[40] = f64::NAN;
        Measured { channel, values, noise, stated: Some(noise), judged: true }
    };
    let measured = vec![shown(Channel::Displacement, 0.97, 1e-4), shown(Channel::Acceleration, -20.0, 0.2)];
    Run {
        name: "a".into(),
        dt: DT,
        from: 0.0,
        elapsed: 0.0,
        ticks: 1,
        added: Vec::new(),
        law: SimulatedLaw::Pi { kp: 6.0, ki: 1.0 },
        shaping: Shaping::default(),
        loop_noise: None,
        sent_before: Vec::new(),
        moving_start: false,
        measured,
        motion: None,
        filter: None,
        input,
    }
}

/// More free parameters than one simulation carries derivatives of: every one has its own, the same as where it is among few.
#[test]
fn every_free_parameter_has_its_derivative() {
    let run = run();
    let all = model(|_| true);
    let local = Local::start(&all, &run);
    let count = all.values().chain(local.values()).filter(|v| v.free).count();
    assert!(count > wide::WIDEST, "{count}");
    let mut kept = Rows::default();
    let whole = normal(&all, &run, &local, Some(&mut kept)).unwrap();
    assert_eq!((whole.gradient.len(), kept.jacobian.len()), (count, count * kept.residuals.len()));
    // The last ones alone, by the way that carries few.
    let first = count - 12;
    let few = normal(&model(|place| place >= first), &run, &local, None).unwrap();
    let names: Vec<usize> = (first..count).collect();
    assert_eq!(few.rows, whole.rows);
    assert!((few.squares / whole.squares - 1.0).abs() < 1e-12);
    for (i, &a) in names.iter().enumerate() {
        let near = |x: f64, y: f64, size: f64| (x - y).abs() <= 1e-4 * size;
        assert!(near(few.gradient[i], whole.gradient[a], whole.gradient.amax()), "gradient {a}");
        for (j, &b) in names.iter().enumerate() {
            let (x, y) = (few.matrix[(i, j)], whole.matrix[(a, b)]);
            let size = (whole.matrix[(a, a)] * whole.matrix[(b, b)]).sqrt();
            assert!(near(x, y, size), "{a}, {b}: {x} {y}");
        }
    }
    let idle = (0..count).filter(|&i| whole.matrix[(i, i)] == 0.0).count();
    assert!(idle < count / 4, "{idle} of {count} move nothing");
    assert_eq!(whole.blocks.len(), few.blocks.len());
    let squares: f64 = whole.blocks.iter().map(|block| block.squares).sum();
    assert!((squares / whole.squares - 1.0).abs() < 1e-12);
}
