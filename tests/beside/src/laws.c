/* The core's laws once more, in C: the same operations in the same order, so that the bits must be the same. */

/* What a call costs. */
float nothing_c(const float *law, float *s, float x) {
    (void)law, (void)s;
    return x;
}

static float bounded(float x, float limit) {
    if (__builtin_fabsf(x) <= limit) return x;
    if (x < -limit) return -limit;
    return x > limit ? limit : x;
}

struct displacement { float proportional, integral_step, limit; };
struct displacement_state { float integral; };

float displacement_c(const struct displacement *law, struct displacement_state *s, float e) {
    s->integral = bounded(s->integral + law->integral_step * e, law->limit);
    return law->proportional * e + s->integral;
}

struct velocity { float proportional, integral_step, dt, limit; };
struct velocity_state { float integral, command; };

static inline float velocity(const struct velocity *law, struct velocity_state *s, float e) {
    s->integral = bounded(s->integral + law->integral_step * e, law->limit);
    float rate = law->proportional * e + s->integral;
    s->command = bounded(s->command + law->dt * rate, law->limit);
    return s->command;
}

struct acceleration { float proportional, integral_step, dt, rho, gain, limit, wide; };
struct acceleration_state { float error, washed, integral, rate, command; };

static inline float acceleration(const struct acceleration *law, struct acceleration_state *s, float e) {
    s->washed = law->rho * s->washed + law->gain * (e - s->error);
    s->error = e;
    s->integral = bounded(law->rho * s->integral + law->integral_step * s->washed, law->wide);
    float push = law->proportional * s->washed + s->integral;
    s->rate = bounded(law->rho * s->rate + law->dt * push, law->wide);
    s->command = bounded(law->rho * s->command + law->dt * s->rate, law->limit);
    return s->command;
}

struct three { struct displacement displacement; struct velocity velocity; struct acceleration acceleration; };
struct three_state {
    struct displacement_state displacement;
    struct velocity_state velocity;
    struct acceleration_state acceleration;
};

float three_c(const struct three *law, struct three_state *s, float e) {
    float command = displacement_c(&law->displacement, &s->displacement, e);
    command += velocity(&law->velocity, &s->velocity, 0.5f * e);
    return command + acceleration(&law->acceleration, &s->acceleration, 2.0f * e);
}

struct observer { float dt, half_dt2, l1, l2, l3; };
struct observer_state { float displacement, velocity, offset, innovation; };

float observer_c(const struct observer *law, struct observer_state *s, float x) {
    float f = x + s->offset;
    float predicted = s->displacement + law->dt * s->velocity + law->half_dt2 * f;
    float innovation = x - predicted;
    s->displacement = predicted + law->l1 * innovation;
    s->velocity = s->velocity + law->dt * f + law->l2 * innovation;
    s->offset += law->l3 * innovation;
    s->innovation = innovation;
    return s->velocity;
}

struct section { float c1, c2, c3, m0, m1, m2; };
struct section_state { float s1, s2, output; };

float section_c(const struct section *law, struct section_state *s, float x) {
    float v3 = x - s->s2;
    float v1 = law->c1 * s->s1 + law->c2 * v3;
    float v2 = s->s2 + law->c2 * s->s1 + law->c3 * v3;
    s->s1 = v1 + (v1 - s->s1);
    s->s2 = v2 + (v2 - s->s2);
    s->output = law->m0 * x + law->m1 * v1 + law->m2 * v2;
    return s->output;
}
