//! What the tests share: the data folder, the binary under test, small helpers.
