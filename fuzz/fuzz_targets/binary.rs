//! A recording in a binary form of other software (RPC III, TDMS, HDF5): any bytes are read or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::blocks::recording::{parse_hdf5, parse_rpc, parse_tdms};

fuzz_target!(|bytes: &[u8]| {
    let _ = parse_rpc(bytes);
    let _ = parse_tdms(bytes);
    let _ = parse_hdf5(bytes.to_vec());
});
