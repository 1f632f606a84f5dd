use crate::diagnose::{Diagnosis, Options, diagnose_file};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::fmt::Write as _;
use tempfile::TempDir;

const RATE: f64 = 200.0;
const SECONDS: f64 = 16.0;
/// Pressure per acceleration, in the recording's unit.
const SCALE: f64 = 0.2;
/// Travel over which the contact bends, m.
const PRESLIDING: f64 = 5e-5;

/// A table's pressure with dry friction (m/s2) as bristles bend, diagnosed with 1.00 +/- 0.05 m/s2 stated of an earlier
/// recording.
fn diagnosed(friction: f64, noise: f64) -> Diagnosis {
    let folder = TempDir::new().unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0;
    let lines = [(0.5, 0.02, 0.3), (1.3, 0.008, 1.1), (2.9, 0.003, 2.0), (6.1, 0.0006, 0.7)];
    let (mut share, mut before) = (0.0, None);
    let mut rows = String::from("time,displacement,acceleration,pressure\n");
    for k in 0..(RATE * SECONDS) as usize {
        let t = k as f64 / RATE;
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| {
            lines.iter().map(|&(f, a, p)| of(std::f64::consts::TAU * f, a, p)).sum::<f64>()
        };
        let x = sum(&|w, a, p| a * (w * t + p).sin());
        let acceleration = sum(&|w, a, p| -a * w * w * (w * t + p).sin());
        let travel: f64 = x - before.replace(x).unwrap_or(x);
        share = travel.signum() + (share - travel.signum()) * (-travel.abs() / PRESLIDING).exp();
        let p = SCALE * (acceleration + friction * share) + noise * normal();
        let (x, a) = (x + 1e-6 * normal(), acceleration + 0.005 * normal());
        let _ = writeln!(rows, "{t:.4},{x:.8},{a:.5},{p:.6}");
    }
    std::fs::write(folder.path().join("run.csv"), rows).unwrap();
    let experiment = "[model]\nkind = \"force-balance\"\nviscous = 0.0\nbandwidth_hz = 40.0\n\
         scale = { value = 0.2, std = 0.002 }\neffects = [\"coulomb_friction\"]\nfit = [\"coulomb_friction\"]\n\
         [effects.coulomb_friction]\nforce = { value = 1.0, std = 0.05 }\npresliding = 5e-5\n\
         [channels]\ntime = { column = \"time\", unit = \"s\" }\n\
         displacement = { column = \"displacement\", unit = \"m\" }\n\
         acceleration = { column = \"acceleration\", unit = \"m/s2\" }\n\
         pressure_difference = { column = \"pressure\", unit = \"1\" }\n[[runs]]\nfile = \"run.csv\"\n";
    let path = folder.path().join("experiment.toml");
    std::fs::write(&path, experiment).unwrap();
    diagnose_file(&path, &Options::default()).unwrap()
}

fn moved(diagnosis: &Diagnosis) -> Vec<(Option<String>, f64)> {
    diagnosis.set_up.iter().filter(|f| f.parameter.is_some()).map(|f| (f.parameter.clone(), f.found)).collect()
}

#[test]
fn a_friction_that_grew_since_it_was_determined_is_reported() {
    let found = moved(&diagnosed(1.6, 0.003));
    let force = found.iter().find(|(name, _)| name.as_deref() == Some("coulomb_friction.force"));
    let force = force.unwrap_or_else(|| panic!("{found:?}")).1;
    assert!((force / 1.6 - 1.0).abs() < 0.1, "{force}");
}

#[test]
fn a_friction_that_is_as_it_was_is_not() {
    for friction in [1.0, 0.95, 1.08] {
        let found = moved(&diagnosed(friction, 0.003));
        assert!(found.is_empty(), "{friction}: {found:?}");
    }
}
