use super::*;
use crate::defaults;
use proptest::prelude::*;

/// Flash that loses power after so many bytes.
struct Flash {
    slots: [[u8; SLOT]; 2],
    power_for: usize,
}

impl Flash {
    const fn erased() -> Self {
        Self { slots: [[0xFF; SLOT]; 2], power_for: usize::MAX }
    }

    fn spend(&mut self) -> Result<(), ()> {
        self.power_for = self.power_for.checked_sub(1).ok_or(())?;
        Ok(())
    }
}

impl Slots for Flash {
    type Error = ();

    fn read(&self, slot: usize, bytes: &mut [u8; SLOT]) {
        *bytes = self.slots[slot];
    }

    fn erase(&mut self, slot: usize) -> Result<(), ()> {
        for place in 0..SLOT {
            self.spend()?;
            self.slots[slot][place] = 0xFF;
        }
        Ok(())
    }

    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), ()> {
        for (place, byte) in bytes.iter().enumerate() {
            self.spend()?;
            assert_eq!(self.slots[slot][offset + place], 0xFF, "programmed twice without an erase");
            self.slots[slot][offset + place] = *byte;
        }
        Ok(())
    }
}

fn setup(every: u16) -> Setup {
    Setup { telemetry_every: every, ..defaults::setup() }
}

#[test]
fn an_erased_flash_holds_nothing() {
    assert_eq!(load(&Flash::erased()), None);
}

#[test]
fn the_last_of_many_saves_is_in_force() {
    let mut flash = Flash::erased();
    for every in 1..20 {
        save(&mut flash, &setup(every)).unwrap();
        assert_eq!(load(&flash).unwrap().setup, setup(every));
    }
}

#[test]
fn a_setup_that_does_not_hold_is_not_loaded() {
    let mut flash = Flash::erased();
    let mut bad = setup(1);
    bad.wiring.output.per_code = 0.0;
    assert_eq!(save(&mut flash, &bad), Err(SaveError::ReadBack));
    assert_eq!(load(&flash), None);
}

proptest! {
    #[test]
    fn power_lost_anywhere_leaves_the_old_or_the_new_setup(power_for in 0..2 * SLOT) {
        let mut flash = Flash::erased();
        save(&mut flash, &setup(1)).unwrap();
        save(&mut flash, &setup(2)).unwrap();
        flash.power_for = power_for;
        let saved = save(&mut flash, &setup(3));
        let found = load(&flash).unwrap().setup;
        prop_assert!(found == setup(2) && saved.is_err() || found == setup(3) && saved.is_ok());
    }

    #[test]
    fn one_wrong_bit_is_never_loaded(place in 0..100usize, bit in 0..8u8) {
        let mut flash = Flash::erased();
        save(&mut flash, &setup(7)).unwrap();
        flash.slots[0][place] ^= 1 << bit;
        let found = load(&flash);
        prop_assert!(found.is_none() || found.unwrap().setup == setup(7));
    }

    #[test]
    fn one_slot_corrupted_leaves_the_other(bytes in proptest::collection::vec(any::<u8>(), SLOT)) {
        let mut flash = Flash::erased();
        save(&mut flash, &setup(1)).unwrap();
        save(&mut flash, &setup(2)).unwrap();
        flash.slots[1].copy_from_slice(&bytes);
        prop_assert_eq!(load(&flash).unwrap().setup, setup(1));
    }
}

#[test]
fn memory_keeps_what_is_saved_and_refuses_what_lies_outside() {
    let mut memory = InMemory::erased();
    save(&mut memory, &setup(3)).unwrap();
    save(&mut memory, &setup(4)).unwrap();
    assert_eq!(load(&memory).map(|found| found.setup.telemetry_every), Some(4));
    assert_eq!(memory.erase(2), Err(OutOfRange { slot: 2, offset: 0, length: SLOT }));
    assert_eq!(memory.program(0, SLOT - 1, &[0; 2]), Err(OutOfRange { slot: 0, offset: SLOT - 1, length: 2 }));
    assert_eq!(memory.program(1, usize::MAX, &[0; 2]), Err(OutOfRange { slot: 1, offset: usize::MAX, length: 2 }));
}
