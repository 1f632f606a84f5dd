//! Settings: refused as a whole, with the field, what was given and what is accepted.

use proptest::prelude::*;
use shakedown_core::settings::{
    Detection, ForceSettings, GuardSettings, InnerLoop, InputSettings, NotchSettings, OilSettings, PressureSettings,
    ReferenceRates, TrackingSettings, VelocitySource,
};
use shakedown_core::{Controller, Mode, Modification, Settings, SettingsError};

type Field = (&'static str, fn(&mut Settings) -> &mut f32);

/// Every number that settings hold, with the name an error gives it.
const FIELDS: &[Field] = &[
    ("rate", |s| &mut s.rate),
    ("displacement.proportional", |s| &mut s.displacement.proportional),
    ("displacement.integral", |s| &mut s.displacement.integral),
    ("velocity.proportional", |s| &mut s.velocity.proportional),
    ("velocity.integral", |s| &mut s.velocity.integral),
    ("acceleration.proportional", |s| &mut s.acceleration.proportional),
    ("acceleration.integral", |s| &mut s.acceleration.integral),
    ("velocity_limit", |s| &mut s.velocity_limit),
    ("stroke", |s| &mut s.stroke),
    ("blend", |s| &mut s.blend),
    ("washout_frequency", |s| &mut s.washout_frequency),
    ("observer.frequency", |s| &mut s.observer.frequency),
    ("observer.smoothing", |s| &mut s.observer.smoothing),
    ("reference_rates.frequency", |s| match &mut s.reference_rates {
        ReferenceRates::Derived { frequency } => frequency,
        _ => unreachable!("full() derives them"),
    }),
    ("preview", |s| match &mut s.modification {
        Modification::Preview { seconds } => seconds,
        _ => unreachable!("full() previews"),
    }),
    ("valve.gain", |s| &mut s.valve.gain),
    ("valve.lag", |s| &mut s.valve.lag),
    ("valve.null_bias", |s| &mut s.valve.null_bias),
    ("valve.command_limit", |s| &mut s.valve.command_limit),
    ("ranges.reference", |s| &mut s.ranges.reference),
    ("ranges.displacement", |s| &mut s.ranges.displacement),
    ("ranges.velocity", |s| &mut s.ranges.velocity),
    ("ranges.acceleration", |s| &mut s.ranges.acceleration),
    ("ranges.external", |s| &mut s.ranges.external),
    ("ranges.pressure_difference", |s| &mut s.ranges.pressure_difference),
    ("saturation.plateau", |s| &mut detection(s).plateau),
    ("saturation.error", |s| &mut detection(s).error),
    ("saturation.shortfall", |s| &mut detection(s).shortfall),
    ("saturation.floor", |s| &mut detection(s).floor),
    ("saturation.hold", |s| &mut detection(s).hold),
    ("saturation.follow", |s| &mut detection(s).follow),
    ("saturation.recovery", |s| &mut detection(s).recovery),
    ("tracking.bandwidth", |s| &mut tracking(s).bandwidth),
    ("tracking.disturbance", |s| &mut tracking(s).disturbance),
    ("tracking.delay", |s| &mut tracking(s).delay),
    ("tracking.lead", |s| &mut tracking(s).lead),
    ("tracking.spacing", |s| &mut tracking(s).spacing),
    ("tracking.noise.displacement", |s| &mut tracking(s).noise.displacement),
    ("tracking.noise.acceleration", |s| &mut tracking(s).noise.acceleration),
    ("tracking.flow.asymmetry", |s| &mut tracking(s).flow.asymmetry),
    ("tracking.flow.sharpness", |s| &mut tracking(s).flow.sharpness),
    ("tracking.flow.stall", |s| &mut tracking(s).flow.stall),
    ("tracking.flow.droop", |s| &mut tracking(s).flow.droop),
    ("tracking.flow.recovery", |s| &mut tracking(s).flow.recovery),
    ("tracking.flow.overdrive", |s| &mut tracking(s).flow.overdrive),
    ("tracking.friction.coulomb", |s| &mut tracking(s).friction.coulomb),
    ("tracking.friction.viscous", |s| &mut tracking(s).friction.viscous),
    ("tracking.friction.velocity", |s| &mut tracking(s).friction.velocity),
    ("tracking.friction.deadband", |s| &mut tracking(s).friction.deadband),
    ("tracking.oil.frequency", |s| &mut tracking(s).oil.as_mut().unwrap().frequency),
    ("tracking.oil.damping", |s| &mut tracking(s).oil.as_mut().unwrap().damping),
    ("tracking.pressure.area_per_mass", |s| &mut tracking(s).pressure.as_mut().unwrap().area_per_mass),
    ("tracking.pressure.gain", |s| &mut tracking(s).pressure.as_mut().unwrap().gain),
    ("tracking.pressure.corner", |s| &mut tracking(s).pressure.as_mut().unwrap().corner),
    ("tracking.notch.frequency", |s| &mut tracking(s).notch.as_mut().unwrap().frequency),
    ("tracking.notch.damping", |s| &mut tracking(s).notch.as_mut().unwrap().damping),
    ("guard.envelope.margin", |s| &mut guard(s).envelope.margin),
    ("guard.envelope.stopping_latency", |s| &mut guard(s).envelope.stopping_latency),
    ("guard.envelope.stopping_deceleration", |s| &mut guard(s).envelope.stopping_deceleration),
    ("guard.envelope.velocity", |s| &mut guard(s).envelope.velocity),
    ("guard.envelope.acceleration", |s| &mut guard(s).envelope.acceleration),
    ("guard.envelope.jerk", |s| &mut guard(s).envelope.jerk),
    ("guard.envelope.force.limit", |s| &mut guard(s).envelope.force.as_mut().unwrap().limit),
    ("guard.envelope.force.piston_area", |s| &mut guard(s).envelope.force.as_mut().unwrap().piston_area),
    ("guard.envelope.tracking", |s| &mut guard(s).envelope.tracking),
    ("guard.envelope.persistence", |s| &mut guard(s).envelope.persistence),
    ("guard.plausibility.lost", |s| &mut guard(s).plausibility.lost),
    ("guard.plausibility.stuck", |s| &mut guard(s).plausibility.stuck),
    ("guard.plausibility.disagreement", |s| &mut guard(s).plausibility.disagreement),
    ("guard.plausibility.offset", |s| &mut guard(s).plausibility.offset),
    ("guard.plausibility.acceleration_noise", |s| &mut guard(s).plausibility.acceleration_noise),
    ("guard.witness.frequency", |s| &mut guard(s).witness.frequency),
    ("guard.witness.scale", |s| &mut guard(s).witness.scale),
    ("guard.witness.delay", |s| &mut guard(s).witness.delay),
    ("guard.witness.bias", |s| &mut guard(s).witness.bias),
    ("guard.witness.noise", |s| &mut guard(s).witness.noise),
    ("guard.inputs.second_displacement", |s| guard(s).inputs.second_displacement.as_mut().unwrap()),
    ("guard.inputs.relay_feedback", |s| guard(s).inputs.relay_feedback.as_mut().unwrap()),
    ("guard.valve.mismatch", |s| &mut guard(s).valve.mismatch),
    ("guard.valve.memory", |s| &mut guard(s).valve.memory),
    ("guard.ramps.test", |s| &mut guard(s).ramps.test),
    ("guard.ramps.safe", |s| &mut guard(s).ramps.safe),
];

fn detection(settings: &mut Settings) -> &mut Detection {
    settings.saturation.as_mut().unwrap()
}

fn tracking(settings: &mut Settings) -> &mut TrackingSettings {
    settings.tracking.as_mut().unwrap()
}

fn guard(settings: &mut Settings) -> &mut GuardSettings {
    settings.guard.as_mut().unwrap()
}

/// Settings in which every optional part is there.
fn full() -> Settings {
    let mut settings = Settings {
        saturation: Some(Detection::default()),
        tracking: Some(TrackingSettings {
            oil: Some(OilSettings { frequency: 12.0, damping: 0.05 }),
            pressure: Some(PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 }),
            notch: Some(NotchSettings { frequency: 30.0, damping: 0.2 }),
            ..TrackingSettings::default()
        }),
        guard: Some(GuardSettings::default()),
        reference_rates: ReferenceRates::Derived { frequency: 50.0 },
        modification: Modification::Preview { seconds: 0.1 },
        ..Settings::default()
    };
    guard(&mut settings).inputs =
        InputSettings { second_displacement: Some(0.01), limit_switches: true, relay_feedback: Some(0.1) };
    guard(&mut settings).envelope.force = Some(ForceSettings { limit: 280e3, piston_area: 0.024 });
    settings
}

