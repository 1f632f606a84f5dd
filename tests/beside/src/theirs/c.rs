//! The same laws in C (`laws.c`). A structure there is an array of its numbers here.
#![allow(unsafe_code, reason = "calls of what was written in C")]

use core::f32::consts::{PI, TAU};

use shakedown_core::blocks::control::LoopGains;
use shakedown_core::blocks::math;

use crate::target::run_one as run;

unsafe extern "C" {
    safe fn nothing_c(law: &f32, state: &mut f32, x: f32) -> f32;
    safe fn displacement_c(law: &[f32; 3], state: &mut [f32; 1], e: f32) -> f32;
    safe fn three_c(law: &[f32; 14], state: &mut [f32; 8], e: f32) -> f32;
    safe fn observer_c(law: &[f32; 5], state: &mut [f32; 4], x: f32) -> f32;
    safe fn section_c(law: &[f32; 6], state: &mut [f32; 3], x: f32) -> f32;
}

/// Measures each; their sums, in the core's order.
pub(crate) fn measure(dt: f32, limit: f32, gains: LoopGains) -> [u32; 4] {
    let (kp, ki) = (gains.proportional, gains.integral);
    let rho = math::exp(-TAU * 0.05 * dt);
    let three_law =
        [kp, ki * dt, limit, kp, ki * dt, dt, limit, kp, ki * dt, dt, rho, 0.5 * (1.0 + rho), limit, 100.0 * limit];
    let (z, y) = (math::exp(-TAU * 2.0 * dt), -math::exp_m1(-TAU * 2.0 * dt));
    let (l1, l2, l3) = (y * (1.0 + z + z * z), 1.5 * y * y * (1.0 + z) / dt, y * y * y / (dt * dt));
    let (r, g) = (2.0 * 0.7, math::tan(PI * 40.0 * dt));
    let c1 = 1.0 / (1.0 + g * (g + r));
    run(8, nothing_c, &0.0, &mut 0.0);
    [
        run(9, displacement_c, &[kp, ki * dt, limit], &mut [0.0; 1]),
        run(10, three_c, &three_law, &mut [0.0; 8]),
        run(11, observer_c, &[dt, 0.5 * dt * dt, l1, l2, l3], &mut [0.0; 4]),
        run(12, section_c, &[c1, g * c1, g * g * c1, 0.0, 0.0, 1.0], &mut [0.0; 3]),
    ]
}
