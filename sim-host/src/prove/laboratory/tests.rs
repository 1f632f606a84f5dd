//! Deliberate breaks: answers that are right meet every gate, and each way of tampering with them fails the gate that is
//! there for it.

use super::super::campaign::Plan;
use super::super::record::{
    Attainable, Candidate, Estimate, Found, Location, Misstated, Named, Record, Region, Remainder, Reply, Stretch,
    TrueEffect, TrueRegion, Truth,
};
use super::summarise;

/// Cases of one kind: enough to decide the hardest gate, one in a hundred.
const CASES: u64 = 400;

fn present(id: &str, block: &str) -> TrueEffect {
    TrueEffect { id: id.into(), block: block.into(), excess: Some(50.0), ..TrueEffect::default() }
}

fn truth(stratum: &str, effects: &[(&str, &str)], unlisted: bool) -> Truth {
    let mut truth = Truth {
        stratum: stratum.into(),
        strength: (stratum != "null").then(|| "gross".into()),
        effects: effects.iter().map(|(id, block)| present(id, block)).collect(),
        unlisted: unlisted.then(|| "quadratic drag".into()),
        ..Truth::default()
    };
    truth.location.blocks = effects.iter().map(|(_, block)| (*block).into()).collect();
    if unlisted {
        truth.location.blocks.push("table".into());
        truth.unlisted_kinds = vec![present("quadratic drag", "table")];
    }
    let (what, channel) = ("drift".into(), "displacement".into());
    truth.set_up = vec![Misstated { what, channel, stated: Some(0.0), is: 1e-4, ..Misstated::default() }];
    truth
}

/// The reply that an examinee without fault gives to a truth.
fn perfect(truth: &Truth) -> Reply {
    let value = Estimate { value: 1.0, low: Some(0.5), high: Some(1.5), ..Estimate::default() };
    let named = |p: &TrueEffect| Named {
        id: p.id.clone(),
        probability: Some(0.995),
        parameters: [("size".to_string(), value)].into(),
    };
    let mut effects: Vec<Named> = truth.effects.iter().map(named).collect();
    if effects.is_empty() && truth.unlisted.is_some() {
        effects.push(Named { id: "unlisted".into(), probability: Some(0.995), ..Named::default() });
    }
    let time = truth.location.time.iter().map(|s| Stretch { run: Some("run-1.csv".into()), ..s.clone() });
    let region = |s: &TrueRegion| Region {
        variable: s.variable.clone(),
        from: Some(s.low),
        to: Some(s.high),
        ..Region::default()
    };
    let drift = Found { what: "drift".into(), channel: Some("displacement".into()), ..Found::default() };
    let missing = !effects.is_empty();
    Reply {
        verdict: if missing { "mismatch" } else { "consistent" }.into(),
        more_missing: truth.unlisted.is_some() && !truth.effects.is_empty(),
        candidates: vec![Candidate { ids: Vec::new(), probability: if missing { 0.005 } else { 0.995 } }],
        effects,
        indistinguishable: truth.groups.clone(),
        set_up: vec![drift],
        location: Some(Location {
            block: truth.location.blocks.first().cloned(),
            time: time.collect(),
            state: truth.location.state.iter().map(region).collect(),
        }),
        remainder: truth.unlisted.is_some().then_some(Remainder { share: Some(0.95) }),
        ..Reply::default()
    }
}