#[test]
fn what_is_no_number_is_refused_in_every_field_by_name() {
    assert_eq!(full().validate(), Ok(()));
    for (name, field) in FIELDS {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30] {
            let mut settings = full();
            *field(&mut settings) = bad;
            let Err(SettingsError::OutOfRange { field, value, low, high }) = settings.validate() else {
                panic!("{name} = {bad} was accepted");
            };
            assert_eq!(field, *name);
            assert!(low < high && (value == bad || value.is_nan() && bad.is_nan()));
            assert!(Controller::new(&settings).is_err());
        }
    }
}

/// What `settings` say of `field` when it holds `value`: none where it is not this field that does not hold.
fn refusal(settings: &Settings, (name, field): &Field, value: f32) -> Option<(f32, f32)> {
    let mut settings = *settings;
    *field(&mut settings) = value;
    match settings.validate() {
        Err(SettingsError::OutOfRange { field, low, high, .. }) if field == *name => Some((low, high)),
        _ => None,
    }
}

/// The range of `field`: that of a check which comes later where it is narrower.
fn range(settings: &Settings, field: &Field) -> (f32, f32) {
    let (low, high) = refusal(settings, field, f32::NAN).unwrap();
    (
        refusal(settings, field, low).map_or(low, |later| later.0),
        refusal(settings, field, high).map_or(high, |later| later.1),
    )
}

