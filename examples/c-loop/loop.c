/* A table's loop as an STM32Cube project has it: a timer's interrupt, two converters, a relay, a key. Nothing is armed at
 * power-up or after a trip: the key has to be seen off before it is taken for on. The same file runs on a host under fake_hal.c. */
#include "hal.h"
#include "shakedown.h"

#define METRE_PER_CODE (0.25f / 4096.0f) /* LVDT, reference and valve: +/-0.125 m over 12 bits */
#define ACCELERATION_PER_CODE (40.0f / 4096.0f)
#define MIDDLE 2048

static const char SETTINGS[] =
    "rate = 1000\n"
    "displacement.proportional = 10\n"
    "anti_windup = true\n"
    "modification = \"causal\"\n"
    "[saturation]\n"
    "[guard]\n";

static shakedown_t table;
static int ready, key_was_off;

/* Called once, before the timer starts. */
int loop_begin(void)
{
    shakedown_settings_t settings;
    if (shakedown_abi() != SHAKEDOWN_ABI || shakedown_sizeof(0) != sizeof table)
        return SHAKEDOWN_TOO_SMALL;
    int32_t code = shakedown_settings_default(&settings);
    if (code == SHAKEDOWN_OK)
        code = shakedown_settings_read(&settings, SETTINGS, sizeof SETTINGS - 1);
    if (code == SHAKEDOWN_OK)
        code = shakedown_init(&table, sizeof table, &settings);
    ready = code == SHAKEDOWN_OK;
    return code;
}

static void key(uint8_t state)
{
    int on = HAL_GPIO_ReadPin(KEY_PORT, KEY_PIN) == GPIO_PIN_SET;
    if (state == SHAKEDOWN_STATE_TRIPPED)
        key_was_off = 0;
    else if (!on)
        key_was_off = 1;
    if (on && key_was_off && state == SHAKEDOWN_STATE_OFF)
        (void)shakedown_request(&table, SHAKEDOWN_REQUEST_ARM);
    else if (on && key_was_off && state == SHAKEDOWN_STATE_READY)
        (void)shakedown_request(&table, SHAKEDOWN_REQUEST_START);
    else if (!on && state == SHAKEDOWN_STATE_RUNNING)
        (void)shakedown_request(&table, SHAKEDOWN_REQUEST_STOP);
    else if (!on && state == SHAKEDOWN_STATE_READY)
        (void)shakedown_request(&table, SHAKEDOWN_REQUEST_OFF);
}

static uint32_t code_of(float metre)
{
    float code = metre / METRE_PER_CODE + MIDDLE + 0.5f;
    return code < 0.0f ? 0 : code > 4095.0f ? 4095 : (uint32_t)code;
}

void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer)
{
    shakedown_sample_t sample = {0};
    shakedown_command_t command;
    if (timer != &htim2 || !ready)
        return;
    sample.reference = (float)((int)adc[0] - MIDDLE) * METRE_PER_CODE;
    sample.displacement = (float)((int)adc[1] - MIDDLE) * METRE_PER_CODE;
    sample.acceleration = (float)((int)adc[2] - MIDDLE) * ACCELERATION_PER_CODE;
    if (shakedown_step(&table, &sample, &command) != SHAKEDOWN_OK) {
        HAL_GPIO_WritePin(RELAY_PORT, RELAY_PIN, GPIO_PIN_RESET);
        return;
    }
    HAL_DAC_SetValue(&hdac, DAC_CHANNEL_1, DAC_ALIGN_12B_R, code_of(command.valve));
    HAL_GPIO_WritePin(RELAY_PORT, RELAY_PIN, command.relay_closed ? GPIO_PIN_SET : GPIO_PIN_RESET);
    key(command.state);
}
