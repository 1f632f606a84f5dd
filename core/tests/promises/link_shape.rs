//! The link's frames have the shape that their version had when it was written down: names, types and order of all fields
//! and variants, which is what postcard's bytes depend on.
//!
//! `UPDATE_GOLDEN=1 cargo test -p shakedown-core --test promises link_shape` writes the shape of a new version down, and
//! never another shape for a version that has one.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde_reflection::{Samples, Tracer, TracerConfig};
use shakedown_core::link::{Clock, HostRequest, OptionPurpose, RefusedBecause, Report, Source, StopCause, VERSION};
use shakedown_core::settings::{InnerLoop, ReferenceRates, VelocitySource};
use shakedown_core::{Mode, Modification, State, Trip};

/// One line a type: its name, and every field or variant in order.
fn shape() -> String {
    let mut tracer = Tracer::new(TracerConfig::default());
    let samples = Samples::new();
    macro_rules! trace {
        ($($kind:ty),*) => { $(tracer.trace_type::<$kind>(&samples).unwrap();)* };
    }
    // A type's own enums come first: one hidden in a field is seen with its first variant alone.
    trace!(State, Trip, StopCause, Clock, OptionPurpose, RefusedBecause, Source);
    trace!(Mode, InnerLoop, Modification, ReferenceRates, VelocitySource, HostRequest, Report);
    let registry = tracer.registry().unwrap();
    registry.iter().fold(String::new(), |mut text, (name, format)| {
        let _ = writeln!(text, "{name}: {format:?}");
        text
    })
}

fn golden() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/link-{VERSION}.txt"))
}

#[test]
fn frames_have_the_shape_that_their_version_says() {
    let shape = shape();
    if std::env::var_os("UPDATE_GOLDEN").is_some() && !golden().exists() {
        std::fs::write(golden(), &shape).unwrap();
    }
    let written = std::fs::read_to_string(golden()).unwrap_or_default();
    let changed: Vec<&str> = shape.lines().filter(|line| !written.lines().any(|old| old == *line)).collect();
    assert!(
        shape == written,
        "frames are no longer those of version {VERSION}; count `link::VERSION` up and write the new shape down:\n{changed:#?}"
    );
}
