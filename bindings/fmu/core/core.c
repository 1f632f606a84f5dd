/* The control core as an FMU for co-simulation (FMI 3.0): one step is one tick of the controller.
 *
 * Settings come from resources/settings.toml and may be replaced by the parameter `settings`, a text in the same words, before
 * the simulation or between two steps. `request` is acted on at the step before which it has changed: 1 arm, 2 start, 3 hold,
 * 4 resume, 5 stop, 6 off, 7 reset, 8 trip; 0 asks for nothing. What stands above its lowest four bits is not read, so that
 * a number 16 higher asks for the same again. */
#include "fmu.h"
#include "shakedown.h"

#include <stdlib.h>
#include <string.h>

#define TOKEN "{shakedown-core-1}"

enum { TIME = 0, NUMBERS = 1, LIMIT_SWITCH = 10, RELAY_CONTACT, REQUEST, SETTINGS };
enum { VALVE = 20, REFERENCE, VELOCITY_LIMIT, STATE, TRIP, RELAY, SATURATED, HELD, LIMITED, MISSING, CHANGES };
enum { REQUEST_CODE = 31, SETTINGS_CODE };

typedef struct {
    shakedown_t table;
    shakedown_settings_t settings;
    shakedown_sample_t sample;
    shakedown_command_t command;
    char text[LONGEST];
    int stepping;
    fmi3Int32 request, asked, request_code, settings_code;
    double start;
    uint64_t ticks;
    listener_t listener;
} fmu_t;

/* Settings from a text over the defaults; what is refused leaves those there were. */
static int32_t settle(fmu_t *fmu, const char *text)
{
    shakedown_settings_t settings;
    int32_t code = shakedown_settings_default(&settings);
    if (code == SHAKEDOWN_OK)
        code = shakedown_settings_read(&settings, text, strlen(text));
    if (code == SHAKEDOWN_OK)
        code = fmu->stepping ? shakedown_retune(&fmu->table, &settings) : shakedown_check(&settings, NULL);
    if (code == SHAKEDOWN_OK) {
        fmu->settings = settings;
        strcpy(fmu->text, text);
    }
    return fmu->settings_code = code;
}

static int load(fmu_t *fmu, const char *resources)
{
    char text[LONGEST];
    return read_resource(resources, "settings.toml", text) && settle(fmu, text) == SHAKEDOWN_OK;
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
    if (!load(fmu, resources)) {
        say(&fmu->listener, fmi3Error, "resources/settings.toml cannot be read, or its settings are refused");
        free(fmu);
        return NULL;
    }
    return fmu;
}

void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

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
    int32_t code;
    if (!fmu)
        return fmi3Error;
    code = shakedown_init(&fmu->table, sizeof fmu->table, &fmu->settings);
    if (code != SHAKEDOWN_OK)
        return say(&fmu->listener, fmi3Error, shakedown_error(code));
    fmu->stepping = 1;
    fmu->ticks = 0;
    fmu->asked = fmu->request;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    fmu_t *fmu = instance;
    if (!fmu)
        return fmi3Error;
    memset(&fmu->table, 0, sizeof fmu->table);
    memset(&fmu->sample, 0, sizeof fmu->sample);
    memset(&fmu->command, 0, sizeof fmu->command);
    fmu->stepping = 0;
    fmu->request = fmu->asked = fmu->request_code = fmu->settings_code = 0;
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 now, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event,
    fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    fmu_t *fmu = instance;
    int32_t code;
    (void)no_return;
    if (!fmu || !fmu->stepping)
        return fmi3Error;
    *event = *terminate = *early = fmi3False;
    if (check_tick(&fmu->listener, fmu->settings.rate, now - fmu->start, step, fmu->ticks) != fmi3OK)
        return fmi3Error;
    if (fmu->request != fmu->asked) {
        fmu->asked = fmu->request;
        fmu->request_code = SHAKEDOWN_OK;
        if ((fmu->request & 15) != 0)
            fmu->request_code = shakedown_request(&fmu->table, (uint8_t)((fmu->request & 15) - 1));
    }
    code = shakedown_step(&fmu->table, &fmu->sample, &fmu->command);
    if (code != SHAKEDOWN_OK)
        return say(&fmu->listener, fmi3Error, shakedown_error(code));
    fmu->ticks++;
    *last = now + step;
    return fmi3OK;
}

