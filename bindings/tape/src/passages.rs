//! What the tape goes through: twenty-four passages of 2.5 s, each with settings of its own, as a person would write them.

/// A passage.
#[derive(Debug, Clone)]
pub struct Passage {
    /// What it is for.
    pub name: &'static str,
    /// Its settings.
    pub settings: String,
    /// Whether the controller begins anew; else the one there is gets these settings.
    pub anew: bool,
    /// What is made to go wrong in it.
    pub mishap: Mishap,
    /// Settings that are refused in its midst.
    pub refused: &'static str,
}

/// What goes wrong, 1.9 s into the passage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mishap {
    /// The LVDT reads no number for 40 ms.
    LvdtLost,
    /// The LVDT stands for 100 ms.
    LvdtStuck,
    /// The accelerometer jumps by 40 m/s2 for 30 ms.
    AccelerationJumps,
    /// The accelerometer stands for 400 ms.
    AccelerationStuck,
    /// The valve stays where it is, open.
    ValveStuck,
    /// The reference jumps by half a metre.
    ReferenceJumps,
    /// A limit switch closes.
    LimitSwitch,
    /// The second displacement sensor drifts away.
    SensorsDisagree,
    /// The relay's contact reads the opposite.
    RelayAstray,
    /// The operator trips.
    Operator,
    /// The pressure reads much too high.
    Pressure,
    /// The LVDT is noisy.
    Noisy,
}

/// A test of 0.2 s ramps, told of saturation, its state watched.
const GUARD: &str = "
[saturation]
[guard]
envelope.velocity = 0.5
ramps.test = 0.2
ramps.safe = 0.05 # short, for a short tape
";
/// More, to mind only sensors that are lost and a table that leaves its stroke.
const LENIENT: &str = "
envelope.acceleration = 1e4
envelope.jerk = 1e7
plausibility.acceleration_noise = 1e3
plausibility.disagreement = 1.0
plausibility.offset = 1e3
valve.mismatch = 1
";
/// The tracking law with every part.
const FULL: &str = "
[tracking]
delay = 0.003
flow.sharpness = 3.0
flow.droop = 0.3
flow.recovery = 2.0
flow.stall = 30.0
friction.coulomb = 0.3
friction.viscous = 1.0
friction.velocity = 0.01
friction.deadband = 0.002
[tracking.oil]
frequency = 12.0
damping = 0.05
[tracking.pressure]
area_per_mass = 5e-6
gain = 0.005
corner = 0.5
[tracking.notch]
frequency = 30.0
damping = 0.2
";
/// Gains of the guarded controller, and of all three loops.
const GAINS: &str = "displacement.proportional = 6.0\ndisplacement.integral = 2.0\n";
const LOOPS: &str = "
anti_windup = true
displacement.proportional = 4.0
displacement.integral = 3.0
velocity.proportional = 0.6
velocity.integral = 0.4
acceleration.proportional = 0.05
acceleration.integral = 0.02
";

/// Settings that are refused, each for another reason.
const REFUSED: [&str; 6] = [
    "rate = 49.0\n",
    "acceleration.proportional = 1.0\nobserver.accelerometer = false\n",
    "rate = 1000.0\nno_such_setting = 1.0\n",
    "mode = \"valve\"\n",
    "[tracking.oil]\nfrequency = 12.0 # and no damping\n",
    "velocity_limit = nan\n",
];

/// All of them, in their order.
pub fn passages() -> Vec<Passage> {
    let guarded = |more: &str| format!("{GAINS}{more}{GUARD}");
    let loops = |more: &str| format!("{LOOPS}{more}{GUARD}");
    let tracking = |more: &str, law: &str| format!("{GAINS}{more}{GUARD}{LENIENT}{law}");
    let bare = |more: &str| format!("{GAINS}{more}");
    let force = "envelope.force.limit = 3e4\nenvelope.force.piston_area = 0.01\n";
    let inputs = |more: &str| format!("{GAINS}{GUARD}{LENIENT}witness.bias = 5.0\n[guard.inputs]\n{more}\n");
    let all = [
        ("controller", guarded(""), Mishap::Operator),
        ("guard", guarded("mode = \"guard\"\n"), Mishap::ValveStuck),
        ("modifier", guarded("mode = \"modifier\"\n"), Mishap::LvdtLost),
        ("three loops", loops(""), Mishap::LvdtStuck),
        ("tracking", tracking("", "[tracking]\n"), Mishap::ReferenceJumps),
        ("tracking, every part", tracking("", FULL), Mishap::LvdtLost),
        ("clip", guarded("modification = \"clip\"\nvelocity_limit = 0.15\n"), Mishap::AccelerationJumps),
        ("causal", tracking("modification = \"causal\"\nvelocity_limit = 0.15\n", "[tracking]\n"), Mishap::Operator),
        ("preview", tracking("modification.preview.seconds = 0.1\n", "[tracking]\n"), Mishap::ReferenceJumps),
        ("clip in front", guarded("mode = \"modifier\"\nmodification = \"clip\"\n"), Mishap::Noisy),
        ("causal in front", guarded("mode = \"modifier\"\nmodification = \"causal\"\n"), Mishap::Operator),
        ("preview in front", guarded("mode = \"modifier\"\nmodification.preview.seconds = 0.2\n"), Mishap::LvdtLost),
        ("derived rates", loops("reference_rates.derived.frequency = 40.0\n"), Mishap::AccelerationStuck),
        ("supplied rates", loops("reference_rates = \"supplied\"\n"), Mishap::ReferenceJumps),
        (
            "no rates",
            loops("reference_rates = \"zero\"\n") + "envelope.acceleration = 15.0\n",
            Mishap::AccelerationJumps,
        ),
        (
            "velocity sensor",
            loops("velocity_source = \"sensor\"\n") + "envelope.jerk = 600.0\n",
            Mishap::AccelerationJumps,
        ),
        ("hard-wired", guarded("inner_loop = \"hardwired\"\nblend = 0\n"), Mishap::LvdtStuck),
        (
            "biased and limited",
            guarded("valve.null_bias = 0.004\nvalve.command_limit = 0.12\n") + LENIENT,
            Mishap::Noisy,
        ),
        ("force", guarded("") + force, Mishap::Pressure),
        ("second sensor", inputs("second_displacement = 0.004"), Mishap::SensorsDisagree),
        ("limit switch", inputs("limit_switches = true"), Mishap::LimitSwitch),
        ("relay", inputs("relay_feedback = 0.03"), Mishap::RelayAstray),
        ("bare", bare(""), Mishap::AccelerationJumps),
        ("bare, tracking", bare("anti_windup = true\n") + FULL, Mishap::LvdtLost),
    ];
    let refused = REFUSED.iter().cycle();
    let passages = all.into_iter().zip(refused).enumerate();
    passages
        .map(|(place, ((name, settings, mishap), refused))| Passage {
            name,
            settings,
            anew: place % 3 != 1,
            mishap,
            refused,
        })
        .collect()
}
