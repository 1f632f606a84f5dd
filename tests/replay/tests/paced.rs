//! The tests of the image that run at the pace of the clock on the wall, in a binary of their own: nothing else runs beside them.

mod common;

mod device;
