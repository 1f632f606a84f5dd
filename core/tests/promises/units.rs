//! Codes, volts and metres: there and back, and along the one line that a tick uses.

use proptest::prelude::*;
use shakedown_core::units::{Channel, Code, Converter, Volt};

fn converters() -> impl Strategy<Value = Converter> {
    (
        prop_oneof![Just(4095_u16), Just(65_535)],
        prop_oneof![Just((0.0, 3.3)), Just((-10.0, 10.0)), Just((-10.24, 10.24))],
    )
        .prop_map(|(full, (low, high))| Converter::new(Code(full), Volt(low), Volt(high)).unwrap())
}

proptest! {
    #[test]
    fn every_code_comes_back(converter in converters(), code in 0..=4095_u16, zero in -5.0..5.0f32, slope in 1e-3..10.0f32) {
        prop_assert_eq!(converter.to_code(converter.to_volt(Code(code))), Some(Code(code)));
        let channel = Channel::new(Volt(zero), -slope).unwrap();
        let si = channel.to_si(converter.to_volt(Code(code)));
        prop_assert_eq!(converter.to_code(channel.to_volt(si)), Some(Code(code)));
        // The one line agrees with the two steps to a few roundings of the larger of voltage and zero.
        let line = channel.scale(converter).to_si(code);
        prop_assert!((line - si).abs() < 4e-6 * slope * 16.0, "{line} against {si}");
    }

    #[test]
    fn codes_stay_within_the_converter(converter in converters(), bits: u32) {
        let volt = Volt(f32::from_bits(bits));
        match converter.to_code(volt) {
            None => prop_assert!(volt.0.is_nan()),
            Some(code) => prop_assert!(converter.to_code(converter.to_volt(code)) == Some(code)),
        }
    }
}

#[test]
fn what_is_no_converter_or_channel_is_refused() {
    assert!(Converter::new(Code(16), Volt(0.0), Volt(3.3)).is_err());
    assert!(Converter::new(Code(4095), Volt(3.3), Volt(0.0)).is_err());
    assert!(Converter::new(Code(4095), Volt(f32::NAN), Volt(3.3)).is_err());
    assert!(Channel::new(Volt(0.0), 0.0).is_err());
    assert!(Channel::new(Volt(f32::INFINITY), 1.0).is_err());
}

#[test]
fn the_lvdt_of_the_paper() {
    let converter = Converter::new(Code(65_535), Volt(-10.0), Volt(10.0)).unwrap();
    let lvdt = Channel::new(Volt(0.0), 0.0125).unwrap();
    assert!((lvdt.to_si(Volt(8.0)) - 0.1).abs() < 1e-7);
    assert!(lvdt.to_si(converter.to_volt(Code(32_768))).abs() < 2e-6);
    // A channel scaled by another per-volt would be seen.
    assert!((Channel::new(Volt(0.0), 0.0126).unwrap().to_si(Volt(8.0)) - 0.1).abs() > 1e-4);
}
