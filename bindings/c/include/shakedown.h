// The control core of shakedown: one sample in, one command out. SI units. See docs/hosts.md.
//
// Written by cbindgen from bindings/c/src: `cargo xtask header` writes it anew, `cargo xtask header check` compares.
// No allocation, no operating system, no global state. Not for use from two threads at a time on the same controller.

#ifndef SHAKEDOWN_H
#define SHAKEDOWN_H

#include <float.h>
#include <stddef.h>
#include <stdint.h>

#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD == 1 || FLT_EVAL_METHOD == 2)
#error "this compiler computes float expressions in a wider type: the samples would not be those of other hosts"
#endif

// The version of this interface: the header's, and that of the library by `shakedown_abi`.
#define SHAKEDOWN_ABI 1

// Bytes of a controller's storage, some of them to spare.
#define SHAKEDOWN_SIZE 4096

// Bytes of a field's name in `shakedown_fault_t`, the closing zero included.
#define SHAKEDOWN_NAME 64

// Behind an existing controller: passes its command on, detects saturation, enforces limits.
#define SHAKEDOWN_MODE_GUARD 0

// In front of an existing controller: reference in, reference that the table can follow out.
#define SHAKEDOWN_MODE_MODIFIER 1

// Instead of one: reference and sensors in, valve command out.
#define SHAKEDOWN_MODE_CONTROLLER 2

// Nothing stands between the output and the valve.
#define SHAKEDOWN_INNER_LOOP_ABSENT 0

// A controller with unity proportional gain that subtracts the LVDT from the output.
#define SHAKEDOWN_INNER_LOOP_HARDWIRED 1

// The reference is not modified.
#define SHAKEDOWN_MODIFICATION_OFF 0

// Velocity clipped, then integrated; drifts.
#define SHAKEDOWN_MODIFICATION_CLIP 1

// Inside velocity and stroke, without drift and without preview.
#define SHAKEDOWN_MODIFICATION_CAUSAL 2

// The same with preview: `preview_seconds`.
#define SHAKEDOWN_MODIFICATION_PREVIEW 3

// Backward differences of the modified reference.
#define SHAKEDOWN_RATES_DIFFERENCES 0

// Differentiated within a band: `rates_frequency`.
#define SHAKEDOWN_RATES_DERIVED 1

// With each sample.
#define SHAKEDOWN_RATES_SUPPLIED 2

// Zero: pure feedback.
#define SHAKEDOWN_RATES_ZERO 3

// The table's velocity is the observer's.
#define SHAKEDOWN_VELOCITY_SOURCE_OBSERVER 0

// The table's velocity is a sensor's.
#define SHAKEDOWN_VELOCITY_SOURCE_SENSOR 1

// Off to ready.
#define SHAKEDOWN_REQUEST_ARM 0

// Ready to running.
#define SHAKEDOWN_REQUEST_START 1

// Running to hold.
#define SHAKEDOWN_REQUEST_HOLD 2

// Hold to running.
#define SHAKEDOWN_REQUEST_RESUME 3

// Running or hold to ready, by way of a ramp.
#define SHAKEDOWN_REQUEST_STOP 4

// Ready to off.
#define SHAKEDOWN_REQUEST_OFF 5

// Tripped to off: the deliberate act without which a trip stands.
#define SHAKEDOWN_REQUEST_RESET 6

// Anything to tripped, for what only the board can see.
#define SHAKEDOWN_REQUEST_TRIP 7

// Relay open, no flow asked for.
#define SHAKEDOWN_STATE_OFF 0

// Relay closed, the table held where it stood.
#define SHAKEDOWN_STATE_READY 1

// The test runs.
#define SHAKEDOWN_STATE_RUNNING 2

// The test is faded out and the table held.
#define SHAKEDOWN_STATE_HOLD 3

// On the way to a stand, then ready.
#define SHAKEDOWN_STATE_RAMP_DOWN 4

// No flow asked for; relay open.
#define SHAKEDOWN_STATE_TRIPPED 5

// It was done.
#define SHAKEDOWN_OK 0

// A setting is not a number, or outside its range.
#define SHAKEDOWN_OUT_OF_RANGE 1

// Two settings contradict each other.
#define SHAKEDOWN_CONTRADICTION 2

// A setting is within its own range, but not with the others.
#define SHAKEDOWN_CONFLICT 3

