//! An effect of the library with a share of its strength in each part of a range, all of them still nothing: one simulation says what a
//! little of it would do in every part.

use super::regional::{self, Along};
use super::tangent::{Shares, in_shares};
use super::{Effect, Entry, Instant, Order, Parameter, Role, build, entry};
use crate::scalar::Scalar;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// Added to the code of a variable, where the first of the further parameters says along what an effect acts.
const CODE: f64 = 20.0;
/// Widths from an inner end at which nothing is left of coming and going.
const OVER: f64 = 30.0;

/// The entry of an effect in this many parts along a variable; none for one that has no share of its strength, and none for a leakage:
/// a little of it does nothing.
pub(crate) fn in_parts(plain: &'static Entry, along: Along, parts: usize) -> Option<&'static Entry> {
    static KNOWN: Mutex<BTreeMap<(&'static str, Along, usize), &'static Entry>> = Mutex::new(BTreeMap::new());
    regional::regional(plain, along, regional::Shape::Window).filter(|_| plain.id != super::leakage::ENTRY.id)?;
    let of = || -> &'static Entry {
        let mut parameters = plain.parameters.to_vec();
        let given = (0..=parts).map(|_| further("given", Role::Given));
        parameters.extend(given.chain((0..parts).map(|_| further("share", Role::Shared))));
        Box::leak(Box::new(Entry { parameters: parameters.leak(), order: Order::Second, counter: None, ..*plain }))
    };
    Some(KNOWN.lock().ok()?.entry((plain.id, along, parts)).or_insert_with(of))
}

/// The given parameters of an effect in parts, which follow its own: along what, over what the parts' inner `ends` are smooth, and these.
/// And how many shares follow.
pub(crate) fn parameters(along: Along, width: f64, ends: &[f64]) -> (Vec<f64>, usize) {
    let code = CODE + f64::from(along as u8);
    ([code, width].into_iter().chain(ends.iter().copied()).collect(), ends.len() + 1)
}

const fn further(key: &'static str, role: Role) -> Parameter {
    regional::further(key, "1", "for a look at parts", role)
}

/// Parts of a range with a share in each.
#[derive(Debug)]
struct Parts<S> {
    along: Along,
    width: f64,
    ends: Vec<f64>,
    shares: Vec<S>,
}

impl<S: Scalar> Shares<S> for Parts<S> {
    fn share(&self, at: &Instant<f64>, command: f64) -> S {
        let s = self.along.of(at, command);
        let begins = |end: f64| {
            let x = (s - end) / self.width;
            if x.abs() < OVER { regional::rising(x) } else { f64::from(u8::from(x > 0.0)) }
        };
        let (mut share, mut begun) = (S::from(0.0), 1.0);
        for (i, &of_part) in self.shares.iter().enumerate() {
            let past = self.ends.get(i).map_or(0.0, |&end| begins(end));
            if begun > past {
                share = share.plus_scaled(of_part, begun - past);
            }
            begun = past;
        }
        share
    }
}

/// The effect where its further parameters say that it is in parts.
pub(super) fn placed<S: Scalar>(id: &str, parameters: &[S]) -> Option<Box<dyn Effect<S>>> {
    let (own, further) = parameters.split_at_checked(entry(id)?.parameters.len())?;
    let &[code, width, ref rest @ ..] = further else { return None };
    let along = Along::ALL.into_iter().find(|along| CODE + f64::from(*along as u8) == code.value())?;
    let (ends, shares) = rest.split_at_checked(rest.len() / 2)?;
    let plain = |values: &[S]| -> Vec<f64> { values.iter().map(|value| value.value()).collect() };
    let parts =
        Parts { along, width: width.value().abs().max(f64::MIN_POSITIVE), ends: plain(ends), shares: shares.to_vec() };
    Some(in_shares(build(id, &plain(own))?, Box::new(parts)))
}

#[cfg(test)]
mod tests;
