/* What the C interface refuses, by its code; and that header and library are of one make. */
#include "shakedown.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;

static void hold(const char *what, int holds)
{
    if (!holds) {
        fprintf(stderr, "does not hold: %s\n", what);
        failures++;
    }
}

#define HOLD(expression) hold(#expression, expression)

static void sizes(void)
{
    HOLD(shakedown_abi() == SHAKEDOWN_ABI);
    HOLD(shakedown_sizeof(0) == sizeof(shakedown_t) && sizeof(shakedown_t) == SHAKEDOWN_SIZE);
    HOLD(shakedown_sizeof(1) == sizeof(shakedown_settings_t));
    HOLD(shakedown_sizeof(2) == sizeof(shakedown_sample_t));
    HOLD(shakedown_sizeof(3) == sizeof(shakedown_command_t));
    HOLD(shakedown_sizeof(4) == sizeof(shakedown_fault_t));
    HOLD(shakedown_sizeof(5) == 0);
}

static void storage(const shakedown_settings_t *settings)
{
    static shakedown_t table, raw[2];
    shakedown_sample_t sample;
    shakedown_command_t command;
    shakedown_t *astray = (shakedown_t *)((char *)raw + 1);
    memset(&sample, 0, sizeof sample);
    HOLD(shakedown_init(NULL, sizeof table, settings) == SHAKEDOWN_NULL);
    HOLD(shakedown_init(&table, sizeof table, NULL) == SHAKEDOWN_NULL);
    HOLD(shakedown_init(astray, sizeof table, settings) == SHAKEDOWN_MISALIGNED);
    HOLD(shakedown_init(&table, 100, settings) == SHAKEDOWN_TOO_SMALL);
    HOLD(shakedown_step(&table, &sample, &command) == SHAKEDOWN_UNINITIALISED);
    HOLD(shakedown_request(&table, SHAKEDOWN_REQUEST_ARM) == SHAKEDOWN_UNINITIALISED);
    HOLD(shakedown_retune(&table, settings) == SHAKEDOWN_UNINITIALISED);
    HOLD(shakedown_init(&table, sizeof table, settings) == SHAKEDOWN_OK);
    HOLD(shakedown_step(&table, NULL, &command) == SHAKEDOWN_NULL);
    HOLD(shakedown_step(&table, &sample, NULL) == SHAKEDOWN_NULL);
    HOLD(shakedown_request(&table, 8) == SHAKEDOWN_UNKNOWN_REQUEST);
    HOLD(shakedown_step(&table, &sample, &command) == SHAKEDOWN_OK);
    HOLD(command.state == SHAKEDOWN_STATE_OFF && !command.relay_closed && command.valve == 0.0f);
    HOLD(shakedown_request(&table, SHAKEDOWN_REQUEST_START) == SHAKEDOWN_REFUSED_STATE);
    HOLD(shakedown_request(&table, SHAKEDOWN_REQUEST_ARM) == SHAKEDOWN_OK);
}

static void settings(shakedown_settings_t *good)
{
    shakedown_settings_t s = *good, before;
    shakedown_fault_t fault;
    HOLD(shakedown_settings_default(NULL) == SHAKEDOWN_NULL);
    HOLD(shakedown_settings_set(&s, "guard.envelope.velocity", "0.5") == SHAKEDOWN_OK);
    HOLD(s.has_guard && s.guard.envelope.velocity == 0.5f);
    HOLD(shakedown_settings_set(&s, "mode", "\"modifier\"") == SHAKEDOWN_OK && s.mode == SHAKEDOWN_MODE_MODIFIER);
    before = s;
    HOLD(shakedown_settings_set(&s, "guard.envelop", "0.5") == SHAKEDOWN_UNKNOWN_NAME);
    HOLD(shakedown_settings_set(&s, "rate", "fast") == SHAKEDOWN_WRONG_VALUE);
    HOLD(shakedown_settings_set(&s, "rate", "\xff") == SHAKEDOWN_NO_TEXT);
    HOLD(shakedown_settings_set(&s, "rate", NULL) == SHAKEDOWN_NULL);
    HOLD(shakedown_settings_read(&s, "rate = 500\nrat = 5\n", 19) == SHAKEDOWN_UNKNOWN_NAME);
    HOLD(memcmp(&s, &before, sizeof s) == 0 || s.rate == before.rate);
    s.rate = 10.0f;
    HOLD(shakedown_check(&s, &fault) == SHAKEDOWN_OUT_OF_RANGE && fault.code == SHAKEDOWN_OUT_OF_RANGE);
    HOLD(strcmp((const char *)fault.field, "rate") == 0 && fault.value == 10.0f && fault.low == 50.0f);
    s.rate = NAN;
    HOLD(shakedown_check(&s, NULL) == SHAKEDOWN_OUT_OF_RANGE);
    s.rate = 1000.0f;
    s.mode = 3;
    HOLD(shakedown_check(&s, &fault) == SHAKEDOWN_WRONG_VALUE && fault.field[0] == 0);
    HOLD(shakedown_check(good, &fault) == SHAKEDOWN_OK && fault.code == SHAKEDOWN_OK);
    HOLD(strcmp(shakedown_error(SHAKEDOWN_NULL), "a pointer is null") == 0);
    HOLD(strcmp(shakedown_error(-1), "there is no such code") == 0);
}

int main(void)
{
    shakedown_settings_t good;
    HOLD(shakedown_settings_default(&good) == SHAKEDOWN_OK);
    good.has_guard = 1;
    sizes();
    settings(&good);
    storage(&good);
    return failures ? EXIT_FAILURE : EXIT_SUCCESS;
}
