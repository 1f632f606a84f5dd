//! `idsp`'s controller and biquad.

use dsp_process::SplitProcess as _;
use idsp::Build as _;
use idsp::iir::{Biquad, BiquadClamp, DirectForm1, DirectForm2Transposed, pid};
use shakedown_core::blocks::control::LoopGains;

use crate::target::run_one as run;

#[inline(never)]
extern "C" fn controller(law: &BiquadClamp<f32>, state: &mut DirectForm1<f32>, e: f32) -> f32 {
    law.process(state, e)
}

#[inline(never)]
extern "C" fn section(law: &Biquad<f32>, state: &mut DirectForm2Transposed<f32>, x: f32) -> f32 {
    law.process(state, x)
}

/// A low-pass of the core's corner; a step costs the same whatever the coefficients.
pub(crate) const SECTION: [f32; 5] = [0.0126, 0.0253, 0.0126, 1.6564, -0.7069];

/// Measures both.
pub(crate) fn measure(dt: f32, limit: f32, gains: LoopGains) {
    let pid: Biquad<f32> = pid::Builder::default()
        .gain(pid::Action::P, gains.proportional)
        .gain(pid::Action::I, gains.integral)
        .build(&dt);
    let mut pid = BiquadClamp::from(pid);
    (pid.min, pid.max) = (-limit, limit);
    run(17, controller, &pid, &mut DirectForm1::default());
    run(18, section, &Biquad { ba: SECTION }, &mut DirectForm2Transposed::default());
}
