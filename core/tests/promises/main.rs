//! What the core promises, one file a subject: each promise as a property or an analytic answer, and for each that
//! matters a deliberate break that shows the test can fail.

#[cfg(test)]
mod any_input;
#[cfg(test)]
mod blocks;
#[cfg(test)]
mod creep;
#[cfg(test)]
mod exchange;
#[cfg(test)]
mod guard;
#[cfg(test)]
mod guard_limits;
#[cfg(test)]
mod link_shape;
#[cfg(test)]
mod modes;
#[cfg(test)]
mod noise;
#[cfg(test)]
mod plain_law;
#[cfg(test)]
mod saturation;
#[cfg(test)]
mod settings;
#[cfg(test)]
mod table;
#[cfg(test)]
mod tracking;
#[cfg(test)]
mod units;
#[cfg(test)]
mod wiring;
#[cfg(test)]
mod witness;
