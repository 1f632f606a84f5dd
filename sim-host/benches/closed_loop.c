/* The closed loop of closed_loop.rs in plain C: the plant of Eq. 7 with its limiter in closed form, ideal sensors, the
 * plain PI law, the same trace. Same operations in the same order, so that the two can be held against each other in
 * time and in their last digit. Prints the best seconds per run of `argv[1]` repetitions, and the final displacement. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { TICKS = 60000, STEPS = 10 };
static const double RATE = 1000.0;

typedef struct { double b1, b0, a1, limit, dt, kept, lost, gain, lag, x; } Plant;
typedef struct { double kp, ki_per_tick, sum; } Law;
typedef struct { bool saturated, detected, held; } Flags;
typedef struct {
    double *reference, *commanded, *command, *displacement, *velocity, *acceleration;
    double *measured_displacement, *measured_acceleration;
    Flags *flags;
} Trace;

static double clamp(double v, double limit) { return v < -limit ? -limit : v > limit ? limit : v; }

static double travel(double rate, double end, double excess, double from, double to) {
    double lost = -expm1(-rate * (to - from)) / rate;
    return end * (to - from) + excess * exp(-rate * from) * lost;
}

static double crossing(double rate, double end, double excess, double level, double dt) {
    double t = log(excess / (level - end)) / rate;
    return t < 0.0 ? 0.0 : t > dt ? dt : t;
}

static __attribute__((noinline)) double limited_travel(double rate, double end, double excess, double dt,
                                                       double limit) {
    double first = end + excess, last = end + excess * exp(-rate * dt);
    if (fmin(first, last) >= limit || fmax(first, last) <= -limit) return clamp(first, limit) * dt;
    double enters = fabs(first) > limit ? crossing(rate, end, excess, copysign(limit, first), dt) : 0.0;
    double leaves = fabs(last) > limit ? crossing(rate, end, excess, copysign(limit, last), dt) : dt;
    return clamp(first, limit) * enters + travel(rate, end, excess, enters, leaves) +
           clamp(last, limit) * (dt - leaves);
}

static inline double velocity(const Plant *p, double u) { return clamp(p->lag + p->b1 * u, p->limit); }

static inline void advance(Plant *p, double u, int steps) {
    double limit = p->limit, end = p->gain * u, at_end = end * p->dt, at_limit = limit * p->dt;
    double excess = p->lag + p->b1 * u - end, first = end + excess, x = p->x;
    for (int i = 0; i < steps; i++) {
        double next = excess * p->kept, last = end + next;
        if (fabs(first) <= limit && fabs(last) <= limit)
            x += at_end + excess * p->lost;
        else if (fmin(first, last) >= limit)
            x += at_limit;
        else if (fmax(first, last) <= -limit)
            x += -at_limit;
        else
            x += limited_travel(p->a1, end, excess, p->dt, limit);
        excess = next;
        first = last;
    }
    p->lag = first - p->b1 * u;
    p->x = x;
}

static void run(Plant *p, Law *law, const double *reference, Trace *t) {
    double u = 0.0, before = velocity(p, u), middle = before;
    for (int k = 0; k < TICKS; k++) {
        double x = p->x, v = velocity(p, u), a = (v - before) * RATE;
        double error = reference[k] - x;
        law->sum += error;
        before = v;
        u = law->kp * error + law->ki_per_tick * law->sum;
        double after = velocity(p, u);
        advance(p, u, STEPS / 2);
        double at_half = velocity(p, u);
        t->reference[k] = reference[k];
        t->commanded[k] = reference[k];
        t->command[k] = u;
        t->displacement[k] = x;
        t->velocity[k] = after;
        t->acceleration[k] = (at_half - middle) * RATE;
        t->measured_displacement[k] = x;
        t->measured_acceleration[k] = a;
        t->flags[k] = (Flags){fabs(p->lag + p->b1 * u) >= p->limit, false, false};
        middle = at_half;
        advance(p, u, STEPS / 2);
    }
}

static double *room(void) { return malloc(TICKS * sizeof(double)); }

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    int repetitions = argc > 1 ? atoi(argv[1]) : 20;
    double *reference = room(), best = INFINITY, final = 0.0;
    /* 75 mm at 2 Hz with a slow swing below it: both limits, their edges, and stretches between them. */
    for (int k = 0; k < TICKS; k++) {
        double time = k / RATE;
        reference[k] = 0.075 * sin(6.283185307179586 * 2.0 * time) * sin(6.283185307179586 * 0.05 * time);
    }
    for (int i = 0; i < repetitions; i++) {
        double start = seconds(), dt = 0.5 / (RATE * (STEPS / 2));
        Plant p = {0.69, 138.0, 57.65, 0.242, dt, exp(-57.65 * dt), -expm1(-57.65 * dt) / 57.65, 138.0 / 57.65, 0, 0};
        Law law = {3.70205, 0.61701 / RATE, 0.0};
        Trace t = {room(), room(), room(), room(), room(), room(), room(), room(), malloc(TICKS * sizeof(Flags))};
        run(&p, &law, reference, &t);
        final = t.displacement[TICKS - 1];
        free(t.reference), free(t.commanded), free(t.command), free(t.displacement), free(t.velocity);
        free(t.acceleration), free(t.measured_displacement), free(t.measured_acceleration), free(t.flags);
        double took = seconds() - start;
        if (took < best) best = took;
    }
    printf("%.9e %.17e\n", best, final);
    return 0;
}
