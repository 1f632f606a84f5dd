use super::*;
use core::cell::RefCell;
use core::convert::Infallible;
use embedded_hal::spi::{ErrorType, Operation};

/// An input converter on a mock bus, as its data sheet has it: the channels in order, from the select on.
struct MockAdc {
    volts: [f32; CHANNELS],
    /// The data line is stuck at this level.
    stuck: Option<bool>,
}

impl ErrorType for MockAdc {
    type Error = Infallible;
}

impl SpiDevice for MockAdc {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let [Operation::Read(frame)] = operations else { panic!("one read a sample") };
        let mut bits = self.volts.iter().flat_map(|volts| {
            let code = (volts / 10.0 * 32768.0).clamp(-32768.0, 32767.0) as i16;
            (0..16).rev().map(move |bit| code >> bit & 1 == 1)
        });
        for byte in frame.iter_mut() {
            *byte = (0..8).fold(0, |byte, _| {
                let bit = bits.next().expect("a channel more than the converter was asked for");
                byte << 1 | u8::from(self.stuck.unwrap_or(bit))
            });
        }
        Ok(())
    }
}

/// An output converter on a mock bus.
#[derive(Default)]
struct MockDac<'a> {
    written: Option<&'a RefCell<heapless::Vec<[u8; 3], 16>>>,
}

impl ErrorType for MockDac<'_> {
    type Error = Infallible;
}

impl SpiDevice for MockDac<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let [Operation::Write(frame)] = operations else { panic!("one write a frame") };
        self.written.unwrap().borrow_mut().push((*frame).try_into().unwrap()).unwrap();
        Ok(())
    }
}

fn read(volts: [f32; CHANNELS], stuck: Option<bool>) -> Result<[u16; INPUTS], Error<Infallible, Infallible>> {
    let log = RefCell::default();
    let mut pair = Outboard::new(MockAdc { volts, stuck }, MockDac { written: Some(&log) }).unwrap();
    let first = pair.read().map(Codes::each);
    assert_eq!(pair.read().map(Codes::each), first);
    first
}

#[test]
fn each_input_arrives_at_its_own_place() {
    assert_eq!(read([-10.0, 0.0, 5.0, 9.9997, 2.5], None), Ok([0, 32768, 49152, 65535]));
}

/// A line that is stuck would read as a table in its middle.
#[test]
fn a_data_line_that_is_stuck_gives_no_sample() {
    for (level, code) in [(false, 0x8000), (true, 0x7FFF)] {
        assert_eq!(read([1.0, 2.0, 3.0, 4.0, 2.5], Some(level)), Err(Error::Witness(code)));
    }
}

#[test]
fn a_reference_that_is_off_gives_no_sample() {
    assert!(read([0.0, 0.0, 0.0, 0.0, 2.49], None).is_ok());
    assert!(read([0.0, 0.0, 0.0, 0.0, 2.4], None).is_err());
    assert!(read([0.0, 0.0, 0.0, 0.0, 2.6], None).is_err());
}

#[test]
fn the_output_is_reset_set_and_written() {
    let log = RefCell::default();
    let adc = MockAdc { volts: [0.0; CHANNELS], stuck: None };
    let mut pair = Outboard::new(adc, MockDac { written: Some(&log) }).unwrap();
    pair.write(0x8001).unwrap();
    assert_eq!(log.borrow()[..], [[0x0F, 0, 0], [0x04, 0x02, 0x28], [0x03, 0x80, 0x01]]);
    assert_eq!(last_frame(0x8001), [0x03, 0x80, 0x01]);
}

/// The control word, field by field as the data sheet's table has them, and not as this file names them.
#[test]
fn the_control_word_powers_up_and_clears_at_mid_scale() {
    let field = |high: u16, low: u16| DAC_SETTING >> low & ((1 << (high - low + 1)) - 1);
    assert_eq!((field(10, 9), field(4, 3)), (0b01, 0b01), "clear and power-up at mid-scale");
    assert_eq!((field(5, 5), field(2, 0)), (1, 0b000), "internal reference, +/-10 V");
    assert_eq!((field(8, 8), field(7, 7), field(6, 6), field(15, 11)), (0, 0, 0, 0), "no overrange, nothing reserved");
    assert_eq!(DAC_SETTING, 0x0228);
}
