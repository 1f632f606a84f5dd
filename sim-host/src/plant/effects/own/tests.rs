use super::super::Instant;
use super::memory::Memory;
use super::program::Program;
use super::state::OwnInputs;
use super::*;
use crate::scalar::Dual;

fn program(text: &str) -> Program {
    let tree = grammar::parse(text).unwrap().resolved(&["p", "q"], &State::ALL).unwrap();
    Program::of(&tree).unwrap()
}

fn value(text: &str, x: f64, v: f64) -> f64 {
    let seen = OwnInputs { displacement: x, velocity: v, velocity_sign: v.signum(), ..OwnInputs::none() };
    let program = program(text);
    program.value(|state| seen.of(state), &[2.0, 3.0], &Memory::new(program.memories()), 0.0)
}

#[test]
fn precedence_is_that_of_the_field() {
    for (text, expected) in [
        ("p + q*x^2", 2.0 + 3.0 * 0.25),
        ("p - q - x", -1.5),
        ("p/q/x", 2.0 / 3.0 / 0.5),
        ("p*q/x*2", 24.0),
        ("p/q*x", 1.0 / 3.0),
        ("-x*p", -1.0),
        ("2^x^2", 2.0),
        ("p*exp(-abs(v)/q)", 2.0 * (-4.0f64 / 3.0).exp()),
        ("max(x, v) + min(x, v)", -3.5),
        ("sign(v)*p", -2.0),
        ("1.5e1*x", 7.5),
        ("2e-1*x", 0.1),
        ("(v)^3", -64.0),
        ("x^(-1)", 2.0),
        ("-x^2", -0.25),
        ("(-x)^2", 0.25),
        ("exp(-(x/q)^2)*1", (-1.0f64 / 36.0).exp()),
        ("p*(-x) - 1e-1", -1.1),
        ("max(-x, v)", -0.5),
        ("cos(2*pi*x)", -1.0),
    ] {
        let found = value(text, 0.5, -4.0);
        assert!((found - expected).abs() < 1e-12, "{text}: {found} for {expected}");
    }
}

#[test]
fn derivatives_agree_with_central_differences() {
    for text in [
        "p*x*abs(x) + q*x^3",
        "p*exp(-(x/q)^2)*tanh(x)",
        "sqrt(p + x^2)/q",
        "max(p*x, q)",
        "(p + x)^q",
        "p^2*ln(q + x^2)",
    ] {
        let program = program(text);
        let at = |p: f64| {
            let seen = OwnInputs { displacement: 0.7, ..OwnInputs::none() };
            program.value(|state| seen.of(state), &[p, 3.0], &Memory::new(program.memories()), 0.0)
        };
        let seen = OwnInputs { displacement: Dual::<1>::from(0.7), ..OwnInputs::none() };
        let parameters = [Dual::variable(2.0, 0), Dual::from(3.0)];
        let dual = program.value(|state| seen.of(state), &parameters, &Memory::new(program.memories()), 0.0);
        let slope = (at(2.0 + 1e-6) - at(2.0 - 1e-6)) / 2e-6;
        assert!((f64::from(dual.tangent[0]) - slope).abs() < 1e-5 * (1.0 + slope.abs()), "{text}");
    }
}

#[test]
fn units_are_read_and_written() {
    for (text, shown) in [
        ("m/s2", "m/s2"),
        ("N s/m", "kg/s"),
        ("1/(m2 s2)", "1/(m2 s2)"),
        ("Hz", "1/s"),
        ("1", "1"),
        ("rad/m", "1/m"),
        ("V s", "s u"),
    ] {
        assert_eq!(Dimension::of_unit(text).unwrap().to_string(), shown, "{text}");
    }
    for text in ["mm", "m/s/s", "lbf", "", "m0", "m-2", "(m)"] {
        assert!(Dimension::of_unit(text).is_err(), "{text}");
    }
}

