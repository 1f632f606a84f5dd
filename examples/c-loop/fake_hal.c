/* Runs the loop on a host: a table that goes where it is told, at most 0.242 m/s, behind converters of 12 bits. */
#include "hal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

TIM_HandleTypeDef htim2;
DAC_HandleTypeDef hdac;
GPIO_TypeDef port_a;
volatile uint16_t adc[3];

static GPIO_PinState key_now, relay;
static float x, v, a, valve;

GPIO_PinState HAL_GPIO_ReadPin(GPIO_TypeDef *port, uint16_t pin) { return (void)port, (void)pin, key_now; }
void HAL_GPIO_WritePin(GPIO_TypeDef *port, uint16_t pin, GPIO_PinState state) { (void)port, (void)pin, relay = state; }

int HAL_DAC_SetValue(DAC_HandleTypeDef *dac, uint32_t channel, uint32_t alignment, uint32_t data)
{
    (void)dac, (void)channel, (void)alignment;
    valve = ((float)data - 2048.0f) * 0.25f / 4096.0f;
    return 0;
}

static uint16_t code(float value, float per_code) { return (uint16_t)(value / per_code + 2048.5f); }

static void tick(float reference)
{
    float flow = relay ? 2.4f * valve : 0.0f, before = v;
    v += 0.06f * (flow - v);
    v = v > 0.242f ? 0.242f : v < -0.242f ? -0.242f : v;
    x += 0.001f * v;
    a = (v - before) * 1000.0f;
    adc[0] = code(reference, 0.25f / 4096.0f);
    adc[1] = code(x, 0.25f / 4096.0f);
    adc[2] = code(a, 40.0f / 4096.0f);
    HAL_TIM_PeriodElapsedCallback(&htim2);
}

int main(void)
{
    float farthest = 0.0f, early = 0.0f;
    if (loop_begin() != 0)
        return EXIT_FAILURE;
    for (int k = 0; k < 20000; k++) {
        /* The key is on from power-up, which must move nothing; then off; then on for ten seconds. */
        key_now = k < 2000 || (k >= 3000 && k < 13000) ? GPIO_PIN_SET : GPIO_PIN_RESET;
        tick(0.03f * sinf((float)k * 0.005f));
        farthest = fabsf(x) > farthest ? fabsf(x) : farthest;
        if (k < 3000 && (relay != GPIO_PIN_RESET || fabsf(x) > early))
            early = relay ? 1.0f : fabsf(x);
    }
    printf("farthest %.4f m, at the end %.2e m/s, relay %s\n", farthest, fabsf(v), relay ? "closed" : "open");
    return early == 0.0f && farthest > 0.02f && farthest < 0.05f && fabsf(v) < 1e-3f && !relay ? EXIT_SUCCESS : EXIT_FAILURE;
}
