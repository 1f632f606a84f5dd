//! A recording in a binary form of other software (RPC III, TDMS, HDF5): any bytes are read or refused.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::recording::binary::{hdf5, rpc, tdms};

fuzz_target!(|bytes: &[u8]| {
    let _ = rpc::parse(bytes);
    let _ = tdms::parse(bytes);
    let _ = hdf5::parse(bytes.to_vec());
});