// The request does not apply in this state.
#define SHAKEDOWN_REFUSED_STATE 4

// The safe ramp after the trip has not ended.
#define SHAKEDOWN_REFUSED_MOVING 5

// The guard sees a reason to trip already.
#define SHAKEDOWN_REFUSED_CAUSE 6

// There is no guard, and so nothing to ask.
#define SHAKEDOWN_REFUSED_NO_GUARD 7

// There is no setting of this name.
#define SHAKEDOWN_UNKNOWN_NAME 8

// The value is not of the setting's kind, or no number of the enum's.
#define SHAKEDOWN_WRONG_VALUE 9

// There is no request of this number.
#define SHAKEDOWN_UNKNOWN_REQUEST 10

// A pointer is null.
#define SHAKEDOWN_NULL 11

// A pointer is not aligned for its type.
#define SHAKEDOWN_MISALIGNED 12

// The storage is too small.
#define SHAKEDOWN_TOO_SMALL 13

// The storage holds no controller: `shakedown_init` was not called, or refused.
#define SHAKEDOWN_UNINITIALISED 14

// A text is not UTF-8.
#define SHAKEDOWN_NO_TEXT 15

// Proportional and integral gain of one feedback loop of Fig. 12.
typedef struct {
    // Proportional gain, 1.
    float proportional;
    // Integral gain, 1/s.
    float integral;
} shakedown_gains_t;

// The observer of the table's velocity.
typedef struct {
    // Below this the LVDT is believed, above it the accelerometer, Hz.
    float frequency;
    // Whether an accelerometer is fitted; without one `acceleration` is not read. 0 is no.
    uint8_t accelerometer;
    // Time constant of the low-pass on the acceleration that saturation detection and guard look at, s.
    float smoothing;
} shakedown_observer_t;

// What is known of the servovalve and its actuator, for what must know how the table will answer.
typedef struct {
    // Velocity per command at rest, 1/s: b0 / a1 of Eq. 7.
    float gain;
    // Time constant of the velocity, s: 1 / a1 of Eq. 7.
    float lag;
    // Command at which no oil flows, m, beside what the inner loop asks for.
    float null_bias;
    // Largest command either way, beyond the one at which no oil flows, m.
    float command_limit;
} shakedown_valve_t;

// Largest readings that can be true, either way from zero. A reading beyond is not used: the last good output is held.
typedef struct {
    // Reference displacement, m.
    float reference;
    // LVDT, m.
    float displacement;
    // Velocity sensor and supplied reference velocity, m/s.
    float velocity;
    // Accelerometer and supplied reference acceleration, m/s2.
    float acceleration;
    // Existing controller's command, m.
    float external;
    // Pressure difference, Pa.
    float pressure_difference;
} shakedown_ranges_t;

// Noise of the sensors at each tick, standard deviations: what weighs them against each other.
typedef struct {
    // LVDT, m; a step's is the step over the root of 12.
    float displacement;
    // Accelerometer, m/s2; without one, the accelerations to expect.
    float acceleration;
} shakedown_noise_t;

// What is known of the flow beyond gain and limit. Zeros switch off.
typedef struct {
    // Velocity limit toward negative displacement over the one toward positive, 1.
    float asymmetry;
    // Sharpness n of a soft limit, 1; 0 for a hard one.
    float sharpness;
    // Force per table mass at which the flow stalls, m/s2; 0 for a flow that no load slows.
    float stall;
    // Relative supply pressure lost under sustained motion at the velocity limit, 1.
    float droop;
    // Time constant with which the supply recovers, s.
    float recovery;
    // How far beyond the limit the valve may be opened, as a multiple of it, 1.
    float overdrive;
} shakedown_flow_t;

// What is known of friction and overlap. Zeros switch off.
typedef struct {
    // Coulomb friction per table mass, m/s2.
    float coulomb;
    // Viscous friction per table mass, 1/s.
    float viscous;
    // Velocity at which the Coulomb friction is whole, m/s.
    float velocity;
    // Command on either side of zero that opens nothing, m.
    float deadband;
} shakedown_friction_t;

// The table's mode on its oil column.
typedef struct {
    // Natural frequency, Hz.
    float frequency;
    // Damping ratio, 1.
    float damping;
} shakedown_oil_t;

