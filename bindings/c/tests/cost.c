/* What a call costs, in time of the processor: the median over blocks of a thousand calls, ns. */
#define _POSIX_C_SOURCE 199309L
#include "shakedown.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { CALLS = 1000000, BLOCK = 1000, BLOCKS = CALLS / BLOCK };

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static int smaller(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(void)
{
    static shakedown_t table;
    static double cost[BLOCKS];
    shakedown_settings_t settings;
    shakedown_sample_t sample = {.reference = 0.01f};
    shakedown_command_t command;
    float sum = 0.0f;
    if (shakedown_settings_default(&settings) != SHAKEDOWN_OK || shakedown_init(&table, sizeof table, &settings) != SHAKEDOWN_OK)
        return EXIT_FAILURE;
    for (int k = 0; k < BLOCKS; k++) {
        double begin = now();
        for (int i = 0; i < BLOCK; i++) {
            if (shakedown_step(&table, &sample, &command) != SHAKEDOWN_OK)
                return EXIT_FAILURE;
            sum += command.valve;
        }
        cost[k] = (now() - begin) / BLOCK;
    }
    qsort(cost, BLOCKS, sizeof *cost, smaller);
    printf("%.1f\n", cost[BLOCKS / 2]);
    return sum == sum ? EXIT_SUCCESS : EXIT_FAILURE;
}