fn drag(expression: &str) -> Stated {
    Stated {
        id: "a_drag_of_tests".into(),
        stage: Stage::Table,
        states: vec!["velocity".into()],
        expression: expression.into(),
        parameters: vec![StatedParameter {
            name: "drag".into(),
            unit: "1/m".into(),
            low: 0.0,
            high: 9.0,
            start: 1.0,
            meaning: String::new(),
        }],
        mistaken_for: Vec::new(),
    }
}

#[test]
fn one_name_stands_for_one_equation() {
    let own = |text| Own::new(drag(text)).unwrap();
    let first = register(own("drag*velocity*abs(velocity)")).unwrap();
    assert!(std::ptr::eq(first, register(own("drag*velocity*abs(velocity)")).unwrap()));
    let taken = register(own("drag*velocity^2")).unwrap_err();
    assert!(taken.to_string().contains("drag*velocity*abs(velocity)"));
    let effect = crate::plant::effects::build::<f64>("a_drag_of_tests", &[3.0]).unwrap();
    let at = Instant { time: 0.0, displacement: 0.0, velocity: -2.0, sensed_velocity: 0.0, velocity_limit: 1.0 };
    assert!((effect.force(&at, &[], &mut []) + 12.0).abs() < 1e-12);
}

/// A lag of half a second follows a step as the exponential does, whatever the steps; a play follows 0.1 behind.
#[test]
fn lag_and_play_remember() {
    let place = |displacement: f64| {
        let seen = OwnInputs { displacement, ..OwnInputs::none() };
        move |state| seen.of(state)
    };
    for steps in [1, 7] {
        let lag = program("lag(x, p)");
        let mut memory = Memory::new(lag.memories());
        lag.settle(place(0.0), &[0.5, 0.0], &mut memory, 0.0);
        (0..steps).for_each(|_| lag.settle(place(1.0), &[0.5, 0.0], &mut memory, 0.25 / f64::from(steps)));
        let now = lag.value(place(1.0), &[0.5, 0.0], &memory, 0.1);
        assert!((now - (1.0 - (-0.7_f64).exp())).abs() < 1e-12, "{now}");
    }
    let play = program("play(x, p)");
    let mut memory = Memory::new(play.memories());
    for (x, expected) in [(0.0, 0.0), (0.05, 0.0), (1.0, 0.9), (0.9, 0.9), (0.5, 0.6), (0.65, 0.6)] {
        play.settle(place(x), &[0.1, 0.0], &mut memory, 1e-3);
        let now = play.value(place(x), &[0.1, 0.0], &memory, 0.0);
        assert!((now - expected).abs() < 1e-12, "{x}: {now} for {expected}");
    }
}

/// A lag is in seconds, a play in the unit of what it follows; the accelerometer has no memory.
#[test]
fn what_remembers_is_checked_for_units_and_place() {
    let stated = |stage, state: &str, expression: &str, unit: &str| {
        let mut stated = drag(expression);
        (stated.stage, stated.states) = (stage, vec![state.into()]);
        stated.parameters[0].unit = unit.into();
        stated.parameters[0].low = 0.01;
        Own::new(stated)
    };
    assert!(stated(Stage::Command, "command", "lag(command, drag) - command", "s").is_ok());
    assert!(stated(Stage::Sensor, "displacement", "play(displacement, drag) - displacement", "m").is_ok());
    let refused = stated(Stage::Command, "command", "lag(command, drag) - command", "m").unwrap_err();
    assert!(refused.to_string().contains("must be a time"), "{refused}");
    let refused = stated(Stage::Sensor, "displacement", "play(displacement, drag) - displacement", "s").unwrap_err();
    assert!(refused.to_string().contains("has no unit"), "{refused}");
    let refused = stated(Stage::Sensor, "acceleration", "lag(acceleration, drag)", "s").unwrap_err();
    assert!(refused.to_string().contains("accelerometer"), "{refused}");
}
