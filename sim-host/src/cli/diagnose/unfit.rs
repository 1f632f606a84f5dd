//! Recordings that cannot be believed, as they are: no model is held against them.

use super::super::traces::over_time;
use crate::diagnose::Examined;
use crate::identify::data::{Measured, Run};
use crate::report::{Item, Section, Style};

/// Every channel of every run.
pub(super) fn recorded(examined: &Examined) -> Section {
    let drawn = |run: &Run| {
        let curve = |m: &Measured| over_time(run, m, "", vec![("measured", m.values.clone(), Style::Line)]);
        run.measured.iter().filter(|m| m.values.iter().any(|v| v.is_finite())).map(curve).collect::<Vec<_>>()
    };
    let runs = examined.prepared.fit.iter().chain(&examined.prepared.holdout);
    Section { heading: "What was recorded".into(), items: runs.flat_map(drawn).collect::<Vec<Item>>() }
}
