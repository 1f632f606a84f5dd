/* As much of STM32Cube's HAL as the loop uses. A project of one's own includes "main.h" in its place. */
#ifndef HAL_H
#define HAL_H

#include <stdint.h>

typedef struct { int unused; } TIM_HandleTypeDef, DAC_HandleTypeDef, GPIO_TypeDef;
typedef enum { GPIO_PIN_RESET, GPIO_PIN_SET } GPIO_PinState;

#define DAC_CHANNEL_1 0u
#define DAC_ALIGN_12B_R 0u
#define KEY_PIN 1u
#define RELAY_PIN 2u
#define KEY_PORT (&port_a)
#define RELAY_PORT (&port_a)

extern TIM_HandleTypeDef htim2;
extern DAC_HandleTypeDef hdac;
extern GPIO_TypeDef port_a;
extern volatile uint16_t adc[3]; /* filled by DMA: reference, LVDT, accelerometer */

GPIO_PinState HAL_GPIO_ReadPin(GPIO_TypeDef *port, uint16_t pin);
void HAL_GPIO_WritePin(GPIO_TypeDef *port, uint16_t pin, GPIO_PinState state);
int HAL_DAC_SetValue(DAC_HandleTypeDef *dac, uint32_t channel, uint32_t alignment, uint32_t data);
void HAL_TIM_PeriodElapsedCallback(TIM_HandleTypeDef *timer);
int loop_begin(void);

#endif
