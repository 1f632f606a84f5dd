//! Faults of the set-up: which are asked for, and what reports them.

use super::super::record::{Found, Misstated, Reply, Truth};

/// Least that a fault leaves on all rows to be asked for, in standard deviations.
const VISIBLE: f64 = 5.0;
/// Least misstatement of a noise that is asked for where its visibility was not measured: a tenth.
const NOISE: f64 = 0.1;

/// What reports a fault: kinds of a set-up finding, kinds of a data finding.
struct Names {
    set_up: &'static [&'static str],
    data: &'static [&'static str],
}

/// What reports a kind of fault, as the formats name it; none where nothing was misstated by it.
fn names(what: &str) -> Option<Names> {
    let (set_up, data): (&[&str], &[&str]) = match what {
        "controller delay" => (&["controller_delay", "sample_shift"], &["skew"]),
        // A sum of errors over a wrong interval is a wrong integral gain.
        "clock" => (&["clock_rate", "controller_ki"], &[]),
        "clock jitter" => (&["clock_jitter"], &["jittering-time"]),
        "lost rows" => (&["lost_rows"], &["missing-stretch"]),
        "sensor lag" => (&["sensor_lag", "sample_shift"], &["skew"]),
        "drift" => (&["drift", "offset"], &[]),
        "hum" => (&["hum"], &["hum"]),
        "spikes" => (&["outliers"], &[]),
        "saw-tooth" => (&["saw_tooth", "hum", "noise"], &["hum"]),
        "noise grows with motion" => (&["noise_growth", "noise"], &[]),
        "clipped" => (&["clipped"], &["clipped"]),
        "coarse counts" => (&["coarse_counts", "noise"], &["coarse-steps"]),
        "noise" => (&["noise"], &[]),
        "one-sample shift" => (&["sample_shift"], &["skew"]),
        _ => return None,
    };
    Some(Names { set_up, data })
}

/// Whether a fault is one that an examinee can be asked for.
fn asked(fault: &Misstated) -> bool {
    match (fault.what.as_str(), fault.stated, fault.sigma) {
        ("noise", None, _) | ("noise estimated" | "coloured noise", ..) => false,
        (_, _, Some(sigma)) => sigma >= VISIBLE,
        ("noise", Some(stated), None) => (stated / fault.is).ln().abs() >= NOISE,
        _ => true,
    }
}

/// Whether what was found is of this fault: its kind, its channel, and of a stated value the better half of the way to
/// what it is.
fn is_of(found: &Found, fault: &Misstated) -> bool {
    let channel = fault.channel.is_empty()
        || matches!(fault.channel.as_str(), "time" | "command")
        || found.channel.as_deref().is_none_or(|c| c == fault.channel);
    let data = names(&fault.what).is_some_and(|n| n.data.contains(&found.fault.as_str()));
    let kind = match fault.what.as_str() {
        "controller gain" => {
            found.what == format!("controller_{}", fault.quantity) || found.fault == "wrong-controller"
        }
        what => data || names(what).is_some_and(|n| n.set_up.contains(&found.what.as_str())),
    };
    kind && channel && nearer(found, fault)
}

fn nearer(found: &Found, fault: &Misstated) -> bool {
    let valued = matches!(fault.what.as_str(), "controller gain" | "noise");
    let (Some(stated), Some(value), true) = (fault.stated, found.found, valued) else { return true };
    (value - fault.is).abs() <= 0.5 * (stated - fault.is).abs()
}

/// Faults asked for, each with whether it was reported; and what was reported that is none.
pub(super) fn reported(reply: &Reply, truth: &Truth) -> (Vec<(String, bool)>, Vec<String>) {
    let named = |fault: &Misstated| reply.effects.iter().any(|e| fault.tolerated.contains(&e.id));
    let all = || reply.set_up.iter().chain(&reply.findings);
    let list = truth.set_up.iter().filter(|fault| asked(fault));
    let found = list.map(|fault| (fault.what.clone(), named(fault) || all().any(|f| is_of(f, fault)))).collect();
    // Noise and the model's own values are estimates of everybody's; no fault is claimed by stating them better.
    let claims = reply.set_up.iter().filter(|f| !matches!(f.what.as_str(), "noise" | "model_value" | ""));
    let none = claims.filter(|f| !truth.set_up.iter().any(|fault| is_of(f, fault))).map(|f| f.what.clone()).collect();
    (found, none)
}

#[cfg(test)]
mod tests {
    use super::super::super::record::{Found, Misstated, Reply, Truth};
    use super::reported;

    fn fault(what: &str, channel: &str, quantity: &str, stated: f64, is: f64) -> Misstated {
        let (what, channel, quantity) = (what.into(), channel.into(), quantity.into());
        Misstated { what, channel, quantity, stated: Some(stated), is, ..Misstated::default() }
    }

    fn claim(what: &str, channel: Option<&str>, found: f64) -> Found {
        Found { what: what.into(), channel: channel.map(Into::into), found: Some(found), ..Found::default() }
    }

    fn outcome(faults: Vec<Misstated>, claims: Vec<Found>) -> (Vec<bool>, Vec<String>) {
        let truth = Truth { set_up: faults, ..Truth::default() };
        let (asked, none) = reported(&Reply { set_up: claims, ..Reply::default() }, &truth);
        (asked.into_iter().map(|a| a.1).collect(), none)
    }

    #[test]
    fn a_gain_is_reported_by_its_own_name_and_near_its_value() {
        let kp = || vec![fault("controller gain", "command", "kp", 10.3, 10.0)];
        assert_eq!(outcome(kp(), vec![claim("controller_kp", None, 10.01)]).0, [true]);
        assert_eq!(outcome(kp(), vec![claim("controller_kp", None, 10.25)]).0, [false]);
        let other = outcome(kp(), vec![claim("controller_ki", None, 1.0)]);
        assert_eq!((other.0, other.1), (vec![false], vec!["controller_ki".to_string()]));
    }

    #[test]
    fn a_channels_fault_is_reported_of_that_channel() {
        let drift = || vec![fault("drift", "displacement", "size", 0.0, 1e-4)];
        assert_eq!(outcome(drift(), vec![claim("drift", Some("displacement"), 1e-4)]).0, [true]);
        let other = outcome(drift(), vec![claim("drift", Some("acceleration"), 1e-4)]);
        assert_eq!((other.0, other.1.len()), (vec![false], 1));
    }

    #[test]
    fn noise_is_asked_for_where_it_is_a_tenth_off() {
        assert!(outcome(vec![fault("noise", "displacement", "", 1.05, 1.0)], vec![]).0.is_empty());
        assert_eq!(outcome(vec![fault("noise", "displacement", "", 1.2, 1.0)], vec![]).0, [false]);
        assert!(outcome(vec![fault("noise estimated", "displacement", "", 1.2, 1.0)], vec![]).0.is_empty());
    }
}
