/* The simulated table as an FMU for co-simulation (FMI 3.0): one step is one tick with the valve's command held.
 *
 * The table is resources/table.toml, or the text that the parameter `table` gives in its place. Parameters are taken before the
 * first step. Outputs are what ideal sensors say at the end of the tick, before the next command acts. */
#include "fmu.h"
#include "shakedown_twin.h"

#include <stdlib.h>
#include <string.h>

#define TOKEN "{shakedown-twin-1}"

enum { TIME = 0, VALVE = 1, TABLE, RATE, START, AREA_PER_MASS };
enum { DISPLACEMENT = 10, VELOCITY, ACCELERATION, PRESSURE_DIFFERENCE };

typedef struct {
    shakedown_twin_t *table;
    shakedown_twin_options_t options;
    shakedown_twin_motion_t motion;
    double valve, start;
    uint64_t ticks;
    int stepping;
    char resource[LONGEST], text[LONGEST];
    listener_t listener;
} fmu_t;

static void close_table(fmu_t *fmu)
{
    shakedown_twin_close(fmu->table);
    fmu->table = NULL;
}

/* The table at rest, opened by whoever first wants to know something of it. */
static fmi3Status ready(fmu_t *fmu)
{
    char message[1024] = "the table cannot be opened";
    if (fmu->table)
        return fmi3OK;
    if (shakedown_twin_open(fmu->text, strlen(fmu->text), &fmu->options, &fmu->table, message, sizeof message) != 0)
        return say(&fmu->listener, fmi3Error, message);
    return shakedown_twin_motion(fmu->table, &fmu->motion) == 0 ? fmi3OK : fmi3Error;
}

static void begin(fmu_t *fmu)
{
    close_table(fmu);
    shakedown_twin_default(&fmu->options);
    strcpy(fmu->text, fmu->resource);
    fmu->valve = 0.0;
    fmu->ticks = 0;
    fmu->stepping = 0;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference required[], size_t count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    fmu_t *fmu;
    (void)name, (void)visible, (void)logging, (void)early, (void)required, (void)update;
    if (!token || strcmp(token, TOKEN) != 0 || events || count != 0 || !(fmu = calloc(1, sizeof *fmu)))
        return NULL;
    fmu->listener = (listener_t) { environment, log };
    if (!read_resource(resources, "table.toml", fmu->resource)) {
        say(&fmu->listener, fmi3Error, "resources/table.toml cannot be read");
        free(fmu);
        return NULL;
    }
    begin(fmu);
    return fmu;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    if (instance)
        close_table(instance);
    free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance,
    fmi3Float64 start, fmi3Boolean has_stop, fmi3Float64 stop)
{
    fmu_t *fmu = instance;
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    if (!fmu)
        return fmi3Error;
    fmu->start = start;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    fmu_t *fmu = instance;
    if (!fmu || ready(fmu) != fmi3OK)
        return fmi3Error;
    fmu->stepping = 1;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    if (!instance)
        return fmi3Error;
    begin(instance);
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    fmu_t *fmu = instance;
    (void)no_return;
    if (!fmu || !fmu->stepping)
        return fmi3Error;
    *event = *terminate = *early = fmi3False;
    if (check_tick(&fmu->listener, fmu->options.rate, now - fmu->start, step, fmu->ticks) != fmi3OK)
        return fmi3Error;
    if (shakedown_twin_step(fmu->table, fmu->valve, &fmu->motion) != 0)
        return say(&fmu->listener, fmi3Error, "the valve's command is no number");
    fmu->ticks++;
    *last = now + step;
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 values[], size_t given)
{
    EACH(count, given) {
        double *place = NULL;
        switch (references[k]) {
        case VALVE: fmu->valve = values[k]; continue;
        case RATE: place = &fmu->options.rate; break;
        case START: place = &fmu->options.start; break;
        case AREA_PER_MASS: place = &fmu->options.area_per_mass; break;
        default: return fmi3Error;
        }
        if (fmu->stepping)
            return say(&fmu->listener, fmi3Error, "parameters are taken before the first step");
        *place = values[k];
        close_table(fmu);
    }
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Float64 values[],
    size_t given)
{
    EACH(count, given) {
        if (references[k] >= DISPLACEMENT && ready(fmu) != fmi3OK)
            return fmi3Error;
        switch (references[k]) {
        case TIME: values[k] = fmu->start + (double)fmu->ticks / fmu->options.rate; break;
        case VALVE: values[k] = fmu->valve; break;
        case RATE: values[k] = fmu->options.rate; break;
        case START: values[k] = fmu->options.start; break;
        case AREA_PER_MASS: values[k] = fmu->options.area_per_mass; break;
        case DISPLACEMENT: values[k] = fmu->motion.displacement; break;
        case VELOCITY: values[k] = fmu->motion.velocity; break;
        case ACCELERATION: values[k] = fmu->motion.acceleration; break;
        case PRESSURE_DIFFERENCE: values[k] = fmu->motion.pressure_difference; break;
        default: return fmi3Error;
        }
    }
    return fmi3OK;
}

/* An empty text stands for resources/table.toml. */
fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3String values[], size_t given)
{
    EACH(count, given) {
        if (references[k] != TABLE || !values[k] || strlen(values[k]) >= LONGEST)
            return fmi3Error;
        if (fmu->stepping)
            return say(&fmu->listener, fmi3Error, "parameters are taken before the first step");
        strcpy(fmu->text, values[k][0] ? values[k] : fmu->resource);
        close_table(fmu);
    }
    return fmi3OK;
}

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3String values[],
    size_t given)
{
    EACH(count, given) {
        if (references[k] != TABLE)
            return fmi3Error;
        values[k] = fmu->text;
    }
    return fmi3OK;
}

/* There are no variables of these kinds. */
#define NO_VARIABLES(kind, type) \
    fmi3Status fmi3Get##kind(fmi3Instance instance, const fmi3ValueReference references[], size_t count, type values[], \
        size_t given) \
    { \
        (void)references, (void)values, (void)given; \
        return instance && count == 0 ? fmi3OK : fmi3Error; \
    } \
    fmi3Status fmi3Set##kind(fmi3Instance instance, const fmi3ValueReference references[], size_t count, \
        const type values[], size_t given) \
    { \
        (void)references, (void)values, (void)given; \
        return instance && count == 0 ? fmi3OK : fmi3Error; \
    }

NO_VARIABLES(Float32, fmi3Float32)
NO_VARIABLES(Int32, fmi3Int32)
NO_VARIABLES(Boolean, fmi3Boolean)
