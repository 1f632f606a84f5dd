//! Experiments and the recordings they name: reading, channels, quality checks.
