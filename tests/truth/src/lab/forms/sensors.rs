//! Sensors. One form each, with the side effects that real conditioners have: slow change, temperature, rounding.

mod bend;
mod hum;
mod lag;
mod scale;
mod tilt;

use super::{ACCELEROMETER, ANY, Dial, Form, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;
pub use bend::Bend;
pub use hum::Hum;
pub use lag::Lag;
pub use scale::Scale;
pub use tilt::Tilt;

fn displacement_lag(plant: &mut Plant, dial: &Dial) -> Parameters {
    let time = 0.3 * dial.s / dial.scales.crossover;
    plant.add(Place::Displacement, Lag { time, second: dial.draw.between(0, 0.05, 0.3), position: true });
    vec![("time", time)]
}

fn acceleration_lag(plant: &mut Plant, dial: &Dial) -> Parameters {
    let time = 0.05 * dial.s;
    plant.add(Place::SensedVelocity, Lag { time, second: dial.draw.between(0, 0.05, 0.3), position: false });
    vec![("time", time)]
}

fn nonlinearity(plant: &mut Plant, dial: &Dial) -> Parameters {
    let cubic = dial.draw.sign * 0.2 * dial.s / dial.scales.stroke.powi(2);
    plant.add(Place::Displacement, Bend { cubic, side: dial.draw.between(0, -0.1, 0.1) * dial.scales.stroke });
    vec![("cubic", cubic)]
}

fn gain(plant: &mut Plant, dial: &Dial) -> Parameters {
    let gain = 1.0 + dial.draw.sign * 0.6 * dial.s;
    let law =
        Scale { gain, offset: 0.0, warming: dial.draw.between(0, -0.05, 0.05) * dial.s, time: dial.scales.duration };
    plant.add(Place::Acceleration, law);
    vec![("gain", gain)]
}

fn bias(plant: &mut Plant, dial: &Dial) -> Parameters {
    let offset = dial.draw.sign * 3.0 * dial.s;
    let law = Scale { gain: 1.0, offset, warming: dial.draw.between(0, -0.1, 0.1), time: dial.scales.duration };
    plant.add(Place::Acceleration, law);
    vec![("offset", offset)]
}

fn tilt(plant: &mut Plant, dial: &Dial) -> Parameters {
    let angle = dial.draw.sign * 0.3 * dial.s / dial.scales.stroke;
    plant.add(Place::Acceleration, Tilt { angle, play: dial.draw.between(0, 0.0, 0.02) * dial.scales.stroke });
    vec![("angle_per_displacement", angle)]
}

fn hum(plant: &mut Plant, dial: &Dial) -> Parameters {
    let frequency = if dial.draw.u[0] < 0.7 { 50.0 } else { 60.0 } + dial.draw.between(1, -0.05, 0.05);
    let law = Hum { frequency, amplitude: 4.0 * dial.s, third: dial.draw.between(2, 0.0, 0.2), breath: 0.1 };
    plant.add(Place::Acceleration, law);
    vec![("frequency", frequency), ("amplitude", law.amplitude)]
}

const CONDITIONER: &str = "conditioner with two poles";

pub(super) const FORMS: &[Form] = &[
    Form { effect: "displacement_lag", name: "two poles", source: CONDITIONER, build: displacement_lag, needs: ANY },
    Form {
        effect: "acceleration_lag",
        name: "two poles",
        source: CONDITIONER,
        build: acceleration_lag,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "displacement_nonlinearity",
        name: "coils past their linear range",
        source: "LVDT: odd saturation about a centre beside the middle",
        build: nonlinearity,
        needs: ANY,
    },
    Form {
        effect: "acceleration_gain",
        name: "gain that warms",
        source: "bridge with temperature",
        build: gain,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "acceleration_bias",
        name: "offset that warms",
        source: "bridge with temperature",
        build: bias,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "tilt_coupling",
        name: "rocking with play",
        source: "guide bearings with clearance",
        build: tilt,
        needs: ACCELEROMETER,
    },
    Form {
        effect: "mains_hum",
        name: "breathing hum",
        source: "mains with third harmonic",
        build: hum,
        needs: ACCELEROMETER,
    },
];
