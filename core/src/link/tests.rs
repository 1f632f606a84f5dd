use super::*;
use proptest::prelude::*;

fn points() -> impl Strategy<Value = HostRequest> {
    (any::<u32>(), proptest::collection::vec(-1.0f32..1.0, 0..=MAX_POINTS), any::<bool>()).prop_map(
        |(first, p, last)| {
            HostRequest::Reference(Points { first, points: heapless::Vec::from_slice(&p).unwrap(), last })
        },
    )
}

fn wire<T: Serialize>(frame: &T) -> ([u8; MAX_FRAME], usize) {
    let mut buffer = [0; MAX_FRAME];
    let length = encode(frame, &mut buffer).unwrap();
    (buffer, length)
}

/// Feeds bytes to an assembler; the frames and errors that come out.
fn receive(assembler: &mut Assembler, bytes: &[u8]) -> heapless::Vec<Result<HostRequest, LinkError>, 64> {
    bytes.iter().filter_map(|&byte| assembler.push(byte)).collect()
}

#[test]
fn the_fullest_frames_fit() {
    let record = Record { reference: 1.0, fitted: 1.0, inputs: [u16::MAX; 4], output: u16::MAX, flags: u16::MAX };
    let records = (0..MAX_BATCH).map(|_| record).collect();
    let batch = Batch { first: u32::MAX, every: u16::MAX, state: crate::State::Running, dropped: u32::MAX, records };
    let points = (0..MAX_POINTS).map(|_| 1.0).collect();
    wire(&Report::Telemetry(batch));
    wire(&HostRequest::Reference(Points { first: u32::MAX, points, last: true }));
    let name = heapless::String::try_from("sixteen letters.").unwrap();
    let byte = OptionByte { purpose: OptionPurpose::Banks, name, found: u32::MAX, wanted: u32::MAX };
    wire(&Report::Options((0..MAX_OPTIONS).map(|_| byte.clone()).collect()));
}

#[test]
fn a_zero_ends_a_frame_and_occurs_nowhere_inside() {
    let (bytes, length) = wire(&HostRequest::Arm(0));
    assert_eq!(bytes[..length].iter().position(|&b| b == 0), Some(length - 1));
}

#[test]
fn another_version_is_named() {
    let mut body = [0u8; 16];
    body[0] = VERSION + 1;
    let sum = checksum(&body[..2]);
    body[2..6].copy_from_slice(&sum.to_le_bytes());
    let mut framed = [0; 32];
    let length = cobs::encode(&body[..6], &mut framed);
    assert_eq!(decode::<HostRequest>(&mut framed[..length]), Err(LinkError::Version { theirs: VERSION + 1 }));
}

#[test]
fn an_endless_frame_is_refused_and_the_next_one_heard() {
    let mut assembler = Assembler::new();
    assert!(receive(&mut assembler, &[7; 3 * MAX_FRAME]).is_empty());
    assert_eq!(receive(&mut assembler, &[0])[..], [Err(LinkError::TooLong)]);
    let (bytes, length) = wire(&HostRequest::Stop);
    assert_eq!(receive(&mut assembler, &bytes[..length])[..], [Ok(HostRequest::Stop)]);
}

/// The first numbers of splitmix64 from 1234567, as its authors' code gives them.
#[test]
fn the_answer_is_the_published_function() {
    let mut challenge = 1_234_567_u64;
    for expected in [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423] {
        assert_eq!(answer(Challenge(challenge)), expected);
        challenge = challenge.wrapping_add(0x9E37_79B9_7F4A_7C15);
    }
}

#[test]
fn a_buffer_that_could_be_too_short_is_refused() {
    // A frame full of zeros takes a byte less than the longest of its length.
    let zeros =
        HostRequest::Reference(Points { first: 0, points: (0..MAX_POINTS).map(|_| 0.0).collect(), last: false });
    for (frame, spare) in [(HostRequest::Stop, 0), (zeros, 1)] {
        let (_, length) = wire(&frame);
        let needed = cobs::max_encoding_length(length - 2) + 1;
        assert_eq!(needed, length + spare);
        let mut buffer = [0; MAX_FRAME];
        for (room, fits) in [(needed, true), (needed + 1, true), (needed - 1, false), (0, false)] {
            let written = encode(&frame, &mut buffer[..room]);
            assert_eq!(written, if fits { Ok(length) } else { Err(LinkError::TooLong) }, "{room} of {needed}");
        }
    }
}

#[test]
fn answers_differ_from_challenges_and_from_each_other() {
    let answers = [answer(Challenge(0)), answer(Challenge(1)), answer(Challenge(2))];
    assert!(answers[0] != answers[1] && answers[1] != answers[2] && answers[0] != 0);
}

proptest! {
    #[test]
    fn what_is_sent_is_what_is_heard(request in points()) {
        let (bytes, length) = wire(&request);
        prop_assert_eq!(&receive(&mut Assembler::new(), &bytes[..length])[..], &[Ok(request)][..]);
    }

    #[test]
    fn one_wrong_bit_is_never_taken(request in points(), place in any::<prop::sample::Index>(), bit in 0..8u8) {
        let (mut bytes, length) = wire(&request);
        bytes[place.index(length)] ^= 1 << bit;
        let received = receive(&mut Assembler::new(), &bytes[..length]);
        prop_assert!(received.iter().all(Result::is_err), "{:?}", received);
    }

    #[test]
    fn a_frame_after_noise_is_heard(noise in proptest::collection::vec(any::<u8>(), 0..200)) {
        let mut assembler = Assembler::new();
        receive(&mut assembler, &noise);
        let (bytes, length) = wire(&HostRequest::Save);
        let mut stream = heapless::Vec::<u8, MAX_FRAME>::new();
        stream.push(0).unwrap();
        stream.extend_from_slice(&bytes[..length]).unwrap();
        let received = receive(&mut assembler, &stream);
        prop_assert_eq!(received.last(), Some(&Ok(HostRequest::Save)));
    }

    #[test]
    fn noise_is_never_a_frame(noise in proptest::collection::vec(any::<u8>(), 0..400)) {
        let received = receive(&mut Assembler::new(), &noise);
        prop_assert!(received.iter().all(Result::is_err));
    }
}