// What is known of the sensor and wanted of the damping.
typedef struct {
    // Piston area over moving mass, m2/kg.
    float area_per_mass;
    // Velocity taken off per acceleration of the load, s.
    float gain;
    // Corner below which a load is left alone, Hz.
    float corner;
} shakedown_pressure_t;

// A notch in the feedback, for a mode that it must leave alone.
typedef struct {
    // Hz.
    float frequency;
    // Half its width over its frequency, 1.
    float damping;
} shakedown_notch_t;

// Everything that is set of the tracking law beside the valve's gain, lag and null.
typedef struct {
    // Bandwidth of the feedback, Hz.
    float bandwidth;
    // Below this what the model lacks is corrected, Hz.
    float disturbance;
    // From command to flow beyond the valve's lag, s.
    float delay;
    // Lead of the valve, s: b1 / b0 of Eq. 7.
    float lead;
    // Between the points of the reference that its rates are taken from, s.
    float spacing;
    // Noise of the sensors.
    shakedown_noise_t noise;
    // Flow map.
    shakedown_flow_t flow;
    // Friction and overlap.
    shakedown_friction_t friction;
    // Mode of the oil column; none where it is too stiff to matter.
    shakedown_oil_t oil;
    // Whether there is `oil`; 0 is no.
    uint8_t has_oil;
    // Damping by the pressure difference; none without a sensor.
    shakedown_pressure_t pressure;
    // Whether there is `pressure`; 0 is no.
    uint8_t has_pressure;
    // Notch in the feedback.
    shakedown_notch_t notch;
    // Whether there is `notch`; 0 is no.
    uint8_t has_notch;
} shakedown_tracking_t;

// How saturation is looked for.
typedef struct {
    // Acceleration below which a table is held to move at constant speed, m/s2; a few times the sensor's noise.
    float plateau;
    // Error below which nothing is asked for, m.
    float error;
    // By how much the speed asked for must exceed the speed had, 1.
    float shortfall;
    // Smallest limit that is thought possible, as a share of the set one, 1.
    float floor;
    // How long the evidence must last, s.
    float hold;
    // Time constant with which the estimate goes to a speed seen in saturation, s.
    float follow;
    // Time constant with which the estimate recovers to the set limit, s.
    float recovery;
} shakedown_saturation_t;

// Largest force of the actuator and how it is measured.
typedef struct {
    // Largest force, N.
    float limit;
    // Area of the piston, m2.
    float piston_area;
} shakedown_force_t;

// Limits of the envelope. The stroke is the settings' own.
typedef struct {
    // Room kept free at each end of the stroke, m.
    float margin;
    // From a trip to the table slowing down, s: the valve's lag and the safe ramp.
    float stopping_latency;
    // Slowing down from then on, m/s2.
    float stopping_deceleration;
    // Largest speed, m/s.
    float velocity;
    // Largest acceleration, m/s2.
    float acceleration;
    // Largest jerk, m/s3.
    float jerk;
    // Largest force; none where no pressure is measured.
    shakedown_force_t force;
    // Whether there is `force`; 0 is no.
    uint8_t has_force;
    // Largest distance between table and reference, m; not judged in guard mode.
    float tracking;
    // How long acceleration, jerk, force and tracking may be beyond, s.
    float persistence;
} shakedown_envelope_t;

// When a sensor is not believed.
typedef struct {
    // How long a reading may be missing, s.
    float lost;
    // How long a reading may stay the same to the last bit while the other sensor moves, s.
    float stuck;
    // Largest mean magnitude of the observer's innovation, m.
    float disagreement;
    // Largest offset that the accelerometer can have, m/s2.
    float offset;
    // Largest mean change of acceleration from tick to tick that is noise and not motion, m/s2.
    float acceleration_noise;
} shakedown_plausibility_t;

// Stated errors of LVDT and accelerometer, and the window over which they are compared.
typedef struct {
    // Below this the accelerometer is not believed, Hz.
    float frequency;
    // Largest difference between the two sensors' scales, 1.
    float scale;
    // Largest delay between the two sensors, s.
    float delay;
    // Largest step of the accelerometer's zero during a test, m/s2.
    float bias;
    // Standard deviation of the accelerometer's noise at each tick, m/s2.
    float noise;
} shakedown_witness_t;

