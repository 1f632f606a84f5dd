use super::*;
use core::cell::{Cell, RefCell};
use core::convert::Infallible;
use embedded_hal::spi::ErrorType;

/// An input converter on a mock bus, as its data sheet has it: registers, and a sample one frame late.
#[derive(Default)]
struct MockAdc<'a> {
    volts: [f32; INPUTS],
    ranges: [u8; INPUTS],
    selected: usize,
    missing: Option<&'a Cell<bool>>,
}

impl ErrorType for MockAdc<'_> {
    type Error = Infallible;
}

impl SpiDevice for MockAdc<'_> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let [Operation::TransferInPlace(frame)] = operations else { panic!("one exchange a frame") };
        if self.missing.is_some_and(Cell::get) {
            frame.fill(0xFF);
            return Ok(());
        }
        match **frame {
            [address, value, ref mut echo] => {
                assert_eq!(address & 1, 1, "a write");
                self.ranges[usize::from((address >> 1) - RANGE_REGISTER)] = value;
                *echo = value;
            }
            [high, _, ref mut top, ref mut bottom] => {
                assert_eq!(high & 0xC0, 0xC0, "a channel selected by hand");
                let code = ((self.volts[self.selected] / 10.24 + 1.0) * 32768.0) as u16;
                [*top, *bottom] = code.to_be_bytes();
                self.selected = usize::from((high - 0xC0) >> 2);
            }
            _ => panic!("a frame of {} bytes", frame.len()),
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

#[test]
fn each_input_arrives_at_its_own_place() {
    let log = RefCell::default();
    let adc = MockAdc { volts: [-10.24, 0.0, 5.12, 10.239], ranges: [9; INPUTS], ..MockAdc::default() };
    let mut pair = Outboard::new(adc, MockDac { written: Some(&log) }).unwrap();
    for _ in 0..3 {
        assert_eq!(pair.read().unwrap().each(), [0, 32768, 49152, 65532]);
    }
    assert_eq!(pair.input.ranges, [RANGE_10V; INPUTS]);
}

#[test]
fn the_output_is_reset_set_and_written() {
    let log = RefCell::default();
    let mut pair = Outboard::new(MockAdc::default(), MockDac { written: Some(&log) }).unwrap();
    pair.write(0x8001).unwrap();
    assert_eq!(log.borrow()[..], [[0x0F, 0, 0], [0x04, 0x02, 0x28], [0x03, 0x80, 0x01]]);
}

#[test]
fn a_converter_that_is_not_there_is_named() {
    let (log, missing) = (RefCell::default(), Cell::new(true));
    let adc = MockAdc { missing: Some(&missing), ..MockAdc::default() };
    let made = Outboard::new(adc, MockDac { written: Some(&log) });
    assert_eq!(made.err(), Some(Error::ReadBack { register: 0x05, read: 0xFF }));
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
