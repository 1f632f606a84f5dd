/* Plays a tape through the C interface: tape TAPE ANSWERS. The format is that of shakedown_core::host. */
#include "shakedown.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t word(const unsigned char *bytes)
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static float number(const unsigned char *bytes)
{
    uint32_t bits = word(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t bits(float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static int32_t settle(shakedown_t *table, uint32_t tag, const unsigned char *text, uint32_t length)
{
    shakedown_settings_t settings;
    int32_t code = shakedown_settings_default(&settings);
    if (code == SHAKEDOWN_OK)
        code = shakedown_settings_read(&settings, (const char *)text, length);
    if (code != SHAKEDOWN_OK)
        return code;
    return tag == 1 ? shakedown_init(table, sizeof *table, &settings) : shakedown_retune(table, &settings);
}

static int32_t step(shakedown_t *table, const unsigned char *content, uint32_t answer[4])
{
    shakedown_sample_t sample;
    shakedown_command_t c;
    uint32_t flags = word(content + 36);
    int32_t code;
    sample.reference = number(content);
    sample.displacement = number(content + 4);
    sample.acceleration = number(content + 8);
    sample.external = number(content + 12);
    sample.velocity = number(content + 16);
    sample.pressure_difference = number(content + 20);
    sample.reference_velocity = number(content + 24);
    sample.reference_acceleration = number(content + 28);
    sample.second_displacement = number(content + 32);
    sample.limit_switch = flags & 1;
    sample.relay_closed = flags >> 1 & 1;
    code = shakedown_step(table, &sample, &c);
    answer[0] = bits(c.valve);
    answer[1] = bits(c.reference);
    answer[2] = bits(c.velocity_limit);
    answer[3] = (uint32_t)c.saturated | (uint32_t)c.held << 1 | (uint32_t)c.limited << 2 | (uint32_t)c.relay_closed << 3 |
                (uint32_t)c.state << 4 | (uint32_t)c.trip << 8 | (uint32_t)c.missing << 16 | (uint32_t)c.changes << 24;
    return code;
}

static int play(FILE *tape, FILE *answers)
{
    static shakedown_t table;
    static unsigned char content[4096];
    unsigned char head[8];
    while (fread(head, 1, sizeof head, tape) == sizeof head) {
        uint32_t tag = word(head), length = word(head + 4), answer[4] = {0, 0, 0, 0};
        unsigned char out[16];
        if (length > sizeof content || fread(content, 1, length, tape) != length)
            return 0;
        if (tag == 1 || tag == 2)
            answer[0] = (uint32_t)settle(&table, tag, content, length);
        else if (tag == 3 && length == 4)
            answer[0] = (uint32_t)shakedown_request(&table, (uint8_t)word(content));
        else if (tag != 4 || length != 40 || step(&table, content, answer) != SHAKEDOWN_OK)
            return 0;
        for (int i = 0; i < 16; i++)
            out[i] = (unsigned char)(answer[i / 4] >> 8 * (i % 4));
        if (fwrite(out, 1, sizeof out, answers) != sizeof out)
            return 0;
    }
    return feof(tape);
}

int main(int count, char **words)
{
    FILE *tape = count == 3 ? fopen(words[1], "rb") : NULL;
    FILE *answers = tape ? fopen(words[2], "wb") : NULL;
    if (!answers || !play(tape, answers) || fclose(answers) != 0) {
        fprintf(stderr, "tape TAPE ANSWERS: a file is missing, or the tape is damaged\n");
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}
