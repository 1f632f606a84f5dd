//! Table 1 on the measured records: the rows that the paper determines come out within their bounds.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown::blocks::closed_loop::table1::{Case, Reading, checks, rows};
use shakedown::fit::read;
use shakedown::simulate::{Event, Named, Twin};
use shakedown_tests::binary::data;

#[test]
fn the_rows_that_the_paper_determines_hold() {
    let names = [
        (Event::Kobe, "records/RSN1106_KOBE_KJM000.AT2", &[Named::Strong][..]),
        (Event::ElCentro, "records/RSN6_IMPVALL.I_I-ELC180.AT2", &[Named::Current]),
        (Event::Taft, "records/RSN15_KERN_TAF021.AT2", &[Named::Current, Named::Strong]),
    ];
    let mut all = Vec::new();
    for (event, name, controllers) in names {
        let Some(path) = data(name) else { return };
        let record = read::record(&path, &read::Options::default()).unwrap();
        let case = Case::new(event, &record, false).unwrap();
        let asked: Vec<(Named, Reading)> = controllers.iter().map(|&named| (named, Reading::Tracking)).collect();
        all.extend(rows(&[case], &asked, &Twin::default(), || ()).unwrap());
    }
    let held = checks(&all);
    assert_eq!(held.len(), 9);
    for check in held {
        println!(
            "{} {} {}: {:.4}, paper {:.3}, {:+.1} % of at most {:.0} %",
            check.event.name(),
            check.named.title(),
            check.figure,
            check.value,
            check.paper,
            100.0 * check.deviation(),
            100.0 * check.bound
        );
        assert!(check.holds());
    }
}
