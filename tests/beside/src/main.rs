//! Steps of the core's laws, of the same laws in C and of `idsp`'s, one after the other, over the same errors. `cargo xtask
//! beside` runs this on the emulated processor, which counts the instructions between the marks that it leaves.
//!
//! Every step is a function of its own that takes its configuration, its state and an input, so that each pays for one
//! call, and none of them is looked through. The guard and its anti-windup are no part of this: the direction in which an
//! integrator may not go is known to be neither.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod step;
#[cfg(target_os = "none")]
mod theirs;

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "the marks, and calls of what was written in C")]
mod target {
    use core::hint::black_box;

    use shakedown_core::blocks::Block;
    use shakedown_core::blocks::control::{
        AccelerationLoop, AccelerationState, Blocked, DisplacementLoop, DisplacementState, LoopGains, VelocityLoop,
        VelocityState,
    };
    use shakedown_core::blocks::filter::{MotionObserver, MotionState, SecondOrder, SecondOrderState};

    use super::theirs;

    /// The converter's data register: a write to it is a mark.
    const MARK: *mut u32 = 0x4000_7408 as *mut u32;
    /// Marks the begin of a measurement's steps, with its number, and their end.
    pub(super) const BEGIN: u32 = 0x100;
    pub(super) const END: u32 = 0x200;
    /// Marks a difference between the core's bits and those in C.
    const DIFFERENT: u32 = 0x300;
    const DONE: u32 = 0xFFF;
    /// Steps of a measurement; the reader divides by it.
    const STEPS: u16 = 256;

    const DT: f32 = 1e-3;
    const LIMIT: f32 = 0.05;
    const GAINS: LoopGains = LoopGains { proportional: 3.702_05, integral: 0.617_01 };

    pub(super) fn mark(value: u32) {
        // SAFETY: a device register; the write is the message.
        unsafe { MARK.write_volatile(value) }
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        mark(DIFFERENT);
        mark(DONE);
        loop {
            cortex_m::asm::nop();
        }
    }

    /// A step: configuration, state, input; the output.
    type Step<C, S> = extern "C" fn(&C, &mut S, f32) -> f32;

    /// Three variables: displacement, velocity, acceleration.
    struct Three(DisplacementLoop, VelocityLoop, AccelerationLoop);
    type ThreeState = (DisplacementState, VelocityState, AccelerationState);

    #[inline(never)]
    extern "C" fn nothing(_: &f32, _: &mut f32, x: f32) -> f32 {
        x
    }

    #[inline(never)]
    extern "C" fn displacement(law: &DisplacementLoop, state: &mut DisplacementState, e: f32) -> f32 {
        law.advance(state, e, Blocked::Neither)
    }

    #[inline(never)]
    extern "C" fn three(law: &Three, state: &mut ThreeState, e: f32) -> f32 {
        let mut command = law.0.advance(&mut state.0, e, Blocked::Neither);
        command += law.1.advance(&mut state.1, 0.5 * e, Blocked::Neither);
        command + law.2.advance(&mut state.2, 2.0 * e, Blocked::Neither)
    }

    #[inline(never)]
    extern "C" fn observer(law: &MotionObserver, state: &mut MotionState, x: f32) -> f32 {
        law.advance(state, x, x);
        state.velocity
    }

    #[inline(never)]
    extern "C" fn section(law: &SecondOrder, state: &mut SecondOrderState, x: f32) -> f32 {
        law.advance(state, x)
    }

    /// Five products, two states, summed in the order of `idsp`'s biquad and written as the core writes its blocks. The core
    /// has none, for what its [`SecondOrder`] documents.
    struct DirectForm {
        b: [f32; 3],
        a: [f32; 2],
    }

    impl Block for DirectForm {
        type State = [f32; 2];

        #[inline]
        fn advance(&self, state: &mut [f32; 2], x: f32) -> f32 {
            let y = state[0] + self.b[0] * x;
            state[0] = state[1] + self.b[1] * x + self.a[0] * y;
            state[1] = self.b[2] * x + self.a[1] * y;
            y
        }

        #[inline]
        fn last(&self, state: &[f32; 2]) -> f32 {
            state[0]
        }
    }

    #[inline(never)]
    extern "C" fn direct(law: &DirectForm, state: &mut [f32; 2], x: f32) -> f32 {
        law.advance(state, x)
    }

    /// A step whose configuration and state are not looked at.
    type AnyStep = unsafe extern "C" fn(*const (), *mut (), f32) -> f32;

    /// Runs the steps between two marks; gives a sum over the outputs' bits.
    fn measure<C, S>(number: u32, step: Step<C, S>, law: &C, state: &mut S) -> u32 {
        // SAFETY: a reference is passed as a pointer is, and the step is called with what it was written for.
        unsafe {
            let step = core::mem::transmute::<Step<C, S>, AnyStep>(step);
            steps(number, step, core::ptr::from_ref(law).cast(), core::ptr::from_mut(state).cast())
        }
    }

    /// One loop for every step: what the compiler makes of it costs each the same.
    #[inline(never)]
    unsafe fn steps(number: u32, step: AnyStep, law: *const (), state: *mut ()) -> u32 {
        let mut sum = 0u32;
        mark(BEGIN | number);
        for k in 0..STEPS {
            let x = f32::from(k % 23) * 0.01 - 0.1;
            // SAFETY: the caller's.
            sum = sum.rotate_left(1) ^ unsafe { step(black_box(law), black_box(state), x) }.to_bits();
        }
        mark(END | number);
        sum
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        run();
        mark(DONE);
        loop {
            cortex_m::asm::nop();
        }
    }

    fn run() {
        let displacement_loop = DisplacementLoop::new(GAINS, DT, LIMIT);
        let velocity_loop = VelocityLoop::new(GAINS, DT, LIMIT);
        let Ok(acceleration_loop) = AccelerationLoop::new(GAINS, DT, 0.05, LIMIT) else { return mark(DIFFERENT) };
        let law = Three(displacement_loop, velocity_loop, acceleration_loop);
        let (Ok(fusion), Ok(low_pass)) = (MotionObserver::crossover(2.0, DT), SecondOrder::low_pass(40.0, 0.7, DT))
        else {
            return mark(DIFFERENT);
        };
        measure(0, nothing, &0.0, &mut 0.0);
        let ours = [
            measure(1, displacement, &law.0, &mut DisplacementState::default()),
            measure(2, three, &law, &mut ThreeState::default()),
            measure(3, observer, &fusion, &mut MotionState::default()),
            measure(4, section, &low_pass, &mut SecondOrderState::default()),
        ];
        #[cfg(feature = "c")]
        if ours != theirs::c::measure(DT, LIMIT, GAINS) {
            mark(DIFFERENT);
        }
        let [b0, b1, b2, a1, a2] = theirs::idsp::SECTION;
        let direct_form = DirectForm { b: [b0, b1, b2], a: [a1, a2] };
        let _ = black_box((ours, measure(5, direct, &direct_form, &mut [0.0; 2])));
        theirs::idsp::measure(DT, LIMIT, GAINS);
        super::step::measure();
    }

    pub(super) fn run_one<C, S>(number: u32, step: Step<C, S>, law: &C, state: &mut S) -> u32 {
        measure(number, step, law, state)
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