/// The settings above at another rate, stroke and limit, which ranges depend on.
fn other() -> Settings {
    let mut settings = Settings { rate: 4000.0, stroke: 0.3, velocity_limit: 0.8, ..full() };
    settings.modification = Modification::Preview { seconds: 0.01 };
    settings.valve.lag = 0.03;
    tracking(&mut settings).spacing = 0.001;
    settings
}

/// Every field's range, its ends included and the next number beyond them not; `tests/golden/ranges.txt` has them all, for
/// two settings. `UPDATE_GOLDEN=1 cargo test -p shakedown-core --test promises ranges` writes them down.
#[test]
fn every_field_has_its_range_and_the_ends_belong_to_it() {
    let mut text = String::new();
    for field in FIELDS {
        text += &format!("{:<40}", field.0);
        for settings in [full(), other()] {
            assert_eq!(settings.validate(), Ok(()));
            let (low, high) = range(&settings, field);
            for (value, holds) in [(low, true), (high, true), (low.next_down(), false), (high.next_up(), false)] {
                let refused = refusal(&settings, field, value);
                assert_eq!(refused.is_none(), holds, "{} = {value:e} of {low:e} to {high:e}: {refused:?}", field.0);
            }
            text += &format!(" {low:>14e} to {high:<14e}");
        }
        text = text.trim_end().to_owned() + "\n";
    }
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/ranges.txt");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let written = std::fs::read_to_string(path).unwrap_or_default();
    let changed: Vec<&str> = text.lines().filter(|line| !written.lines().any(|old| old == *line)).collect();
    assert!(text == written, "ranges are not those written down: {changed:#?}");
}

#[test]
fn the_list_above_misses_no_number() {
    // Postcard writes each f32 in four bytes; what is not a number in the list must be an enum or an option's tag.
    let mut buffer = [0; 1024];
    let bytes = postcard::to_slice(&full(), &mut buffer).unwrap().len();
    let tags = bytes - 4 * FIELDS.len();
    // mode, inner_loop, anti_windup, modification, reference_rates, velocity_source, accelerometer; saturation, tracking with
    // oil, pressure and notch, guard, force, second displacement, limit switches, relay.
    assert_eq!(tags, 17, "a field was added: name it in FIELDS");
}

#[test]
fn what_contradicts_itself_is_refused() {
    let mut settings = full();
    settings.acceleration.proportional = 1.0;
    settings.observer.accelerometer = false;
    let error = settings.validate().unwrap_err();
    assert_eq!(error.to_string(), "acceleration does not go with observer.accelerometer = false");
}

