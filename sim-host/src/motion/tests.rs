//! Against real records, where they are at hand.

use super::condition::Recipe;
use super::read::{Channel, Options, record};
use super::{Format, Motion, STANDARD_GRAVITY, peak};
use std::path::PathBuf;

/// A file of the development data, or nothing and a line that says so.
pub(super) fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SHAKEDOWN_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    let path = folder.join("records").join(name);
    if path.exists() {
        return Some(path);
    }
    crate::skipped::without(&path);
    None
}

fn read(name: &str, channel: Channel) -> Option<super::Record> {
    let options = Options { channel, ..Options::default() };
    Some(record(&data(name)?, &options).unwrap())
}

/// Peaks as the data's own table states them: g, cm/s, cm.
#[test]
fn peaks_are_those_the_data_state() {
    let table = [
        ("RSN1106_KOBE_KJM000.AT2", 0.834, 91.1, 21.1),
        ("IELC180.AT2", 0.313, 29.7, 13.0),
        ("RSN6_IMPVALL.I_I-ELC180.AT2", 0.281, 30.9, 8.7),
        ("RSN15_KERN_TAF021.AT2", 0.159, 15.2, 6.1),
        ("Rinaldi228.AT2", 0.874, 148.0, 41.9),
    ];
    for (name, g, velocity, displacement) in table {
        let Some(record) = read(name, Channel::First) else { return };
        let (x, v, a) = record.motion().peaks();
        assert!((a / STANDARD_GRAVITY - g).abs() < 5e-4, "{name}: {} g", a / STANDARD_GRAVITY);
        assert!((100.0 * v - velocity).abs() < 0.06, "{name}: {} cm/s", 100.0 * v);
        assert!((100.0 * x - displacement).abs() < 0.05, "{name}: {} cm", 100.0 * x);
        assert_eq!(record.format, Format::Peer);
    }
}

#[test]
fn three_components_of_geonet_are_told_apart() {
    for (channel, component, peak_g) in [
        (Channel::First, "N28W", 9.7331),
        (Channel::Name("s62w".into()), "S62W", 7.9664),
        (Channel::Number(3), "Up", 18.0219),
    ] {
        let Some(record) = read("20161113_110259_WTMC_20.V2A", channel) else { return };
        assert_eq!((record.component.as_str(), record.acceleration.len()), (component, 8192));
        assert!((peak(&record.acceleration) - peak_g).abs() < 1e-9);
        assert!((record.dt - 0.02).abs() < 1e-12 && record.format == Format::GeoNet);
    }
}

#[test]
fn csmip_and_knet_give_the_peaks_of_their_headers() {
    let Some(record) = read("ce36456p_CE36456.V2", Channel::First) else { return };
    assert_eq!((record.component.as_str(), record.acceleration.len()), ("90 DEG", 3251));
    assert!((peak(&record.acceleration) - 2.67957).abs() < 1e-9);
    let (_, v, _) = record.motion().peaks();
    assert!((v - 0.28253).abs() < 0.01, "{v}");
    let Some(up) = read("ce36456p_CE36456.V2", Channel::Name("up".into())) else { return };
    assert_eq!((up.component.as_str(), up.acceleration.len()), ("UP", 3250));
    let Some(knet) = read("AOM0011801241951.NS", Channel::First) else { return };
    assert_eq!((knet.component.as_str(), knet.acceleration.len()), ("N-S", 10_200));
    assert!((peak(&knet.acceleration) - 0.049_54).abs() < 5e-6);
}

/// The paper's references: the causal 6th-order low-pass at 4.7 Hz on the full records.
#[test]
fn the_low_pass_gives_the_papers_reference_peaks() {
    let mut recipe = Recipe::table1(1000.0);
    recipe.steps.truncate(3);
    for (name, g) in [("RSN1106_KOBE_KJM000.AT2", 0.739), ("IELC180.AT2", 0.280), ("RSN15_KERN_TAF021.AT2", 0.132)] {
        let Some(record) = read(name, Channel::First) else { return };
        let found = peak(&recipe.apply(&record).unwrap().acceleration) / STANDARD_GRAVITY;
        assert!((found - g).abs() < 5e-4, "{name}: {found} g");
    }
}

/// What clipping the velocity at 0.242 m/s costs under the conditioning for fitting, as measured before.
#[test]
fn the_conditioning_for_fitting_gives_the_errors_of_clipping_known_for_it() {
    for (name, peak_g, want) in [
        ("RSN1106_KOBE_KJM000.AT2", Some(0.74), 0.639),
        ("RSN1106_KOBE_KJM000.AT2", None, 0.684),
        ("Rinaldi228.AT2", None, 0.746),
        ("IELC180.AT2", None, 0.215),
        ("RSN15_KERN_TAF021.AT2", None, 0.0),
    ] {
        let Some(record) = read(name, Channel::First) else { return };
        let motion = Recipe::fitting(peak_g.map(|g| g * STANDARD_GRAVITY)).apply(&record).unwrap();
        let clipped = motion.velocity.iter().map(|v| v.clamp(-0.242, 0.242)).collect();
        let (a, b) = (
            motion.interval_acceleration(),
            Motion::from_velocity(motion.dt, clipped, motion.displacement[0]).interval_acceleration(),
        );
        let norm = |signal: &mut dyn Iterator<Item = f64>| signal.map(|x| x * x).sum::<f64>().sqrt();
        let error = norm(&mut a.iter().zip(&b).map(|(a, b)| a - b)) / norm(&mut a.iter().copied());
        assert!((error - want).abs() < 1e-3, "{name}: {error}, expected {want}");
    }
}
