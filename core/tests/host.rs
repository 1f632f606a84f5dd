//! What every host is told by numbers: codes, requests, samples, status words, the answers to a tape and their digest.

use shakedown_core::host::{self, Answer, Damaged, Digest, Player, REQUESTS, code};
use shakedown_core::settings::NameError;
use shakedown_core::{
    Channels, Command, Controller, OperatorRequest, Refused, Relay, Sample, Settings, SettingsError, State, Trip,
};

const GUARDED: &str = "rate = 500\ndisplacement.proportional = 10\n[guard]\n";

/// The content of a record of a sample.
fn content(numbers: [f32; 9], flags: u32) -> Vec<u8> {
    numbers.iter().flat_map(|x| x.to_le_bytes()).chain(flags.to_le_bytes()).collect()
}

fn done(code: i32) -> Answer {
    [code as u32, 0, 0, 0]
}

#[test]
fn every_outcome_has_the_number_that_hosts_know() {
    let refused =
        [Refused::State(State::Off), Refused::StillMoving(Trip::Jerk), Refused::Cause(Trip::Jerk), Refused::NoGuard];
    assert_eq!(refused.map(host::refused_code), [4, 5, 6, 7]);
    assert_eq!([NameError::Unknown { line: 3 }, NameError::Value { line: 3 }].map(host::name_code), [8, 9]);
    let refusals = |text: &str| host::settings_code(&Controller::new(&host::settings(text).unwrap()).unwrap_err());
    assert_eq!(refusals("rate = -1"), code::OUT_OF_RANGE);
    let contradiction = SettingsError::Contradiction { field: "a", with: "b" };
    assert_eq!(host::settings_code(&contradiction), 2);
    assert_eq!(host::settings("# nothing"), Ok(Settings::default()));
}

#[test]
fn a_request_has_its_number_on_every_host() {
    let mut controller = Controller::new(&host::settings(GUARDED).unwrap()).unwrap();
    for _ in 0..50 {
        controller.step(&Sample::new(0.0, 0.0, 0.0));
    }
    assert_eq!(host::request(&mut controller, 1), code::REFUSED_STATE);
    assert_eq!(host::request(&mut controller, 0), code::OK);
    assert_eq!(controller.state(), State::Ready);
    assert_eq!(host::request(&mut controller, 1), code::OK);
    assert_eq!(controller.state(), State::Running);
    assert_eq!(host::request(&mut controller, REQUESTS.len() as u32), code::UNKNOWN_REQUEST);
    assert_eq!(REQUESTS[7], OperatorRequest::Trip);
}

#[test]
fn a_sample_takes_its_numbers_in_order_and_its_flags_by_bits() {
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
    for flags in 0..4 {
        let expected = Sample {
            reference: 1.0,
            displacement: 2.0,
            acceleration: 3.0,
            external: 4.0,
            velocity: 5.0,
            pressure_difference: 6.0,
            reference_velocity: 7.0,
            reference_acceleration: 8.0,
            second_displacement: 9.0,
            limit_switch: flags % 2 == 1,
            relay_closed: flags > 1,
        };
        assert_eq!(host::sample(&numbers, flags), expected);
    }
}

#[test]
fn a_status_word_has_every_field_in_its_place() {
    let mut command = Command::default();
    (command.status.saturated, command.status.held, command.status.limited) = (true, false, true);
    (command.status.relay, command.status.state) = (Relay::Open, State::Tripped);
    (command.status.trip, command.status.missing) = (Some(Trip::Velocity), Channels::DISPLACEMENT);
    let expected = 0b0101 | 5 << 4 | (Trip::Velocity as u32) << 8 | 2 << 16 | 9 << 24;
    assert_eq!(host::status(&command, 9), expected);
    (command.status.held, command.status.relay) = (true, Relay::Closed);
    assert_eq!(host::status(&command, 9), expected | 0b1010);
}

/// A tape gives the bits that calls of the controller give.
#[test]
fn a_player_answers_as_its_controller_does() {
    let mut player = Player::new();
    let mut controller = Controller::new(&host::settings(GUARDED).unwrap()).unwrap();
    assert_eq!(player.play(1, GUARDED.as_bytes()), Ok(done(code::OK)));
    let mut moved = false;
    for tick in 0..2000_u32 {
        if let Some(number) = [50, 60].iter().position(|at| *at == tick) {
            assert_eq!(player.play(3, &(number as u32).to_le_bytes()), Ok(done(code::OK)));
            controller.request(REQUESTS[number]).unwrap();
        }
        let x = 1e-5 * tick as f32;
        let command = controller.step(&Sample { relay_closed: true, ..Sample::new(x, 0.0, 0.1) });
        let numbers = [command.valve, command.reference, command.status.velocity_limit].map(f32::to_bits);
        let answer = player.play(4, &content([x, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 2)).unwrap();
        assert_eq!(answer[..3], numbers);
        assert_eq!(answer[3], host::status(&command, controller.changes()));
        moved |= command.valve != 0.0;
    }
    assert!(moved && player.controller().state() == controller.state());
    assert_eq!(player.relay(), controller.relay());
}

/// A retune is the same controller with other settings, a begin another one; what is refused leaves it as it was.
#[test]
fn a_retune_goes_on_and_a_begin_does_not() {
    let mut player = Player::default();
    player.play(1, GUARDED.as_bytes()).unwrap();
    for _ in 0..50 {
        player.play(4, &content([0.0; 9], 0)).unwrap();
    }
    assert_eq!(player.play(3, &0_u32.to_le_bytes()), Ok(done(code::OK)));
    for (text, expected) in
        [("rat = 1", code::UNKNOWN_NAME), ("rate = no", code::WRONG_VALUE), ("rate = -1", code::OUT_OF_RANGE)]
    {
        assert_eq!(player.play(2, text.as_bytes()), Ok(done(expected)), "{text}");
        assert_eq!(player.controller().state(), State::Ready);
    }
    assert_eq!(player.play(2, GUARDED.replace("proportional = 10", "proportional = 8").as_bytes()), Ok(done(code::OK)));
    assert_eq!(player.controller().state(), State::Ready);
    assert_eq!(player.play(1, GUARDED.as_bytes()), Ok(done(code::OK)));
    assert_eq!(player.controller().state(), State::Off);
}

#[test]
fn a_damaged_record_is_named_by_its_tag() {
    let mut player = Player::new();
    let short = content([0.0; 9], 0);
    for (tag, content) in [(0, &b""[..]), (5, b""), (3, b"abc"), (4, &short[..39]), (1, b"\xff"), (2, b"\xff")] {
        assert_eq!(player.play(tag, content), Err(Damaged { tag }));
    }
    assert_eq!(Player::TAGS, [1, 2, 3, 4]);
    assert!(Damaged { tag: 7 }.to_string().contains('7'));
}

/// Values of the FNV-1a reference (Fowler, Noll, Vo), 64 bits.
#[test]
fn a_digest_is_fnv_1a() {
    let of = |bytes: &[u8]| {
        let mut digest = Digest::default();
        digest.bytes(bytes);
        digest
    };
    assert_eq!(of(b""), Digest(0xcbf2_9ce4_8422_2325));
    assert_eq!(of(b"foobar"), Digest(0x8594_4171_f739_67e8));
    let mut digest = Digest::new();
    digest.answer([0x6f6f_6601, 2, 3, 0xff00_0004]);
    assert_eq!(digest, of(&[0x01, 0x66, 0x6f, 0x6f, 2, 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0xff]));
}