#[test]
fn a_file_names_only_what_differs_and_a_misspelt_field_is_refused() {
    let settings: Settings =
        toml::from_str("rate = 2000.0\nmodification = \"causal\"\n[guard.ramps]\ntest = 5.0").unwrap();
    assert_eq!((settings.rate, settings.modification), (2000.0, Modification::Causal));
    assert_eq!(settings.guard.unwrap().ramps.test, 5.0);
    assert_eq!(settings.displacement, Settings::default().displacement);
    let error = toml::from_str::<Settings>("veloctiy_limit = 0.3").unwrap_err();
    assert!(error.to_string().contains("veloctiy_limit"));
}

/// What a program with serde writes, one without reads: every number, one after the other changed, and every word.
#[test]
fn a_settings_file_is_read_by_name_as_it_was_written() {
    let read = |settings: &Settings| {
        let text = toml::to_string(settings).unwrap();
        let mut read = Settings::default();
        read.read(&text).unwrap_or_else(|error| panic!("{error:?} of {text}"));
        assert_eq!(read, *settings, "{text}");
    };
    for (_, field) in FIELDS {
        let mut changed = full();
        *field(&mut changed) *= 1.5;
        read(&changed);
    }
    for mode in [Mode::Guard, Mode::Modifier, Mode::Controller] {
        read(&Settings { mode, ..full() });
    }
    for inner_loop in [InnerLoop::Absent, InnerLoop::Hardwired] {
        read(&Settings { inner_loop, ..full() });
    }
    for velocity_source in [VelocitySource::Observer, VelocitySource::Sensor] {
        read(&Settings { velocity_source, ..full() });
    }
    for modification in [Modification::Off, Modification::Clip, Modification::Causal] {
        read(&Settings { modification, ..full() });
    }
    for reference_rates in [ReferenceRates::Differences, ReferenceRates::Supplied, ReferenceRates::Zero] {
        read(&Settings { reference_rates, ..full() });
    }
    for on in [false, true] {
        let mut switched = Settings { anti_windup: on, ..full() };
        switched.observer.accelerometer = on;
        if let Some(guard) = &mut switched.guard {
            guard.inputs.limit_switches = on;
        }
        read(&switched);
    }
}

#[test]
fn a_table_of_settings_takes_no_value() {
    for table in ["guard", "guard.inputs", "tracking", "ranges", "modification.preview", "reference_rates.derived"] {
        assert!(Settings::default().set(table, "1.0").is_err(), "{table}");
        let headed = Settings::default().read(&format!("[{table}]"));
        assert_eq!(headed, Ok(()), "{table}");
    }
}

proptest! {
    #[test]
    fn settings_pass_through_frame_and_file_unchanged(rate in 50.0..20_000.0f32, gain in -20.0..20.0f32, limit in 0.01..2.0f32) {
        let mut settings = Settings { rate, velocity_limit: limit, ..full() };
        settings.velocity.integral = gain;
        let mut buffer = [0; 1024];
        let frame = postcard::to_slice(&settings, &mut buffer).unwrap();
        prop_assert_eq!(postcard::from_bytes::<Settings>(frame).unwrap(), settings);
        prop_assert_eq!(toml::from_str::<Settings>(&toml::to_string(&settings).unwrap()).unwrap(), settings);
    }

    #[test]
    fn what_is_accepted_runs(values in proptest::collection::vec((0..FIELDS.len(), -3.0..3.0f32), 0..6)) {
        let mut settings = full();
        for (index, exponent) in values {
            let field = FIELDS[index].1(&mut settings);
            *field *= libm::exp10f(exponent);
        }
        if let Ok(mut controller) = Controller::new(&settings) {
            let _ = controller.request(shakedown_core::OperatorRequest::Arm);
            let _ = controller.request(shakedown_core::OperatorRequest::Start);
            for k in 0..100 {
                let reference = 0.1 * libm::sinf(k as f32 * 0.1);
                let command = controller.step(&shakedown_core::Sample::new(reference, -reference, 5.0 * reference));
                prop_assert!(command.valve.is_finite() && command.reference.is_finite());
            }
        }
    }
}
