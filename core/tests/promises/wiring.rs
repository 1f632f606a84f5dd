//! Wiring: what a code stands for, what no converter can have, and a device that does not run without a guard.

use shakedown_core::link::{Scale, Setup, SetupError, Source, Wiring};
use shakedown_core::settings::{
    Finding, ForceSettings, GuardSettings, InnerLoop, PressureSettings, ReferenceRates, VelocitySource,
};
use shakedown_core::{Mode, Settings, SettingsError};

fn setup() -> Setup {
    let line = Scale { zero: 2048.0, per_code: -7.44e-5 };
    Setup {
        telemetry_every: 10,
        lease_ms: 0,
        wiring: Wiring {
            source: Source::Analog,
            reference: line,
            displacement: line,
            acceleration: line,
            external: line,
            output: line,
            full_scale: 4095,
            rails_are_faults: true,
        },
        control: Settings { guard: Some(GuardSettings::default()), ..Settings::default() },
    }
}

type Line = (&'static str, fn(&mut Wiring) -> &mut Scale);

const LINES: [Line; 5] = [
    ("reference", |w| &mut w.reference),
    ("displacement", |w| &mut w.displacement),
    ("acceleration", |w| &mut w.acceleration),
    ("external", |w| &mut w.external),
    ("output", |w| &mut w.output),
];

#[test]
fn a_code_is_as_far_from_zero_as_its_line_says() {
    let line = Scale { zero: 2048.0, per_code: -0.5 };
    assert_eq!([2048, 2050, 0].map(|code| line.to_si(code)), [0.0, -1.0, 1024.0]);
}

#[test]
fn a_line_that_no_converter_can_have_is_refused_by_name() {
    assert_eq!(setup().validate(), Ok(()));
    // What the stroke and zero flow ask of a line is another matter, below.
    for (name, line) in LINES {
        let line_holds = |setup: &Setup| !matches!(setup.validate(), Err(SetupError::Wiring { .. }));
        for (slope, holds) in [
            (1.1e-12, true),
            (-1.1e-12, true),
            (999.0, true),
            (-999.0, true),
            (1e-12, false),
            (0.0, false),
            (1e3, false),
            (-1e3, false),
            (f32::NAN, false),
            (f32::NEG_INFINITY, false),
        ] {
            let mut setup = setup();
            line(&mut setup.wiring).per_code = slope;
            let refused = matches!(setup.validate(), Err(SetupError::Wiring { field, .. }) if field == name);
            assert_eq!(line_holds(&setup), holds, "{name} {slope}");
            assert_eq!(refused, !holds, "{name} {slope}");
        }
        for zero in [f32::NAN, f32::INFINITY] {
            let mut setup = setup();
            line(&mut setup.wiring).zero = zero;
            assert!(matches!(setup.validate(), Err(SetupError::Wiring { field, .. }) if field == name));
        }
    }
    let full_scale = |full_scale| {
        let mut setup = setup();
        setup.wiring.full_scale = full_scale;
        setup.validate()
    };
    assert!(matches!(full_scale(255), Err(SetupError::Reach { field: "displacement", .. })));
    assert_eq!(full_scale(254), Err(SetupError::Wiring { field: "full_scale", value: 254.0 }));
}

#[test]
fn a_device_needs_settings_that_hold_and_a_guard() {
    let mut bare = setup();
    bare.control.guard = None;
    assert_eq!(bare.validate(), Err(SetupError::NoGuard));
    let mut wrong = setup();
    wrong.control.stroke = -1.0;
    let Err(SetupError::Control(SettingsError::OutOfRange { field, .. })) = wrong.validate() else {
        panic!("a stroke of -1 m was accepted");
    };
    assert_eq!(field, "stroke");
}

fn refusal(change: impl Fn(&mut Setup)) -> (&'static str, String) {
    let mut changed = setup();
    change(&mut changed);
    let error = changed.validate().unwrap_err();
    let field = match error {
        SetupError::Reach { field, .. } | SetupError::Control(SettingsError::Conflict { field, .. }) => field,
        other => panic!("{other}"),
    };
    (field, error.to_string())
}

/// Fields that are each within their own range, but not with the others: refused by the field, with its value and a remedy.
#[test]
fn fields_that_do_not_go_together_are_refused_with_a_remedy() {
    fn guard(setup: &mut Setup) -> &mut GuardSettings {
        setup.control.guard.as_mut().unwrap()
    }
    type Change = fn(&mut Setup);
    let cases: [(&str, Change); 25] = [
        ("displacement", |s| s.control.stroke = 10.0),
        ("displacement", |s| s.control.stroke = 0.1525),
        // 2047 codes reach one way, and with one to spare 2046 the other.
        ("displacement", |s| s.control.stroke = 2046.5 * 7.44e-5),
        ("output", |s| s.wiring.output.zero = 1e30),
        // Unipolar, behind a hard-wired loop: it cannot reach zero flow on one side.
        ("output", |s| {
            s.control.inner_loop = InnerLoop::Hardwired;
            s.wiring.output = Scale { zero: 0.0, per_code: 1e-4 };
        }),
        ("output", |s| {
            s.control.mode = Mode::Modifier;
            s.wiring.output = Scale { zero: 2048.0, per_code: 5e-5 };
        }),
        ("displacement", |s| s.wiring.rails_are_faults = false),
        ("acceleration", |s| {
            s.wiring.rails_are_faults = false;
            (s.control.ranges.displacement, s.control.ranges.acceleration) = (0.15, 30.0);
        }),
        ("guard.envelope.stopping_latency", |s| guard(s).ramps.safe = 10.0),
        ("guard.envelope.stopping_latency", |s| guard(s).envelope.stopping_latency = 0.0),
        ("guard.envelope.stopping_deceleration", |s| guard(s).envelope.stopping_deceleration = 1000.0),
        ("guard.envelope.velocity", |s| guard(s).envelope.velocity = 0.5),
        ("guard.envelope.acceleration", |s| guard(s).envelope.acceleration = 1e4),
        ("guard.envelope.tracking", |s| guard(s).envelope.tracking = 0.25),
        ("guard.envelope.persistence", |s| guard(s).envelope.persistence = 0.06),
        ("guard.plausibility.lost", |s| guard(s).plausibility.lost = 0.06),
        ("guard.plausibility.disagreement", |s| guard(s).plausibility.disagreement = 0.013),
        ("guard.valve.mismatch", |s| guard(s).valve.mismatch = 0.07),
        ("guard.valve.memory", |s| guard(s).valve.memory = 0.01),
        ("guard.ramps.test", |s| guard(s).ramps.test = 0.07),
        ("guard.envelope.jerk", |s| guard(s).envelope.jerk = 2.1e6),
        ("guard.witness.delay", |s| guard(s).witness.delay = 0.24),
        ("guard.witness.bias", |s| guard(s).witness.bias = 2.2),
        ("guard.witness.noise", |s| guard(s).witness.noise = 13.0),
        ("guard.witness.scale", |s| guard(s).witness.scale = 0.6),
    ];
    for (k, (name, change)) in cases.iter().enumerate() {
        let (field, text) = refusal(|setup| {
            if *name == "displacement" {
                setup.control.ranges.displacement = 20.0;
                setup.control.ranges.reference = 20.0;
                guard(setup).ramps.test = 10.0;
            }
            change(setup);
        });
        assert_eq!(field, *name, "case {k}: {text}");
        assert!(text.contains(name) && text.contains([';', ':']), "case {k}: {text}");
    }
    let (_, text) = refusal(|s| guard(s).ramps.safe = 10.0);
    assert!(text.starts_with("control.guard.envelope.stopping_latency is 0.05, not within 5.01"), "{text}");
    assert!(text.ends_with("shorten guard.ramps.safe, or plan for a longer stop"), "{text}");
}

/// An input that no board reads would read zero for ever, and be believed: a velocity that never trips, a pressure that never does.
#[test]
fn what_no_wire_carries_is_not_read() {
    let pressure = PressureSettings { area_per_mass: 1e-6, gain: 0.1, corner: 1.0 };
    let cases: [(&str, &dyn Fn(&mut Settings)); 5] = [
        ("velocity_source", &|s| s.velocity_source = VelocitySource::Sensor),
        ("reference_rates", &|s| s.reference_rates = ReferenceRates::Supplied),
        ("tracking.pressure", &|s| s.tracking.get_or_insert_default().pressure = Some(pressure)),
        ("guard.envelope.force", &|s| {
            let guard = s.guard.as_mut().unwrap();
            guard.envelope.force = Some(ForceSettings { limit: 280e3, piston_area: 0.024 });
        }),
        ("guard.inputs", &|s| s.guard.as_mut().unwrap().inputs.limit_switches = true),
    ];
    for (field, change) in cases {
        let mut unwired = setup();
        change(&mut unwired.control);
        assert_eq!(unwired.control.validate_for_device(), Ok(()), "{field}");
        let refused = unwired.validate();
        assert!(
            matches!(refused, Err(SetupError::Control(SettingsError::Contradiction { field: of, .. })) if of == field),
            "{field}: {refused:?}"
        );
    }
}

#[test]
fn a_rail_is_no_reading_a_4096th_of_the_range_wide() {
    let margin =
        |full_scale: u16, rails_are_faults: bool| Wiring { full_scale, rails_are_faults, ..setup().wiring }.margin();
    assert_eq!([margin(4095, true), margin(65535, true), margin(65535, false)], [1, 16, 0]);
}

#[test]
fn both_ends_of_the_stroke_are_read_and_reached_with_a_code_to_spare() {
    assert_eq!(setup().validate(), Ok(()));
    let unipolar = |s: &mut Setup| s.wiring.displacement = Scale { zero: 0.0, per_code: 1e-4 };
    assert_eq!(refusal(unipolar).0, "displacement");
    // A code is spared at both ends of the output: 2047 codes reach one way, 2046 the other.
    let reaching = |codes: f32| {
        move |s: &mut Setup| {
            s.control.inner_loop = InnerLoop::Hardwired;
            s.wiring.output.per_code = 0.12 / codes;
        }
    };
    assert_eq!(refusal(reaching(2046.5)).0, "output");
    let mut enough = setup();
    reaching(2045.5)(&mut enough);
    assert_eq!(enough.validate(), Ok(()));
}

/// A reference at its rail is asked about where it is read: at the converter, and not in guard mode.
#[test]
fn only_a_reference_that_is_read_must_reach_its_range() {
    let checked = |source: Source, mode: Mode| {
        let mut setup = setup();
        setup.wiring.rails_are_faults = false;
        (setup.wiring.source, setup.control.mode) = (source, mode);
        (setup.control.ranges.displacement, setup.control.ranges.external) = (0.15, 0.15);
        (setup.wiring.acceleration.per_code, setup.control.ranges.acceleration) = (0.1, 100.0);
        setup.control.ranges.reference = 0.2;
        setup.validate()
    };
    let analog = checked(Source::Analog, Mode::Controller);
    assert!(matches!(analog, Err(SetupError::Reach { field: "reference", .. })), "{analog:?}");
    assert_eq!(checked(Source::Streamed, Mode::Controller), Ok(()));
    assert_eq!(checked(Source::Analog, Mode::Guard), Ok(()));
}

#[test]
fn a_drift_has_a_witness_in_a_second_sensor_or_a_limit_switch() {
    let missed = |second: Option<f32>, limit_switches: bool| {
        let mut control = setup().control;
        let inputs = &mut control.guard.as_mut().unwrap().inputs;
        (inputs.second_displacement, inputs.limit_switches) = (second, limit_switches);
        control.findings().any(|finding| finding == Finding::NoDriftWitness)
    };
    assert_eq!([missed(None, false), missed(Some(0.01), false), missed(None, true)], [true, false, false]);
}

#[test]
fn a_reference_comes_from_the_host_or_from_the_converter() {
    let from_the_host = [Source::Streamed, Source::Rehearsal, Source::Analog].map(Source::streamed);
    assert_eq!(from_the_host, [true, true, false]);
}

/// Where rails are no faults either rail lies beyond what is believed: of an external command too, but in guard mode alone.
#[test]
fn both_rails_lie_beyond_what_is_believed() {
    let checked = |mode: Mode, external: Scale| {
        let mut setup = setup();
        setup.wiring.rails_are_faults = false;
        setup.control.mode = mode;
        (setup.control.ranges.displacement, setup.control.ranges.reference) = (0.15, 0.15);
        (setup.wiring.acceleration.per_code, setup.control.ranges.acceleration) = (0.1, 100.0);
        (setup.wiring.external, setup.control.ranges.external) = (external, 1.5);
        setup.validate()
    };
    let reaching = |low: f32, high: f32| {
        let per_code = (high - low) / 4095.0;
        Scale { zero: -low / per_code, per_code }
    };
    assert_eq!(checked(Mode::Guard, reaching(-2.0, 2.0)), Ok(()));
    for (low, high) in [(-1.0, 2.0), (-2.0, 1.0)] {
        let Err(SetupError::Reach { field, reach, needed, .. }) = checked(Mode::Guard, reaching(low, high)) else {
            panic!("{low} to {high} was accepted");
        };
        assert_eq!((field, needed), ("external", [-1.5, 1.5]));
        assert!((reach[0] - low).abs() < 1e-3 && (reach[1] - high).abs() < 1e-3, "{reach:?}");
        assert_eq!(checked(Mode::Controller, reaching(low, high)), Ok(()), "nobody reads it");
    }
}

/// A valve is remembered as long as a table at full speed takes to move by the mismatch.
#[test]
fn a_valve_is_not_forgotten_before_the_table_has_moved() {
    let remembering = |share: f32| {
        let mut control = setup().control;
        let limit = control.velocity_limit;
        let valve = &mut control.guard.as_mut().unwrap().valve;
        valve.memory = share * valve.mismatch / limit;
        control.validate_for_device()
    };
    assert_eq!(remembering(1.01), Ok(()));
    let refused = remembering(0.99);
    assert!(matches!(refused, Err(SettingsError::Conflict { field: "guard.valve.memory", .. })), "{refused:?}");
}

#[test]
fn what_a_guard_lacks_is_said_and_of_a_bare_law_that_it_has_none() {
    for (mode, accelerometer) in [(Mode::Controller, true), (Mode::Controller, false), (Mode::Modifier, false)] {
        let mut bare = Settings { mode, ..Settings::default() };
        bare.observer.accelerometer = accelerometer;
        let found: Vec<Finding> = bare.findings().collect();
        assert_eq!(found, [Finding::NoGuard, Finding::NoSaturationDetection]);
    }
    let blind = |mode: Mode, second: bool| {
        let mut guarded = Settings { mode, ..setup().control };
        guarded.observer.accelerometer = false;
        if let (Some(guard), true) = (&mut guarded.guard, second) {
            guard.inputs.second_displacement = Some(0.01);
        }
        let of_the_sensor = |finding: &Finding| matches!(finding, Finding::NoAccelerometer | Finding::NoSecondWitness);
        guarded.findings().filter(of_the_sensor).collect::<Vec<_>>()
    };
    assert_eq!(blind(Mode::Controller, false), [Finding::NoAccelerometer]);
    assert_eq!(blind(Mode::Modifier, true), [Finding::NoAccelerometer]);
    assert_eq!(blind(Mode::Modifier, false), [Finding::NoSecondWitness]);
    let seen: Vec<Finding> = setup().control.findings().collect();
    assert!(!seen.contains(&Finding::NoAccelerometer) && !seen.contains(&Finding::NoSecondWitness), "{seen:?}");
}
