// The simulated table of shakedown: a command in, a tick's motion out. SI units. See docs/hosts.md.
//
// Written by cbindgen from bindings/twin/src: `cargo xtask header` writes it anew, `cargo xtask header check` compares.
// Codes are those of shakedown.h. A table is for one thread at a time.

#ifndef SHAKEDOWN_TWIN_H
#define SHAKEDOWN_TWIN_H

#include <stddef.h>
#include <stdint.h>

// A table in motion.
typedef struct shakedown_twin_t shakedown_twin_t;

// What is chosen of a table beside its model.
typedef struct {
    // Ticks a second, Hz.
    double rate;
    // Where it rests at first, m.
    double start;
    // Piston area over moving mass by which a load becomes a pressure difference, m2/kg; zero where no sensor is fitted, whose
    // reading then is no number.
    double area_per_mass;
} shakedown_twin_options_t;

// What ideal sensors say at the end of a tick, before the next command acts.
typedef struct {
    // Displacement from centre, m.
    double displacement;
    // Velocity, m/s.
    double velocity;
    // Acceleration, the mean over the tick, m/s2.
    double acceleration;
    // Pressure difference across the piston, Pa.
    double pressure_difference;
} shakedown_twin_motion_t;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Writes the defaults: 1 kHz, at rest at the centre, no pressure sensor.
int32_t shakedown_twin_default(shakedown_twin_options_t *options);

// Opens a table: `text` of `length` bytes in the words of a `table.toml`. What is refused leaves `table` as it was and says
// why in `message`, at most `room` bytes with a closing zero.
int32_t shakedown_twin_open(const char *text,
                            size_t length,
                            const shakedown_twin_options_t *options,
                            shakedown_twin_t **table,
                            char *message,
                            size_t room);

// One tick with `command` (m) at the valve; a command that is no number is refused and moves nothing.
int32_t shakedown_twin_step(shakedown_twin_t *table, double command, shakedown_twin_motion_t *motion);

// What the sensors said last, at first of the table at rest.
int32_t shakedown_twin_motion(const shakedown_twin_t *table, shakedown_twin_motion_t *motion);

// Closes a table that was opened; null is left alone.
void shakedown_twin_close(shakedown_twin_t *table);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SHAKEDOWN_TWIN_H */
