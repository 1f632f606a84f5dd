//! What takes longest of the command line and the library behind it, in one binary: each is a test or two, beside which the
//! other processor would stand idle.

mod drives;
mod paper_table;
mod set_up;
mod severe_saturation;
mod tutorial;
mod wrong_input;