/* The places of the nine numbers of a sample, in the order of their references. */
static float *number(fmu_t *fmu, fmi3ValueReference reference)
{
    shakedown_sample_t *s = &fmu->sample;
    float *places[] = { &s->reference, &s->displacement, &s->acceleration, &s->external, &s->velocity,
        &s->pressure_difference, &s->reference_velocity, &s->reference_acceleration, &s->second_displacement };
    return reference >= NUMBERS && reference < NUMBERS + 9 ? places[reference - NUMBERS] : NULL;
}

fmi3Status fmi3SetFloat32(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float32 values[], size_t given)
{
    EACH(count, given) {
        float *place = number(fmu, references[k]);
        if (!place)
            return fmi3Error;
        *place = values[k];
    }
    return fmi3OK;
}

fmi3Status fmi3GetFloat32(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Float32 values[],
    size_t given)
{
    EACH(count, given) {
        const float *place = number(fmu, references[k]);
        switch (references[k]) {
        case VALVE: place = &fmu->command.valve; break;
        case REFERENCE: place = &fmu->command.reference; break;
        case VELOCITY_LIMIT: place = &fmu->command.velocity_limit; break;
        default: break;
        }
        if (!place)
            return fmi3Error;
        values[k] = *place;
    }
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Float64 values[],
    size_t given)
{
    EACH(count, given) {
        if (references[k] != TIME)
            return fmi3Error;
        values[k] = fmu->start + (double)fmu->ticks / fmu->settings.rate;
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Float64 values[], size_t given)
{
    (void)references, (void)values, (void)given;
    return instance && count == 0 ? fmi3OK : fmi3Error;
}

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count, const fmi3Int32 values[],
    size_t given)
{
    EACH(count, given) {
        if (references[k] != REQUEST)
            return fmi3Error;
        fmu->request = values[k];
    }
    return fmi3OK;
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Int32 values[],
    size_t given)
{
    EACH(count, given) {
        switch (references[k]) {
        case REQUEST: values[k] = fmu->request; break;
        case STATE: values[k] = fmu->command.state; break;
        case TRIP: values[k] = fmu->command.trip; break;
        case MISSING: values[k] = fmu->command.missing; break;
        case CHANGES: values[k] = fmu->command.changes; break;
        case REQUEST_CODE: values[k] = fmu->request_code; break;
        case SETTINGS_CODE: values[k] = fmu->settings_code; break;
        default: return fmi3Error;
        }
    }
    return fmi3OK;
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3Boolean values[], size_t given)
{
    EACH(count, given) {
        switch (references[k]) {
        case LIMIT_SWITCH: fmu->sample.limit_switch = values[k]; break;
        case RELAY_CONTACT: fmu->sample.relay_closed = values[k]; break;
        default: return fmi3Error;
        }
    }
    return fmi3OK;
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Boolean values[],
    size_t given)
{
    EACH(count, given) {
        switch (references[k]) {
        case LIMIT_SWITCH: values[k] = fmu->sample.limit_switch; break;
        case RELAY_CONTACT: values[k] = fmu->sample.relay_closed; break;
        case RELAY: values[k] = fmu->command.relay_closed; break;
        case SATURATED: values[k] = fmu->command.saturated; break;
        case HELD: values[k] = fmu->command.held; break;
        case LIMITED: values[k] = fmu->command.limited; break;
        default: return fmi3Error;
        }
    }
    return fmi3OK;
}

fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
    const fmi3String values[], size_t given)
{
    EACH(count, given) {
        int32_t code;
        if (references[k] != SETTINGS || !values[k] || strlen(values[k]) >= LONGEST)
            return fmi3Error;
        code = settle(fmu, values[k]);
        if (code != SHAKEDOWN_OK)
            return say(&fmu->listener, fmi3Warning, shakedown_error(code));
    }
    return fmi3OK;
}

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3String values[],
    size_t given)
{
    EACH(count, given) {
        if (references[k] != SETTINGS)
            return fmi3Error;
        values[k] = fmu->text;
    }
    return fmi3OK;
}
