/* What both FMUs share. */
#include "fmu.h"

#include <math.h>
#include <stdio.h>

fmi3Status say(const listener_t *listener, fmi3Status status, const char *message)
{
    if (listener->log)
        listener->log(
            listener->environment, status, status == fmi3Warning ? "logStatusWarning" : "logStatusError", message);
    return status;
}

int read_resource(const char *resources, const char *name, char text[LONGEST])
{
    char path[4096];
    size_t length;
    FILE *file;
    if (!resources || snprintf(path, sizeof path, "%s/%s", resources, name) >= (int)sizeof path)
        return 0;
    file = fopen(path, "rb");
    if (!file)
        return 0;
    length = fread(text, 1, LONGEST - 1, file);
    text[length] = 0;
    fclose(file);
    return length < LONGEST - 1;
}

fmi3Status check_tick(const listener_t *listener, double rate, double since_start, double step, uint64_t ticks)
{
    if (!(fabs(step * rate - 1.0) <= 1e-6))
        return say(listener, fmi3Error, "the communication step is not one tick of the control rate");
    if (!(fabs(since_start * rate - (double)ticks) <= 0.5))
        return say(listener, fmi3Error, "the time is not that of the next tick");
    return fmi3OK;
}

const char *fmi3GetVersion(void) { return "3.0"; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t count, const fmi3String categories[])
{
    (void)on, (void)count, (void)categories;
    return instance ? fmi3OK : fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance instance) { return instance ? fmi3OK : fmi3Error; }