// When the valve is not believed.
typedef struct {
    // Largest displacement that the command does not explain, m.
    float mismatch;
    // Time over which it is forgotten, s.
    float memory;
} shakedown_valve_monitor_t;

// Which of these inputs are fitted. None are where nothing is said.
typedef struct {
    // Largest difference between `second_displacement` and the LVDT, m; none without a second sensor.
    float second_displacement;
    // Whether there is a `second_displacement`; 0 is no.
    uint8_t has_second_displacement;
    // Whether `limit_switch` is read. 0 is no.
    uint8_t limit_switches;
    // Longest time from a command of the relay to `relay_closed` following, s; none without read-back.
    float relay_feedback;
    // Whether there is a `relay_feedback`; 0 is no.
    uint8_t has_relay_feedback;
} shakedown_inputs_t;

// How long things take.
typedef struct {
    // From a stand into the reference, and back, s.
    float test;
    // From any command to the one at which no oil flows, at a trip, s.
    float safe;
} shakedown_ramps_t;

// Everything the guard needs to be told.
typedef struct {
    // Where the table may be and how it may move.
    shakedown_envelope_t envelope;
    // When a sensor is not believed.
    shakedown_plausibility_t plausibility;
    // When LVDT and accelerometer contradict each other over a window.
    shakedown_witness_t witness;
    // When the valve is not believed.
    shakedown_valve_monitor_t valve;
    // Which inputs there are beside the sensors.
    shakedown_inputs_t inputs;
    // How the test starts, holds and ends.
    shakedown_ramps_t ramps;
} shakedown_guard_t;

// Everything a user may set. What is left out of a file has the default's value: the paper's current controller,
// bare, at 1 kHz.
typedef struct {
    // Control rate, Hz, 50 to 20,000.
    float rate;
    // Place in the valve command path.
    // One of `SHAKEDOWN_MODE_...`.
    uint8_t mode;
    // Gains on the displacement error.
    shakedown_gains_t displacement;
    // Gains on the velocity error, whose sum is integrated once.
    shakedown_gains_t velocity;
    // Gains on the acceleration error, whose sum is integrated twice.
    shakedown_gains_t acceleration;
    // Largest speed of the table, m/s.
    float velocity_limit;
    // Largest displacement from centre, m.
    float stroke;
    // What the output drives: the valve, or a hard-wired loop that has to be cancelled.
    // One of `SHAKEDOWN_INNER_LOOP_...`.
    uint8_t inner_loop;
    // Whether integrators stop while the valve or the command is at its limit. 0 is no.
    uint8_t anti_windup;
    // How the reference is modified.
    // One of `SHAKEDOWN_MODIFICATION_...`.
    uint8_t modification;
    // How far ahead a preview looks, s.
    float preview_seconds;
    // Velocity and acceleration of the reference.
    // One of `SHAKEDOWN_RATES_...`.
    uint8_t reference_rates;
    // Band of the differentiators of derived rates, Hz.
    float rates_frequency;
    // Velocity of the table.
    // One of `SHAKEDOWN_VELOCITY_SOURCE_...`.
    uint8_t velocity_source;
    // Corner of the acceleration loop's washout, Hz.
    float washout_frequency;
    // The observer.
    shakedown_observer_t observer;
    // The valve.
    shakedown_valve_t valve;
    // What readings can be true.
    shakedown_ranges_t ranges;
    // Time over which a change of settings or of mode is blended in, s.
    float blend;
    // The tracking law, in controller mode in place of the three loops; none leaves them.
    shakedown_tracking_t tracking;
    // Whether there is `tracking`; 0 is no.
    uint8_t has_tracking;
    // Detection of velocity saturation; none does not look for it.
    shakedown_saturation_t saturation;
    // Whether there is `saturation`; 0 is no.
    uint8_t has_saturation;
    // The guard; none leaves the law bare, running from the first tick, for simulation and for fitting.
    shakedown_guard_t guard;
    // Whether there is `guard`; 0 is no.
    uint8_t has_guard;
} shakedown_settings_t;

// Why settings were refused.
typedef struct {
    // One of the codes, `SHAKEDOWN_OK` where nothing is wrong.
    int32_t code;
    // What was given.
    float value;
    // Smallest value accepted.
    float low;
    // Largest value accepted.
    float high;
    // The field's dotted name, closed by a zero.
    uint8_t field[SHAKEDOWN_NAME];
} shakedown_fault_t;

