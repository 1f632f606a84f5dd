//! STM32F407: reference on PA1, LVDT on PA2, accelerometer on PA3, valve on PA4, key on PE0, relay on PE1.
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::dac::{DacChannel, Value};
use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_table::{MIDDLE, RATE, Table};
use embassy_time::{Duration, Ticker};
use panic_halt as _;

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let mut p = embassy_stm32::init(embassy_stm32::Config::default());
    let mut relay = Output::new(p.PE1, Level::Low, Speed::Low);
    let key = Input::new(p.PE0, Pull::Down);
    let mut adc = Adc::new(p.ADC1);
    let mut valve = DacChannel::new_blocking(p.DAC1, p.PA4);
    valve.set(Value::Bit12Right(MIDDLE));
    // Settings that are refused leave the relay open and the valve in its middle.
    let Ok(mut table) = Table::new() else { return };
    let mut ticker = Ticker::every(Duration::from_hz(RATE));
    loop {
        ticker.next().await;
        let codes = [
            adc.blocking_read(&mut p.PA1, SampleTime::CYCLES28),
            adc.blocking_read(&mut p.PA2, SampleTime::CYCLES28),
            adc.blocking_read(&mut p.PA3, SampleTime::CYCLES28),
        ];
        let (code, closed) = table.tick(codes, key.is_high());
        valve.set(Value::Bit12Right(code));
        relay.set_level(if closed { Level::High } else { Level::Low });
    }
}
