//! The core's settings in TOML: refused with a message, or taken; a controller made of what was taken gives numbers.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown_core::{Controller, OperatorRequest, Sample, Settings};

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let Ok(settings) = toml::from_str::<Settings>(text) else { return };
    let refused = settings.validate().map_err(|error| assert!(!error.to_string().is_empty())).is_err();
    let Ok(mut controller) = Controller::new(&settings) else {
        assert!(refused, "what validates can be run");
        return;
    };
    assert!(!refused, "what can be run validates");
    for tick in 0..200_u16 {
        let x = 0.01 * f32::from(tick % 17) - 0.08;
        let sample =
            Sample { external: x, velocity: x, pressure_difference: 1e5 * x, ..Sample::new(x, 0.5 * x, 10.0 * x) };
        if tick == 5 {
            let _ = controller.request(OperatorRequest::Arm);
            let _ = controller.request(OperatorRequest::Start);
        }
        let command = controller.step(&sample);
        assert!(command.valve.is_finite() && command.reference.is_finite(), "{command:?} of {settings:?}");
    }
});
