use super::*;
use proptest::prelude::*;

/// `sin(0.3 k) + 0.1 k`, 24 samples; the golden values below are those of `scipy.signal` 1.17 at these places.
fn ramp_and_wave() -> Vec<f64> {
    (0..24).map(|k| (0.3 * f64::from(k)).sin() + 0.1 * f64::from(k)).collect()
}

const PLACES: [usize; 6] = [0, 5, 10, 15, 20, 23];

fn assert_golden(found: &[f64], golden: [f64; 6], tolerance: f64) {
    for (place, want) in PLACES.into_iter().zip(golden) {
        assert!((found[place] - want).abs() < tolerance, "at {place}: {} for {want}", found[place]);
    }
}

#[test]
fn causal_filters_agree_with_scipy() {
    let low = Butterworth::low_pass(6, 4.7).design(0.01).unwrap().causal(&ramp_and_wave());
    let golden = [
        0.0,
        0.002_747_474_980_772_973,
        0.104_676_808_462_305_7,
        0.585_186_790_289_916_4,
        1.194_199_349_254_039_7,
        1.297_013_193_256_399_5,
    ];
    assert_golden(&low, golden, 1e-13);
    let high = Butterworth::high_pass(5, 20.0).design(0.01).unwrap().causal(&ramp_and_wave());
    let golden = [
        0.0,
        0.020_869_963_722_988_195,
        0.005_440_288_949_338_183,
        0.001_135_356_755_709_653_3,
        0.000_576_767_805_629_555_4,
        0.000_376_340_015_531_238_5,
    ];
    assert_golden(&high, golden, 1e-13);
}

#[test]
fn zero_phase_filters_agree_with_scipy() {
    let x = ramp_and_wave();
    let even = Butterworth::low_pass(4, 15.0).design(0.01).unwrap().zero_phase(&x, Edge::Odd(15));
    let golden = [
        -0.000_238_510_354_644_713_7,
        1.497_524_594_096_243_6,
        1.141_171_521_133_282_5,
        0.520_551_612_896_969_9,
        1.722_286_205_281_548_2,
        2.880_176_279_275_068_5,
    ];
    assert_golden(&even, golden, 1e-12);
    let odd = Butterworth::low_pass(3, 10.0).design(0.01).unwrap().zero_phase(&x, Edge::Odd(7));
    let golden = [
        -0.006_596_584_822_914_878,
        1.488_301_947_401_182_7,
        1.138_768_335_463_817_4,
        0.538_759_743_212_504_6,
        1.692_098_180_156_895,
        2.946_820_958_758_027_4,
    ];
    assert_golden(&odd, golden, 1e-12);
}

#[test]
fn held_ends_are_ends_held_for_ever() {
    // SciPy's with 20,000 samples of the end values to either side.
    let golden = [
        -1.029_611_110_248_290_6,
        0.321_424_966_861_500_24,
        -0.185_671_301_479_148_9,
        -0.957_122_823_387_728_8,
        0.088_434_917_207_159_01,
        1.155_993_639_925_964_7,
    ];
    let filter = Butterworth::high_pass(2, 0.5).design(0.01).unwrap();
    assert_golden(&filter.zero_phase(&ramp_and_wave(), Edge::Hold), golden, 1e-8);
    // Reflected ends give another answer, so the test can fail.
    assert!((filter.zero_phase(&ramp_and_wave(), Edge::Odd(9))[0] - golden[0]).abs() > 0.1);
}

#[test]
fn what_cannot_be_designed_is_refused_with_its_values() {
    assert_eq!(Butterworth::low_pass(0, 1.0).design(0.01), Err(FilterError::Order(0)));
    assert_eq!(Butterworth::low_pass(21, 1.0).design(0.01), Err(FilterError::Order(21)));
    let nyquist = Err(FilterError::Corner { corner: 50.0, nyquist: 50.0 });
    assert_eq!(Butterworth::high_pass(2, 50.0).design(0.01), nyquist);
    assert!(Butterworth::low_pass(2, f64::NAN).design(0.01).is_err());
    let band = Butterworth { band: Band::BandPass(5.0, 1.0), order: 2 };
    assert_eq!(band.design(0.01), Err(FilterError::Band { low: 5.0, high: 1.0 }));
}

#[test]
fn a_band_pass_is_its_two_sides() {
    let band = Butterworth { band: Band::BandPass(1.0, 10.0), order: 4 }.design(0.01).unwrap();
    let low = Butterworth::low_pass(4, 10.0).design(0.01).unwrap();
    let high = Butterworth::high_pass(4, 1.0).design(0.01).unwrap();
    for f in [0.1, 1.0, 3.0, 10.0, 30.0] {
        assert!((band.gain(f, 0.01) - low.gain(f, 0.01) * high.gain(f, 0.01)).abs() < 1e-12);
    }
}

proptest! {
    #[test]
    fn the_gain_is_butterworths(order in 1..=12usize, corner in 0.5..40.0f64, f in 0.1..49.0f64, high: bool) {
        let dt = 0.01;
        let filter =
            if high { Butterworth::high_pass(order, corner) } else { Butterworth::low_pass(order, corner) };
        // The bilinear transform maps frequencies by the tangent.
        let ratio = (PI * f * dt).tan() / (PI * corner * dt).tan();
        let power = (2 * order) as f64 * if high { -1.0 } else { 1.0 };
        let exact = 1.0 / (1.0 + ratio.powf(power)).sqrt();
        let gain = filter.design(dt).unwrap().gain(f, dt);
        prop_assert!((gain - exact).abs() < 1e-9 * (1.0 + exact), "{gain} {exact}");
    }

    #[test]
    fn zero_phase_commutes_with_time_reversal(x in prop::collection::vec(-1.0..1.0f64, 2..120), order in 1..=6usize) {
        let filter = Butterworth::low_pass(order, 8.0).design(0.01).unwrap();
        let forward = filter.zero_phase(&x, Edge::Hold);
        let mut reversed: Vec<f64> = x.iter().rev().copied().collect();
        reversed = filter.zero_phase(&reversed, Edge::Hold);
        reversed.reverse();
        for (a, b) in forward.iter().zip(&reversed) {
            prop_assert!((a - b).abs() < 1e-7, "{a} {b}");
        }
        prop_assert_eq!(forward.len(), x.len());
    }

    #[test]
    fn a_low_pass_keeps_a_constant_and_a_high_pass_kills_it(value in -9.0..9.0f64, order in 1..=8usize, n in 1..50usize) {
        let x = vec![value; n];
        let low = Butterworth::low_pass(order, 3.0).apply(&x, 0.005, Pass::ZeroPhase).unwrap();
        let high = Butterworth::high_pass(order, 3.0).apply(&x, 0.005, Pass::ZeroPhase).unwrap();
        prop_assert!(low.iter().all(|y| (y - value).abs() < 1e-7));
        prop_assert!(high.iter().all(|y| y.abs() < 1e-7));
    }
}
