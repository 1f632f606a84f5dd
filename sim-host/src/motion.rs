//! Ground motions: reading, conditioning, fitting to a table's limits, spectra and metrics.

pub mod fit;
