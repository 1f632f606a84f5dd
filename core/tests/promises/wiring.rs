//! Wiring: what a code stands for, what no converter can have, and a device that does not run without a guard.

use shakedown_core::guard::GuardSettings;
use shakedown_core::link::{Scale, Setup, SetupError, Source, Wiring};
use shakedown_core::{Settings, SettingsError};

fn setup() -> Setup {
    let line = Scale { zero: 2048.0, per_code: -5e-5 };
    Setup {
        telemetry_every: 10,
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
    for (name, line) in LINES {
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
            assert_eq!(setup.validate().is_ok(), holds, "{name} {slope}");
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
    assert_eq!(full_scale(255), Ok(()));
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
