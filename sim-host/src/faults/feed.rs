//! The stream of reference points as the link carries it: the core's own frames, encoded, spoilt on the way, decoded, and
//! kept in a buffer as long as the device's. Points that do not arrive are asked for again; a buffer that runs dry stops
//! the test.

use super::dice::FaultRng;
use shakedown_core::link::{Assembler, HostRequest, MAX_FRAME, MAX_POINTS, Points, encode};
use std::collections::VecDeque;

/// Points that the device's buffer holds.
const BUFFER: usize = 1024;
/// From a frame's sending to its arrival, and until the host asks whether one arrived, ticks.
const TRAVEL: u32 = 6;
const PATIENCE: u32 = 30;

/// What is wrong with the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Line {
    /// Nothing.
    Whole,
    /// No byte arrives.
    Cut,
    /// This share of the bytes has a bit flipped.
    Garbled(f64),
}

/// The stream.
#[derive(Debug, Clone)]
pub struct Feed<'a> {
    points: &'a [f64],
    buffer: VecDeque<f32>,
    /// Next point that the device wants.
    wanted: usize,
    under_way: Option<(u32, Vec<u8>)>,
    wait: u32,
}

impl<'a> Feed<'a> {
    /// A stream of `points` (m) with its buffer full.
    pub fn new(points: &'a [f64]) -> Self {
        let filled = points.len().min(BUFFER - 2);
        let buffer = points.iter().take(filled).map(|&x| x as f32).collect();
        Self { points, buffer, wanted: filled, under_way: None, wait: 0 }
    }

    /// One tick: the next point, or none where the buffer has run dry.
    pub fn tick(&mut self, line: Line, dice: &mut FaultRng) -> Option<f32> {
        self.send();
        self.arrive(line, dice);
        self.buffer.pop_front()
    }

    fn send(&mut self) {
        self.wait = self.wait.saturating_sub(1);
        let rest = self.points.get(self.wanted..).unwrap_or_default();
        if self.wait > 0 || rest.is_empty() || self.buffer.len() + MAX_POINTS + 2 > BUFFER {
            return;
        }
        let points = rest.iter().take(MAX_POINTS).map(|&x| x as f32).collect();
        let request = HostRequest::Reference(Points { first: self.wanted as u32, points, last: false });
        let mut wire = [0; MAX_FRAME];
        let length = encode(&request, &mut wire).unwrap_or(0);
        self.under_way = Some((TRAVEL, wire[..length].to_vec()));
        self.wait = PATIENCE;
    }

    fn arrive(&mut self, line: Line, dice: &mut FaultRng) {
        let Some((left, bytes)) = &mut self.under_way else { return };
        *left -= 1;
        if *left > 0 {
            return;
        }
        let mut bytes = std::mem::take(bytes);
        self.under_way = None;
        match line {
            Line::Whole => {}
            Line::Cut => return,
            Line::Garbled(share) => {
                for byte in &mut bytes {
                    if dice.chance(share) {
                        *byte ^= 1 << dice.below(8);
                    }
                }
            }
        }
        // A frame whose closing zero was hit is lost with the one behind it; the next begins afresh after a pause.
        let mut assembler = Assembler::new();
        for byte in bytes {
            if let Some(Ok(HostRequest::Reference(points))) = assembler.push::<HostRequest>(byte)
                && points.first as usize == self.wanted
            {
                self.wanted += points.points.len();
                self.buffer.extend(&points.points);
                self.wait = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(line: Line, ticks: usize) -> Vec<Option<f32>> {
        let points: Vec<f64> = (0..5000).map(|k| f64::from(k) * 1e-5).collect();
        let (mut feed, mut dice) = (Feed::new(&points), FaultRng::new(3, 1));
        (0..ticks).map(|_| feed.tick(line, &mut dice)).collect()
    }

    #[test]
    fn a_whole_line_gives_every_point_in_its_turn() {
        let heard = heard(Line::Whole, 5000);
        assert!(heard.iter().enumerate().all(|(k, x)| *x == Some((k as f64 * 1e-5) as f32)));
    }

    #[test]
    fn a_garbled_line_gives_no_wrong_point() {
        let heard = heard(Line::Garbled(2e-3), 5000);
        let got: Vec<f32> = heard.into_iter().flatten().collect();
        assert!(got.len() > 2000);
        assert!(got.iter().enumerate().all(|(k, &x)| x == (k as f64 * 1e-5) as f32));
    }

    #[test]
    fn a_cut_line_runs_dry() {
        let heard = heard(Line::Cut, 2000);
        assert_eq!(heard.iter().position(Option::is_none), Some(BUFFER - 2));
    }
}
