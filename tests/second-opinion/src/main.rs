//! The firmware's [`ControlLoop`] with pipes for converters, by semihosting.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod pipe;

#[cfg(target_os = "none")]
mod target {
    use shakedown_core::link::Setup;
    use shakedown_firmware::ControlLoop;
    use shakedown_firmware::queues::{LoopCommand, LoopEnd, Point, Queues};
    use shakedown_second_opinion::{Done, FROM_DEVICE, Given, SETUP, TO_DEVICE};

    use super::pipe::{Pipe, exit};

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        exit(false)
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        // Not on the stack, which is smaller.
        static mut QUEUES: Queues = Queues::new();
        exit(run(QUEUES).is_some())
    }

    /// The loop where it stays, by a function of its own: what it needs of the stack the rest need not have free.
    #[inline(never)]
    fn placed(setup: &Setup, queues: LoopEnd<'static>) -> Option<&'static mut ControlLoop<'static>> {
        cortex_m::singleton!(: ControlLoop<'static> = ControlLoop::wired(setup, queues))
    }

    /// Until the other end closes the pipe. None: it never got as far as a tick.
    fn run(queues: &'static mut Queues) -> Option<()> {
        let (input, output) = (Pipe::reading(TO_DEVICE)?, Pipe::writing(FROM_DEVICE)?);
        let mut bytes = [0; SETUP];
        input.read(&mut bytes)?;
        let (setup, _) = postcard::take_from_bytes::<Setup>(&bytes).ok()?;
        let (loop_end, mut server) = queues.split();
        let decide = placed(&setup, loop_end)?;
        decide.begin(&setup, false).ok()?;
        let mut bytes = [0; Given::LENGTH];
        while input.read(&mut bytes).is_some() {
            let given = Given::from_bytes(bytes);
            if let Some(request) = given.request {
                server.orders.enqueue(LoopCommand::Ask(request)).ok()?;
            }
            if let Some(point) = given.point {
                server.points.enqueue(Point::new(point).unwrap_or(Point::END)).ok()?;
            }
            let outcome = decide.tick(|input| given.inputs.get(input).copied().unwrap_or_default());
            while server.records.dequeue().is_some() {}
            output.write(&Done { output: outcome.output, relay: decide.relay() }.to_bytes())?;
        }
        Some(())
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
