//! What the table's figures mean, and why a row differs from the paper's.

use crate::closed_loop::published::{Event, Named};
use crate::closed_loop::table1::{Reading, Row};

/// Why a row differs, in a few words; empty where it does not by much.
pub(super) fn cause(row: &Row) -> &'static str {
    match (row.named, row.event, row.reading) {
        (Named::Modified, Event::Kobe, _) => "A, B",
        (Named::Modified, _, _) => "B",
        (_, Event::Kobe, Reading::Tracking) if acceleration(row.named) => "A, C",
        (_, Event::Kobe, Reading::Damping) => "A, D",
        (_, Event::Kobe, _) => "A",
        (_, _, Reading::Damping) => "D",
        (named, _, _) if acceleration(named) => "C",
        (Named::VeloDisp, _, _) => "E",
        (_, Event::ElCentro, _) => "F",
        _ => "",
    }
}

fn acceleration(named: Named) -> bool {
    named.gains().acceleration != (0.0, 0.0)
}

/// Everything the table has to say for itself.
pub(super) fn all(real: bool) -> Vec<String> {
    let mut notes: Vec<String> = [
        "E_a (Eq. 11) and E_d (Eq. 12) are ratios of norms, the response shifted by up to 0.5 s so that each is least. The \
         paper's E_a comes out when it is read as the square of that ratio, its E_d as the ratio itself; both readings of \
         E_a are given.",
        "Records: full length, 3 s of rest before and 5 s after, causal 6th-order Butterworth low-pass at 4.7 Hz (which \
         brings the peaks to the paper's 0.740, 0.280 and 0.132 g), 0.05 Hz 2nd-order zero-phase high-pass on \
         acceleration and velocity. Accelerations are compared through a 15 Hz 4th-order zero-phase low-pass.",
        "The paper's strong stretch, 1 to 5 s, and weak one, 5 to 16 s, count from the start of its Kobe record. Records \
         here start elsewhere: its second 1 is put where 5 % of the Arias intensity has passed.",
        "A. Kobe at full size commands 0.90 m/s, nearly four times the limit. No motion within 0.242 m/s comes nearer to it \
         than E_a 0.40 (0.16 squared), so the paper's 0.058 for Modified and the small E_d of its Strong row cannot be \
         reached with it: the paper's Kobe was smaller in velocity.",
        "B. Modified clips the velocity (Eq. 10), and what is clipped is lost for good: the table ends off centre, and E_d \
         against the original record grows with it. Against the modified record, which the last columns compare with, \
         the figures are those the paper prints.",
        "C. Tracking: the acceleration PI acts on the error against the reference's acceleration, integrated twice, as the \
         text says. It then adds 10 to the displacement gain of 10, and the table follows closely; the paper's rows \
         follow at four fifths of the amplitude (E_d 0.200).",
        "D. Damping: the acceleration PI acts on the measured acceleration alone, at a quarter of the gains printed. \
         Inferred from the paper's rows, which it brings near; the paper says nothing of it. Shown beside, held to nothing.",
        "E. Velo-Disp: the scan leaves the integral gain of the velocity loop open between 0 and 1; it is 0 here. The \
         velocity is read ideally, and the loop adds 10 to the displacement gain. The paper's spikes are larger: its \
         velocity signal was not ideal.",
        "F. RSN6 is another processing of El Centro than the paper's: its peak comes to 0.254 g here, that of IELC180 to \
         0.280 g, while RSN6 gives the paper's E_d.",
    ]
    .map(String::from)
    .to_vec();
    if !real {
        notes.insert(
            0,
            "These records are generated stand-ins of the paper's peaks, so that the table runs with no file: their rows \
             are not comparable with the paper's. Give the real ones with --records DIR."
                .into(),
        );
    }
    notes
}
