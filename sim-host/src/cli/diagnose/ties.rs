//! What the runs do not tell apart, in words: once for each of the named effects, with all that stand in its place.

use crate::diagnose::Diagnosis;

/// `leakage from valve_lag, command_delay`, for each set of named effects that others stand in the place of.
pub(super) fn ties(diagnosis: &Diagnosis) -> Vec<String> {
    let named: Vec<&str> = diagnosis.effects.iter().map(|effect| effect.id).collect();
    in_words(&named, &diagnosis.indistinguishable)
}

fn in_words(named: &[&str], ties: &[Vec<&'static str>]) -> Vec<String> {
    let mut grouped: Vec<(String, Vec<String>)> = Vec::new();
    for tie in ties {
        let (ours, theirs): (Vec<&str>, Vec<&str>) = tie.iter().partition(|id| named.contains(id));
        let (ours, theirs) = (ours.join(" and "), theirs.join(" and "));
        match grouped.iter_mut().find(|(known, _)| *known == ours) {
            Some((_, others)) => others.push(theirs),
            None => grouped.push((ours, vec![theirs])),
        }
    }
    let sentence = |(ours, theirs): (String, Vec<String>)| match (ours.as_str(), theirs.as_slice()) {
        ("", others) => format!("these from none at all: {}", others.join(", ")),
        (ours, [nothing]) if nothing.is_empty() => format!("{ours} from none at all"),
        (ours, others) => format!("{ours} from {}", others.join(", ")),
    };
    grouped.into_iter().map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn an_effect_is_named_once_with_all_that_stand_in_its_place() {
        let ties = [
            vec!["leakage", "valve_lag"],
            vec!["leakage", "command_delay"],
            vec!["leakage", "spring", "end_stop", "oil"],
        ];
        let words = in_words(&["leakage", "spring"], &ties);
        assert_eq!(words, ["leakage from valve_lag, command_delay", "leakage and spring from end_stop and oil"]);
        assert_eq!(in_words(&["spring", "leakage"], &[vec!["leakage"]]), ["leakage from none at all"]);
    }
}
