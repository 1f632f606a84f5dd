//! Physics that no library holds: kinds with a name from practice, and kinds built from a grammar.

pub mod grammar;
mod mechanical;
mod signal;

use super::forms::{ACCELEROMETER, ANY, Dial, Needs, SATURATION, SERVO};
use super::law::Place;
use super::plant::Plant;

/// A kind with a name.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// Puts it into a plant.
    pub build: fn(&mut Plant, &Dial),
    /// What it asks for.
    pub needs: Needs,
    /// Listed effects whose physics is truly part of it.
    pub tolerated: &'static [&'static str],
}

const fn kind(name: &'static str, build: fn(&mut Plant, &Dial), needs: Needs) -> Kind {
    Kind { name, build, needs, tolerated: &[] }
}

/// Kinds with a name.
pub const NAMED: &[Kind] = &[
    kind("torque-motor hysteresis", signal::hysteresis, ANY),
    kind("amplifier clips", signal::clipped, ANY),
    kind("amplifier oscillates", signal::oscillating, ANY),
    kind("notched spool", signal::notched, ANY),
    kind("underlapped valve", signal::underlap, ANY),
    kind("command lags while opening", signal::one_sided_lag, ANY),
    kind("gain depends on place", signal::gain_by_place, SERVO),
    kind("pump pulsation", signal::pulsation, SERVO),
    kind("sinking velocity limit", signal::sinking_limit, SATURATION),
    kind("displacement core with play", signal::core_play, ANY),
    kind("ringing accelerometer bracket", signal::bracket, ACCELEROMETER),
    kind("accelerometer hears the command", signal::crosstalk, ACCELEROMETER),
    kind("accelerometer slews", signal::slewing, ACCELEROMETER),
    kind("loose connection", signal::loose, ACCELEROMETER),
    kind("rough patch of the guide", mechanical::rough_patch, ANY),
    kind("ripple per distance", mechanical::ripple, ANY),
    kind("quadratic drag", mechanical::quadratic, ANY),
    kind("guide that binds off its middle", mechanical::binding, ANY),
    Kind {
        tolerated: &["coulomb_friction", "stribeck_friction"],
        ..kind("random break-away", mechanical::random_breakaway, ANY)
    },
    Kind { tolerated: &["payload_resonance"], ..kind("pounding payload", mechanical::pounding, ANY) },
    kind("external shaking", mechanical::external, ANY),
    kind("friction that ages", mechanical::ageing, ANY),
];

/// Kinds from the grammar in a campaign: a third of all.
pub const BUILT: usize = 11;

/// Block at which a law placed there acts.
pub fn block(places: &[Place]) -> &'static str {
    places.first().map_or("unlisted", |place| place.block())
}

#[cfg(test)]
mod tests {
    use super::{BUILT, NAMED, grammar};

    #[test]
    fn there_are_thirty_kinds_and_a_third_is_built() {
        assert!(NAMED.len() + BUILT >= 30 && 3 * BUILT >= NAMED.len() + BUILT);
        let names: std::collections::BTreeSet<_> = NAMED.iter().map(|k| k.name).collect();
        assert_eq!(names.len(), NAMED.len());
    }

    #[test]
    fn a_lock_means_its_kinds_and_another_lock_other_ones() {
        let of = |lock| (0..BUILT).map(|i| grammar::Built::draw(lock, i).name()).collect::<Vec<_>>();
        assert_eq!(of(7), of(7));
        assert_ne!(of(7), of(8));
        let distinct: std::collections::BTreeSet<_> = of(7).into_iter().collect();
        assert!(distinct.len() > BUILT / 2);
    }
}
