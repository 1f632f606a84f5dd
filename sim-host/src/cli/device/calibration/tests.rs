use super::*;
use shakedown_firmware::defaults;

/// An LVDT whose positive end is the low code.
fn points() -> Vec<(f64, f64)> {
    vec![(-0.1, 54_000.0), (0.0, 32_700.0), (0.1, 11_430.0)]
}

fn sensor() -> &'static Sensor {
    &SENSORS[0]
}

fn kept(seconds: u64, scale: Scale) -> Kept {
    Kept {
        zero: f64::from(scale.zero),
        per_code: f64::from(scale.per_code),
        nonlinearity: 0.0,
        date: "2026-01-01T00:00:00Z".into(),
        seconds,
        reference: "gauge".into(),
        points: Vec::new(),
    }
}

fn said(seconds: u64, change: f32, now: u64) -> Vec<String> {
    let wiring = defaults::WIRING;
    let changed = |scale: Scale| Scale { per_code: scale.per_code * change, ..scale };
    let file = Calibration {
        displacement: Some(kept(seconds, changed(wiring.displacement))),
        acceleration: Some(kept(seconds, wiring.acceleration)),
    };
    due(Some(&toml::to_string(&file).unwrap()), now, &wiring)
}

#[test]
fn a_line_goes_through_the_points_and_says_how_far_they_lie_from_it() {
    let kept = fitted(sensor(), points(), 65_520, "gauge 7").unwrap();
    // Slope -212,850 codes a metre; the middle lies 10 codes above the mean of the three, the ends 5 below.
    assert!((kept.per_code + 1.0 / 212_850.0).abs() < 1e-15);
    assert!((kept.zero - 32_710.0).abs() < 1e-9);
    assert!((kept.nonlinearity - 10.0 / 212_850.0).abs() < 1e-12);
    assert_eq!(kept.reference, "gauge 7");
}

#[test]
fn a_sensor_that_does_not_move_or_is_at_a_rail_is_refused() {
    let still = vec![(-0.1, 32_700.0), (0.0, 32_701.0), (0.1, 32_699.0)];
    let same = vec![(0.0, 10_000.0), (0.0, 30_000.0), (0.0, 50_000.0)];
    let rail = vec![(-0.1, 3.0), (0.0, 32_700.0), (0.1, 50_000.0)];
    for (points, why) in [(still, "hardly changed"), (same, "hardly changed"), (rail, "at a rail")] {
        let Err(Failure::Work(said)) = fitted(sensor(), points, 65_520, "") else { unreachable!("it was taken") };
        assert!(said.contains(why), "{said}");
    }
}

#[test]
fn a_calibration_holds_for_a_year_and_for_the_setup_in_force() {
    let now = 1_800_000_000;
    assert!(said(now - HOLDS, 1.0, now).is_empty());
    for (seconds, late) in [(now - HOLDS - 1, 2), (now + 1, 2)] {
        let lines = said(seconds, 1.0, now);
        assert_eq!(lines.len(), late);
        assert!(lines.iter().all(|line| line.contains("overdue, of 2026-01-01")), "{lines:?}");
    }
    assert!(said(now, 1.0005, now).is_empty());
    assert_eq!(said(now, 1.01, now), ["displacement: the setup in force has another scale than calibration.toml"]);
    let never = due(None, now, &defaults::WIRING);
    assert!(never.len() == 2 && never.iter().all(|line| line.contains("never calibrated here")), "{never:?}");
    assert!(due(Some("= ="), now, &defaults::WIRING)[0].contains("cannot be read"));
}
