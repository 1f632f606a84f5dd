/* What both FMUs share. */
#ifndef SHAKEDOWN_FMU_H
#define SHAKEDOWN_FMU_H

#include "fmi3Functions.h"

/* Longest text in resources/ or in a parameter, its closing zero included, byte. */
#define LONGEST 16384

/* Where an instance's messages go. */
typedef struct {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} listener_t;

/* Tells the importer, and returns the status. */
fmi3Status say(const listener_t *listener, fmi3Status status, const char *message);

/* Reads resources/NAME as a text of at most LONGEST bytes; 0 where it cannot be had. */
int read_resource(const char *resources, const char *name, char text[LONGEST]);

/* A step of one tick at `rate`, asked for at the end of `ticks` ticks since `start`: ticks are counted, the time is only held
 * against them. */
fmi3Status check_tick(const listener_t *listener, double rate, double since_start, double step, uint64_t ticks);

/* Opens a loop over the variables of a call, after the counts and the instance were looked at. */
#define EACH(count, given) \
    fmu_t *fmu = instance; \
    if (!fmu || (count) != (given)) \
        return fmi3Error; \
    for (size_t k = 0; k < (count); k++)

#endif
