//! States and causes in the log, by name: the names stay on the host, and the device sends their numbers.

use defmt::{Format, Formatter, write};
use shakedown_core::link::StopCause;
use shakedown_core::{State, Trip};

use crate::queues::TestStatus;

impl Format for TestStatus {
    fn format(&self, to: Formatter<'_>) {
        state(to, self.state);
        if let Some(because) = self.cause {
            cause(to, because);
        }
    }
}

fn state(to: Formatter<'_>, state: State) {
    match state {
        State::Off => write!(to, "off"),
        State::Ready => write!(to, "ready"),
        State::Running => write!(to, "running"),
        State::Hold => write!(to, "hold"),
        State::RampDown => write!(to, "ramping down"),
        State::Tripped => write!(to, "tripped"),
    }
}

fn cause(to: Formatter<'_>, cause: StopCause) {
    match cause {
        StopCause::EmergencyStop => write!(to, ": emergency stop"),
        StopCause::Overrun => write!(to, ": tick overrun"),
        StopCause::Underrun => write!(to, ": reference ran dry"),
        StopCause::SupplyLow => write!(to, ": supply low"),
        StopCause::Restarted => write!(to, ": restarted after a failure"),
        StopCause::Asked => write!(to, ": asked for"),
        StopCause::HostSilent => write!(to, ": host silent"),
        StopCause::Guard(by) => trip(to, by),
    }
}

fn trip(to: Formatter<'_>, trip: Trip) {
    match trip {
        Trip::Displacement => write!(to, ": displacement"),
        Trip::Velocity => write!(to, ": velocity"),
        Trip::Acceleration => write!(to, ": acceleration"),
        Trip::Jerk => write!(to, ": jerk"),
        Trip::Force => write!(to, ": force"),
        Trip::Tracking => write!(to, ": tracking"),
        Trip::SensorLost => write!(to, ": sensor lost"),
        Trip::DisplacementStuck => write!(to, ": displacement stuck"),
        Trip::AccelerationStuck => write!(to, ": acceleration stuck"),
        Trip::SensorsDisagree => write!(to, ": sensors disagree"),
        Trip::DisplacementNoisy => write!(to, ": displacement noisy"),
        Trip::AccelerationNoisy => write!(to, ": acceleration noisy"),
        Trip::ValveStuck => write!(to, ": valve stuck"),
        Trip::LimitSwitch => write!(to, ": limit switch"),
        Trip::RelayAstray => write!(to, ": relay astray"),
        // Of a later core: its number.
        other => write!(to, ": trip {=u8}", other as u8),
    }
}
