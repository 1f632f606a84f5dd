//! The firmware image in the loop, on an emulated Cortex-M4F.
