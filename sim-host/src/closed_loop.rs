//! The plant's clock drives the control core: one closed-loop run.
