//! Every chore has one name: `cargo xtask test`.

fn main() {}
