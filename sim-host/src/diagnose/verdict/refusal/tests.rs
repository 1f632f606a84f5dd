use super::super::Conclusion;
use super::super::tests::{concluded, with_viscous};
use super::*;

/// Names that are likelier right than wrong, beside which nothing is missing.
pub(in super::super) const SURE_NAMES: Before = Before { beside_more: false, doubtful: false };

/// A model that predicts the command far worse than nothing would is another machine's.
#[test]
fn a_command_out_of_all_proportion_refuses_names() {
    let truth = with_viscous(90.0);
    let Conclusion { stated, accepted: mut named, judging, .. } = concluded(&truth, &truth, with_viscous(50.0));
    assert_eq!(refusal(&stated, &named, &judging, SURE_NAMES), None);
    named.hold.nrmse.retain(|(channel, _)| *channel != Channel::Command);
    named.hold.nrmse.push((Channel::Command, 3.9));
    let refused = refusal(&stated, &named, &judging, SURE_NAMES);
    assert!(matches!(refused, Some(Refusal::NoSkill { channel: "command", .. })), "{refused:?}");
}

/// Names that are likelier wrong than right and leave two fifths of a mismatch beyond any noise are none; surer ones are a part of what is
/// missing, and what noise may leave says nothing of either.
#[test]
fn doubtful_names_that_leave_much_are_not_given() {
    let truth = with_viscous(90.0);
    let Conclusion { mut stated, accepted: named, judging, .. } = concluded(&truth, &truth, with_viscous(50.0));
    stated.hold.chi2 = 6.0;
    let leaving = |chi2: f64, doubtful: bool| {
        let mut named = named.clone();
        named.hold.chi2 = chi2;
        refusal(&stated, &named, &judging, Before { doubtful, ..SURE_NAMES })
    };
    assert!(matches!(leaving(3.0, true), Some(Refusal::NoGain { .. })), "{:?}", leaving(3.0, true));
    assert_eq!(leaving(3.0, false), None);
    assert_eq!(leaving(1.9, true), None);
}