fn records() -> Vec<Record> {
    let pair = [("leakage", "actuator"), ("oil_compliance", "actuator")];
    let mut timed = truth("located", &pair[..1], false);
    timed.location.time = vec![Stretch { run: None, from_s: 2.0, to_s: 5.0 }];
    let mut bound = truth("located", &pair[..1], false);
    let quantiles = (0..200).map(|i| f64::from(i) / 100.0 - 1.0).collect();
    let variable = "displacement".to_string();
    bound.location.state = vec![TrueRegion { variable, low: 0.2, high: 0.9, quantiles, ..TrueRegion::default() }];
    let mut clear = truth("single", &pair[1..], false);
    clear.strength = Some("clear".into());
    let mut tied = truth("confounded", &pair[..1], false);
    tied.groups = vec![vec![pair[0].0.into(), pair[1].0.into()]];
    let mut bad = truth("bad data", &[], false);
    bad.fault = Some("stuck".into());
    let mut as_stated = truth("null", &[], false);
    as_stated.perfect_set_up = true;
    let kinds = [
        as_stated,
        truth("null", &[], false),
        truth("single", &pair[..1], false),
        clear,
        truth("pair", &pair, false),
        truth("triple", &[pair[0], pair[1], ("spring", "table")], false),
        truth("unlisted", &[], true),
        truth("listed with unlisted", &pair[..1], true),
        timed,
        bound,
        tied,
        bad,
    ];
    let of = |truth: Truth, case: u64| {
        let mut reply = perfect(&truth);
        if truth.fault.is_some() {
            reply.verdict = "bad-data".into();
        }
        // Nine intervals of ten cover, as they should.
        let value = if case % 10 == 3 { 3.0 } else { 1.2 };
        let parameters = truth.effects.iter().map(|p| (format!("{}.size", p.id), value)).collect();
        Record {
            case,
            reply,
            truth,
            seconds: 5.0,
            attainable: Some(Attainable { parameters, floor: None }),
            ..Record::default()
        }
    };
    kinds.iter().flat_map(|truth| (0..CASES).map(|case| of(truth.clone(), case))).collect()
}

fn plan() -> Plan {
    Plan {
        examiner: 2,
        lock: 0,
        strata: Vec::new(),
        kinds: Vec::new(),
        seed: 1,
        cases: CASES,
        shard: 1,
        shards: 1,
        engine: String::new(),
        quick: false,
    }
}

/// Names of the gates that are missed once every reply, or every tenth, was tampered with.
fn missed(tamper: impl Fn(&mut Record)) -> Vec<String> {
    let mut records = records();
    records.iter_mut().for_each(tamper);
    let gates = summarise(&plan(), &records).gates;
    gates.into_iter().filter(|g| g.holds == Some(false)).map(|g| g.name).collect()
}

#[test]
fn right_answers_meet_every_gate() {
    let gates = summarise(&plan(), &records()).gates;
    let others: Vec<_> = gates.iter().filter(|g| g.holds != Some(true)).map(|g| (&g.name, g.value, g.cases)).collect();
    assert!(others.is_empty(), "{others:?}");
}

/// The gate that is to fail, and what is done to a record.
type Tamper = (&'static str, Box<dyn Fn(&mut Record)>);

fn tenth(record: &Record) -> bool {
    record.case.is_multiple_of(10)
}

fn name(id: &str) -> Named {
    Named { id: id.into(), probability: Some(0.995), ..Named::default() }
}

/// Names of nulls, single effects and pairs.
fn of_nulls_singles_and_pairs() -> Vec<Tamper> {
    vec![
        (
            "nulls, set-up as stated: falsely named",
            Box::new(|r| r.reply.effects.extend((tenth(r) && r.truth.perfect_set_up).then(|| name("spring")))),
        ),
        (
            "nulls not called consistent",
            Box::new(|r| {
                if tenth(r) && r.truth.stratum == "null" {
                    r.reply.verdict = "mismatch".into();
                }
            }),
        ),
        (
            "right names, gross effect",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.effects.clear();
                }
            }),
        ),
        (
            "right names, clear effect",
            Box::new(|r| {
                if r.case.is_multiple_of(5) {
                    r.reply.effects.clear();
                }
            }),
        ),
        (
            "wrong names, clear or gross, faults in the set-up",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.effects.push(name("backlash"));
                }
            }),
        ),
        (
            "right names, any pair",
            Box::new(|r| {
                if r.case.is_multiple_of(3) {
                    r.reply.effects.truncate(1);
                }
            }),
        ),
    ]
}