// Storage of a controller. Only `shakedown_init` makes it one.
typedef struct {
    // Not for the caller.
    uint64_t opaque[512];
} shakedown_t;

// What sensors and reference say at one tick, in SI. What the settings do not read may hold anything.
typedef struct {
    // Reference displacement, m.
    float reference;
    // Table displacement from the LVDT, m.
    float displacement;
    // Table acceleration, m/s2.
    float acceleration;
    // The existing controller's command, m.
    float external;
    // Table velocity from a sensor of its own, m/s.
    float velocity;
    // Pressure difference across the piston, Pa.
    float pressure_difference;
    // Reference velocity, m/s.
    float reference_velocity;
    // Reference acceleration, m/s2.
    float reference_acceleration;
    // Table displacement from a second sensor, m.
    float second_displacement;
    // Whether the table is at a limit switch; 0 is no.
    uint8_t limit_switch;
    // Whether the relay's contact reads closed; 0 is no.
    uint8_t relay_closed;
} shakedown_sample_t;

// What the valve is told, and what happened.
typedef struct {
    // What goes out, m: the valve command; in modifier mode the reference handed to the existing controller.
    float valve;
    // The reference after the test's ramps and record modification, m.
    float reference;
    // The velocity limit now in force, m/s.
    float velocity_limit;
    // Where the test stands: one of `SHAKEDOWN_STATE_...`.
    uint8_t state;
    // Why the guard tripped, 1 to 17 in the order of docs/hosts.md; 0 for no trip.
    uint8_t trip;
    // Whether the relay of the hydraulic block is to be closed.
    uint8_t relay_closed;
    // Whether the table's velocity is at its limit.
    uint8_t saturated;
    // Whether a needed input was not believable, so that the last good output was held.
    uint8_t held;
    // Whether the command is at its limit.
    uint8_t limited;
    // Which inputs were not believable, a bit each in the order of `shakedown_sample_t`; bit 6 is both reference rates, 7 the
    // second displacement.
    uint8_t missing;
    // How often state or trip have changed, modulo 256.
    uint8_t changes;
} shakedown_command_t;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library; compare it with `SHAKEDOWN_ABI`.
uint32_t shakedown_abi(void);

// Sizes by which a caller can tell that header and library fit, byte: 0 storage, 1 settings, 2 sample, 3 command, 4 fault; 0
// for any other number.
size_t shakedown_sizeof(uint32_t what);

// Writes the defaults: the controller of the paper's table, bare, at 1 kHz.
int32_t shakedown_settings_default(shakedown_settings_t *settings);

// Sets one field by its dotted name, written as in a settings file: "guard.envelope.velocity", "0.5"; a word stands in double
// quotes. Both texts are closed by a zero. On an error the settings are as they were.
int32_t shakedown_settings_set(shakedown_settings_t *settings,
                               const char *name,
                               const char *value);

// Reads a text of `length` bytes in a settings file's words: `name = value`, `[table]`, `# comment`; no inline tables. What it
// does not name stays. On an error the settings are as they were.
int32_t shakedown_settings_read(shakedown_settings_t *settings,
                                const char *text,
                                size_t length);

// Checks settings as a whole, and says in `fault` (which may be null) what is wrong.
int32_t shakedown_check(const shakedown_settings_t *settings, shakedown_fault_t *fault);

// Makes `storage` of `size` bytes a controller, if the settings hold. With a guard it is off, and moves nothing before it is
// armed and started; without one it runs. Refused settings leave no controller.
int32_t shakedown_init(shakedown_t *storage,
                       size_t size,
                       const shakedown_settings_t *settings);

// Exchanges the settings between two ticks, whole or not at all.
int32_t shakedown_retune(shakedown_t *storage, const shakedown_settings_t *settings);

// Asks for a change of state: one of `SHAKEDOWN_REQUEST_...`.
int32_t shakedown_request(shakedown_t *storage, uint8_t request);

// One tick. On an error `command` is as it was: the caller then opens the relay.
int32_t shakedown_step(shakedown_t *storage, const shakedown_sample_t *sample, shakedown_command_t *command);

// What a code means, in English; static text.
const char *shakedown_error(int32_t code);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SHAKEDOWN_H */
