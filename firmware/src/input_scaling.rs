//! The wiring worked out: what a tick needs to turn codes into SI, and nothing that it would have to look up.

use shakedown_core::Mode;
use shakedown_core::link::{Scale, Setup, Source};
use shakedown_rehearsal::Inputs;

use crate::output::Output;

/// The wiring worked out, and what of it the mode reads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InputScaling {
    /// The lowest code that is a reading, and how far above it the highest lies.
    low: u32,
    span: u32,
    pub(crate) displacement: Scale,
    pub(crate) acceleration: Scale,
    pub(crate) external: Scale,
    pub(crate) reference: Scale,
    pub(crate) output: Output,
    /// Whether the reference comes over the link.
    pub(crate) streamed: bool,
    /// Whether the existing command is read.
    pub(crate) guards: bool,
    /// Whether a simulated table takes the place of the converters.
    pub(crate) rehearses: bool,
}

impl InputScaling {
    /// The wires of `setup`.
    pub(crate) fn new(setup: &Setup) -> Self {
        let wiring = &setup.wiring;
        let (full, margin) = (u32::from(wiring.full_scale), u32::from(wiring.margin()));
        let span = if margin > 0 { full.saturating_sub(2 * margin) } else { u32::from(u16::MAX) };
        Self {
            low: margin,
            span,
            displacement: wiring.displacement,
            acceleration: wiring.acceleration,
            external: wiring.external,
            reference: wiring.reference,
            output: Output::new(wiring),
            streamed: wiring.source.streamed(),
            guards: setup.control.mode == Mode::Guard,
            rehearses: wiring.source == Source::Rehearsal,
        }
    }

    /// Whether the codes mean the same under both, whatever the mode reads of them.
    pub(crate) fn same_board(&self, other: &Self) -> bool {
        Self { guards: other.guards, ..*self } == *other
    }

    /// The inputs' scales, for a simulated table.
    pub(crate) const fn inputs(&self) -> Inputs {
        Inputs {
            reference: self.reference,
            displacement: self.displacement,
            acceleration: self.acceleration,
            external: self.external,
            full_scale: self.output.full_scale(),
        }
    }

    /// Whether `code` tells anything.
    #[inline(always)]
    fn tells(&self, code: u16) -> bool {
        u32::from(code).wrapping_sub(self.low) <= self.span
    }

    /// What `code` stands for; no number where it tells nothing.
    #[inline]
    pub(crate) fn read(&self, scale: Scale, code: u16) -> f32 {
        if self.tells(code) { scale.to_si(code) } else { f32::NAN }
    }
}