/// Names in larger sets, ties, and faults of the set-up.
fn of_sets_and_set_ups() -> Vec<Tamper> {
    vec![
        (
            "right names, triple",
            Box::new(|r| {
                if r.case.is_multiple_of(3) {
                    r.reply.effects.truncate(2);
                }
            }),
        ),
        (
            "listed named and more said to be missing",
            Box::new(|r| {
                if r.case.is_multiple_of(3) {
                    r.reply.more_missing = false;
                }
            }),
        ),
        (
            "wrong name for an unlisted flaw",
            Box::new(|r| {
                if tenth(r) && r.truth.unlisted.is_some() {
                    r.reply.effects.push(name("spring"));
                }
            }),
        ),
        (
            "unlisted said where all is listed",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.more_missing = true;
                }
            }),
        ),
        (
            "tie stated where the data do not tell apart",
            Box::new(|r| {
                if r.case.is_multiple_of(3) {
                    r.reply.indistinguishable.clear();
                }
            }),
        ),
        (
            "faults of the set-up reported",
            Box::new(|r| {
                if r.case.is_multiple_of(5) {
                    r.reply.set_up.clear();
                }
            }),
        ),
        (
            "faults of the set-up claimed that are none",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.set_up.push(Found { what: "controller_kp".into(), ..Found::default() });
                }
            }),
        ),
    ]
}

/// Data, place, probabilities, intervals and time.
fn of_the_rest() -> Vec<Tamper> {
    vec![
        (
            "good recordings refused",
            Box::new(|r| {
                if r.case.is_multiple_of(50) {
                    r.reply.verdict = "bad-data".into();
                }
            }),
        ),
        (
            "bad recordings recognised",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.verdict = "mismatch".into();
                }
            }),
        ),
        (
            "block right, clear or gross effect",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.location = None;
                }
            }),
        ),
        (
            "F1 over time, flaw in a part of the run",
            Box::new(|r| {
                if let Some(l) = &mut r.reply.location {
                    l.time.iter_mut().for_each(|s| s.to_s += 3.0);
                }
            }),
        ),
        (
            "F1 over state, flaw in a region",
            Box::new(|r| {
                if let Some(l) = &mut r.reply.location {
                    l.state.iter_mut().for_each(|s| s.from = Some(-0.9));
                }
            }),
        ),
        (
            "unlisted flaw modelled: 90 % of the excess removed",
            Box::new(|r| {
                if r.case.is_multiple_of(2) {
                    r.reply.remainder = None;
                }
            }),
        ),
        (
            "calibration error beyond its expectation",
            Box::new(|r| r.reply.effects.iter_mut().for_each(|e| e.probability = Some(0.6))),
        ),
        (
            "true, of what is said with 0.99 or more",
            Box::new(|r| {
                if tenth(r) {
                    r.reply.effects.push(name("backlash"));
                }
            }),
        ),
        (
            "90 % intervals cover: oil column",
            Box::new(|r| {
                r.reply.effects.iter_mut().flat_map(|e| e.parameters.values_mut()).for_each(|p| p.high = Some(9.0));
            }),
        ),
        (
            "seconds a case at most 30",
            Box::new(|r| {
                if tenth(r) {
                    r.seconds = 60.0;
                }
            }),
        ),
    ]
}

#[test]
fn every_way_of_tampering_fails_the_gate_that_is_there_for_it() {
    let breaks = of_nulls_singles_and_pairs().into_iter().chain(of_sets_and_set_ups()).chain(of_the_rest());
    for (gate, tamper) in breaks {
        let missed = missed(tamper);
        assert!(missed.iter().any(|name| name == gate), "{gate} is not among {missed:?}");
    }
}

#[test]
fn a_gate_without_cases_decides_nothing() {
    let gates = summarise(&plan(), &[]).gates;
    assert!(gates.iter().all(|gate| gate.holds.is_none()), "{gates:?}");
}
