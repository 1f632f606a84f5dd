use super::*;
use proptest::prelude::*;

fn from_text(text: &str, options: &Options) -> Result<Record, ReadError> {
    record_from_bytes(Path::new("test.txt"), text.as_bytes().to_vec(), options)
}

fn plain(text: &str) -> Result<Record, ReadError> {
    from_text(text, &Options::default())
}

fn message(result: Result<Record, ReadError>) -> String {
    result.expect_err("this cannot be read").to_string()
}

const PEER: &str = "PEER NGA STRONG MOTION DATABASE RECORD\nSomewhere, 1/1/2000, Station, 90\n\
    ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=     6, DT=   .0200 SEC\n  .1E+00  -.2E+00  .3E-01\n 0 .5 -.25\n";

const COSMOS: &str = "\
Corrected acceleration      (Format v01.20 with 13 text lines) Src: made up
Record of nothing
Hypocenter: nowhere
Origin: never
Statn No: 05- 1 Code:XX-1  Nowhere
Coords: 1.0 2.0
Recorder: none
Rcrd start time: never
Sta Chan  1: 360 deg (Rcrdr Chan  1)
Raw record length = 0.05 sec
Processed: never
Record not filtered.
Values used when parameter or data value is unknown/unspecified:   -999, -999.0
 10 Integer-header values follow on   1 lines, Format= (10I8)
       2       1       4     120       1    -999    -999   13921    -999    -999
 64 Real-header values follow on  11 lines, Format= (6F13.6)
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000      .010000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000  -999.000000
  -999.000000  -999.000000  -999.000000   -30.500000
   1 Comment line(s) follow, each starting with a \"|\":
|
       5 acceleration pts, approx    0 secs, units=cm/sec2 (04),Format=(3F10.5)
   1.50000  -30.50000   2.25000
   0.00000   7.00000
End-of-data for Chan  1 acceleration
";

#[test]
fn peer_headers_old_and_new_are_read() {
    let record = plain(PEER).unwrap();
    assert_eq!((record.dt, record.component.as_str(), record.format), (0.02, "90", Format::Peer));
    assert!((record.acceleration[1] + 0.2 * 9.80665).abs() < 1e-12);
    let old = PEER.replace("NPTS=     6, DT=   .0200 SEC", "   6   .0200    NPTS, DT");
    assert_eq!(plain(&old).unwrap().acceleration, record.acceleration);
    let dos = PEER.replace('\n', "\r\n");
    assert_eq!(plain(&dos).unwrap(), record);
    // Columns fifteen wide that touch.
    let touching = PEER.replace("  .1E+00  -.2E+00  .3E-01", "-0.10000000E-01-0.20000000E-01-0.30000000E-01");
    assert!((plain(&touching).unwrap().acceleration[2] + 0.03 * 9.80665).abs() < 1e-12);
    assert!(plain(&touching.replace("-0.10000000E-01-", "-0.1000000E-01-")).is_err(), "columns must be fifteen wide");
}

#[test]
fn cosmos_is_read_and_checked() {
    let record = plain(COSMOS).unwrap();
    assert_eq!((record.dt, record.component.as_str(), record.format), (0.01, "360 deg", Format::Cosmos));
    assert_eq!(record.acceleration.len(), 5);
    assert!((record.acceleration[1] + 0.305).abs() < 1e-12);
    let text = message(plain(&COSMOS.replace("1.50000  -30.5", "1.50000  -31.5")));
    assert!(text.contains("-30.5") && text.contains("-31.5"), "{text}");
    let text = message(plain(&COSMOS.replace("       5 accel", "       6 accel")));
    assert!(text.contains("says 6 points") && text.contains("holds 5 values"), "{text}");
    let text = message(plain(&COSMOS.replace("units=cm/sec2", "units=counts")));
    assert!(text.contains("line 30") && text.contains("counts"), "{text}");
    let twice = format!("{COSMOS}{}", COSMOS.replace("360 deg", "90 deg"));
    let second = from_text(&twice, &Options { channel: Channel::Name("90".into()), ..Options::default() }).unwrap();
    assert_eq!(second.component, "90 deg");
}

#[test]
fn columns_need_their_interval_and_unit() {
    let named = plain("time [s], acceleration [mm/s2]\n0, 100\n0.01, -200\n0.02, 300\n").unwrap();
    assert!((named.dt - 0.01).abs() < 1e-12 && (named.acceleration[1] + 0.2).abs() < 1e-12);
    assert_eq!((named.component.as_str(), named.format), ("acceleration", Format::Columns));
    let unit = Some(AccelerationUnit::Gravity);
    let options = Options { dt: Some(0.02), unit, ..Options::default() };
    let bare = from_text("# one column\n0.1\n0.2\n-0.3\n", &options).unwrap();
    assert!((bare.acceleration[2] + 0.3 * 9.80665).abs() < 1e-12 && bare.dt == 0.02);
    assert!(message(from_text("0.1\n0.2\n", &Options { unit, ..Options::default() })).contains("--dt"));
    assert!(message(from_text("0.1\n0.2\n", &Options { dt: Some(0.01), ..Options::default() })).contains("--unit"));
    let text = message(from_text("time [s];a [m/s2]\n0;1\n0.01;2\n0.02;3\n", &options));
    assert!(text.contains("0.02 s (--dt)") && text.contains("0.01 s in the file"), "{text}");
    let text = message(from_text("time [s];a [m/s2]\n0;1\n0.01;2\n0.02;3\n", &Options { unit, ..Options::default() }));
    assert!(text.contains("g (--unit)") && text.contains("m/s2 in the file"), "{text}");
}

#[test]
fn which_of_several_columns_is_never_guessed() {
    let options =
        |channel| Options { dt: Some(0.01), unit: Some(AccelerationUnit::Gravity), channel, ..Options::default() };
    let five = "1 7 3 4 5\n6 2 8 9 10\n";
    let text = message(from_text(five, &options(Channel::First)));
    assert!(text.contains("column 5") && text.contains("--channel"), "{text}");
    let third = from_text(five, &options(Channel::Number(3))).unwrap();
    assert!((third.acceleration[1] - 8.0 * 9.80665).abs() < 1e-9);
    assert_eq!(from_text(five, &options(Channel::Wrapped)).unwrap().acceleration.len(), 10);
    assert!(message(from_text("1 2\n3\n", &options(Channel::Number(1)))).contains("line 2"));
    let text = message(plain("time [s], a [g]\n0, 1\n0.01, 2\n0.03, 3\n0.04, 3\n"));
    assert!(text.contains("line 4") && text.contains("resample"), "{text}");
}

#[test]
fn gaps_are_refused_where_they_are() {
    let text = message(plain(&PEER.replace(" 0 .5 -.25", " 0 NaN -.25")));
    assert!(text.starts_with("test.txt, line 6, column 4: `NaN` is not finite"), "{text}");
    let text = message(plain("time [s], a [g]\n0, 1\n0.01, nan\n0.02, 3\n"));
    assert!(text.starts_with("test.txt, line 3, column 7: `nan` is not finite"), "{text}");
    let text = message(plain(&PEER.replace(" 0 .5 -.25", " 0 1e999 -.25")));
    assert!(text.contains("not finite"), "{text}");
    let text = message(plain(&PEER.replace(" 0 .5 -.25", " 0 5,0,3 -.25")));
    assert!(text.contains("line 6, column 4") && text.contains("not a number"), "{text}");
}

#[test]
fn contradictions_quote_both_sides() {
    let text = message(plain(&PEER.replace("NPTS=     6", "NPTS=     7")));
    assert!(text.contains("line 4") && text.contains("NPTS = 7") && text.contains("holds 6 values"), "{text}");
    let text = message(plain(&PEER.replace("UNITS OF G", "UNITS OF FURLONGS")));
    assert!(text.contains("line 3") && text.contains("FURLONGS") && text.contains("mm/s2"), "{text}");
    let text = message(plain(&PEER.replace("ACCELERATION TIME", "VELOCITY TIME")));
    assert!(text.contains("VELOCITY") && text.contains(".AT2"), "{text}");
    let text = message(plain(&PEER.replace(".0200", "20.0")));
    assert!(text.contains("interval is 20"), "{text}");
}

#[test]
fn files_that_are_no_records_are_refused() {
    let bytes = |b: &[u8]| message(record_from_bytes(Path::new("x"), b.to_vec(), &Options::default()));
    assert!(bytes(b"").contains("empty") && bytes(b" \r\n\n").contains("empty"));
    let text = bytes(b"\x7fELF\x02\x01\x01\0\0");
    assert!(text.contains("offset 4") && text.contains("0x02"), "{text}");
    assert!(bytes(b"Dear Sir,\nplease find attached").contains("not recognised from `Dear Sir,`"));
    assert!(bytes(b"UNCORRECTED ACCELEROGRAM\n1 2 3").contains("corrected accelerogram"));
    let text = message(record(Path::new("/no/such/file.AT2"), &Options::default()));
    assert_eq!(text, "/no/such/file.AT2: no such file: check the path");
    assert!(message(record(Path::new("/"), &Options::default())).contains("cannot be read"));
    assert!(
        message(plain(
            &PEER.replace("NPTS=     6", "NPTS=     1").replace("  .1E+00  -.2E+00  .3E-01\n 0 .5 -.25", "1")
        ))
        .contains("at least 16")
    );
}

#[test]
fn a_gigabyte_is_refused_before_it_is_read() {
    let file = tempfile::NamedTempFile::new().unwrap();
    // A sparse file: it has the size and takes no room.
    file.as_file().set_len(1 << 30).unwrap();
    let text = message(record(file.path(), &Options::default()));
    assert!(text.contains("1073741824 bytes") && text.contains("67108864"), "{text}");
}

#[test]
fn real_headers_that_contradict_their_data_are_refused() {
    let edit = |name: &str, from: &str, to: &str| {
        let path = super::super::tests::data(name)?;
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.contains(from), "{name} holds no {from}");
        Some(message(plain(&text.replacen(from, to, 1))))
    };
    for (name, from, to, said) in [
        ("ce36456p_CE36456.V2", "-267.957", "-367.957", ["-367.957", "-267.957"]),
        ("ce36456p_CE36456.V2", "3251 POINTS OF ACCEL", "3250 POINTS OF ACCEL", ["3250 points", "3251 values"]),
        ("ce36456p_CE36456.V2", "(UNITS: CM/SEC/SEC)", "(UNITS: M/SEC)", ["line 46", "M/SEC"]),
        ("AOM0011801241951.NS", "4.954", "9.954", ["9.954 gal", "4.954 gal"]),
        ("AOM0011801241951.NS", "102\n", "103.5\n", ["103.5 s", "10200 samples"]),
        ("AOM0011801241951.NS", "3920(gal)", "3920(mgal)", ["line 14", "mgal"]),
        ("20161113_110259_WTMC_20.V2A", "peak  -9733.1", "peak  -8733.1", ["-8733.1", "-9733.1"]),
        ("20161113_110259_WTMC_20.V2A", "points  8192", "points  8182", ["8182", "163.82"]),
        ("20161113_110259_WTMC_20.V2A", "at 0.020 sec", "at 0.010 sec", ["163.82 s", "0.01 s"]),
        ("RSN1106_KOBE_KJM000.AT2", "7500", "7505", ["7505", "7500"]),
    ] {
        let Some(text) = edit(name, from, to) else { return };
        assert!(said.iter().all(|s| text.contains(s)), "{name}, {from} to {to}: {text}");
    }
}

/// Pieces that record files are made of, so that random files reach deep into the readers.
fn piece() -> impl Strategy<Value = String> {
    prop_oneof![
        Just("PEER NGA\nx\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 3, DT= .01\n".to_owned()),
        Just("CORRECTED ACCELEROGRAM CHAN 1: 90 DEG\n 3 POINTS OF ACCEL DATA EQUALLY SPACED AT .02 SEC. (UNITS: G)\n".to_owned()),
        Just("Corrected accelerogram\nNumber of points 3 Duration 0.06 sec\ndata at 0.02 sec intervals\nComponent Up\n".to_owned()),
        Just("Acceleration: peak 3 mm/s/s\nVelocity: peak 3 mm/s\nDisplacement: peak 3 mm\n".to_owned()),
        Just("Origin Time x\nSampling Freq(Hz) 100Hz\nDuration Time(s) 1\nScale Factor 3(gal)/4\nMax. Acc. (gal) 2\nMemo.\n".to_owned()),
        Just("x (Format v01.20\n 3 Real-header values follow on 1 lines, Format=(3F8.2)\n".to_owned()),
        Just(" 3 acceleration pts, approx 1 secs, units=g (2),Format=(8f10.5)\n".to_owned()),
        Just("End-of-data\n/& ---\n".to_owned()),
        Just("time [s], a [g]\n".to_owned()),
        Just("99999999999999999999 -1e308 18446744073709551615\n".to_owned()),
        Just("1 2 3\n".to_owned()),
        Just("0.1, 0.2; -3\t4\n".to_owned()),
        "[ -~µ£é]{0,40}\n?",
        "[0-9.eE+, -]{0,30}\n?",
    ]
}

fn any_options() -> impl Strategy<Value = Options> {
    let channel = prop_oneof![
        Just(Channel::First),
        (0..5usize).prop_map(Channel::Number),
        Just(Channel::Name("up".into())),
        Just(Channel::Wrapped)
    ];
    (prop::option::of(0.0..2.0f64), channel).prop_map(|(dt, channel)| Options {
        dt,
        unit: dt.map(|_| AccelerationUnit::Gravity),
        channel,
        ..Options::default()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]
    #[test]
    fn no_bytes_crash_a_reader(bytes in prop::collection::vec(any::<u8>(), 0..2000), options in any_options()) {
        if let Ok(record) = record_from_bytes(Path::new("x"), bytes, &options) {
            prop_assert!(record.acceleration.iter().all(|a| a.is_finite()));
        }
    }

    #[test]
    fn no_mix_of_record_files_crashes_a_reader(pieces in prop::collection::vec(piece(), 0..12), options in any_options()) {
        if let Ok(record) = record_from_bytes(Path::new("x"), pieces.concat().into_bytes(), &options) {
            prop_assert!(record.dt > 0.0 && record.acceleration.len() > 1);
            prop_assert!(record.acceleration.iter().all(|a| a.is_finite()));
        }
    }

    #[test]
    fn no_damage_to_a_true_file_crashes_its_reader(at in 0..2400usize, byte in any::<u8>(), cut in 0..2400usize) {
        for text in [PEER, COSMOS] {
            let mut bytes = text.as_bytes().to_vec();
            let n = bytes.len();
            bytes[at % n] = byte;
            bytes.truncate(n - cut % n);
            let _ = record_from_bytes(Path::new("x"), bytes, &Options::default());
        }
    }
}

#[test]
fn columns_are_laid_out_as_other_software_writes_them() {
    let rows = |decimal: &str, between: &str| -> String {
        (0..20).map(|k| format!("0{decimal}{:02}{between}{}{decimal}5\n", k, k % 3)).collect()
    };
    let unit = Some(AccelerationUnit::Gravity);
    let options = Options { unit, ..Options::default() };
    let semicolon = from_text(&format!("t;acc\n{}", rows(",", ";")), &options).unwrap();
    assert!((semicolon.dt - 0.01).abs() < 1e-12 && (semicolon.acceleration[2] - 2.5 * 9.80665).abs() < 1e-9);
    assert!(semicolon.fact("layout").unwrap().contains("decimal comma, fields separated by semicolon"));
    let preamble = format!("Rig 7\nrun 3\n\ntime\tacc\ns\tm/s2\n{}", rows(".", "\t"));
    let read = plain(&preamble).unwrap();
    assert!((read.acceleration[1] - 1.5).abs() < 1e-12, "{:?}", read.facts);
    let utf16: Vec<u8> = [0xff, 0xfe].into_iter().chain(preamble.encode_utf16().flat_map(u16::to_le_bytes)).collect();
    let wide = record_from_bytes(Path::new("a.txt"), utf16, &Options::default()).unwrap();
    assert_eq!(wide.acceleration, read.acceleration);
    assert!(wide.facts.iter().any(|f| f.value == "UTF-16 text"));
}

#[test]
fn what_could_be_read_in_two_ways_is_refused() {
    let unit = Some(AccelerationUnit::Gravity);
    let options = Options { dt: Some(0.01), unit, ..Options::default() };
    let text = message(from_text(&"1,5\n2,5\n".repeat(20), &options));
    assert!(text.contains("2 ways") && text.contains("--decimal"), "{text}");
    let ms: String = (0..20).map(|k| format!("{:.3},{}\n", f64::from(k) * 0.005, k % 3)).collect();
    let text = message(plain(&format!("time [ms],a [g]\n{ms}")));
    assert!(text.contains("200000 Hz") && text.contains("correct the unit"), "{text}");
    assert!(plain(&format!("time [s],a [g]\n{ms}")).is_ok());
    let text = message(from_text(&"0\n".repeat(20), &options));
    assert!(text.contains("every one of its 20 accelerations is zero"), "{text}");
    let text = message(from_text(PEER, &Options { channel: Channel::Number(7), ..Options::default() }));
    assert!(text.contains("no channel `7`"), "{text}");
    let wide = vec!["1"; 400_000].join(" ") + "\n";
    assert!(message(from_text(&(wide.clone() + &wide), &options)).len() < 2000);
    let text = message(from_text(&"1e300\n".repeat(20), &options));
    assert!(text.contains("9.8066e300") && text.len() < 300, "{text}");
}

/// A channel of a laboratory's recording is a record: its name, its unit and its times are the file's, or the person's.
#[test]
fn a_channel_of_a_recording_is_a_record() {
    use crate::recording::binary::rpc::{Points, RpcChannel, render};
    let folder = tempfile::tempdir().unwrap();
    let wave: Vec<f64> = (0..1024).map(|k| (f64::from(k) * 0.05).sin()).collect();
    let channel = |name: &str, unit: &str| RpcChannel { name: name.into(), unit: unit.into(), values: wave.clone() };
    let path = folder.path().join("a.rsp");
    std::fs::write(
        &path,
        render(0.005, &[channel("LVDT", "mm"), channel("table", "g"), channel("raw", "")], &[], Points::Short).unwrap(),
    )
    .unwrap();
    let of = |name: &str, unit: Option<AccelerationUnit>| {
        record(&path, &Options { channel: name.parse().unwrap(), unit, ..Options::default() })
    };
    let table = of("table", None).unwrap();
    assert!((table.dt - 0.005).abs() < 1e-12 && table.component == "table");
    assert!((table.acceleration[20] / 9.80665 - 1f64.sin()).abs() < 1e-4);
    let raw = of("raw", Some(AccelerationUnit::MetrePerSecondSquared)).unwrap();
    assert!((raw.acceleration[20] - 1f64.sin()).abs() < 1e-4);
    for (channel, said) in [
        ("", "several columns: 1 (LVDT), 2 (table), 3 (raw)"),
        ("LVDT", "unit `mm`"),
        ("raw", "give it with --unit"),
        ("roof", "no channel `roof`"),
    ] {
        let text = of(channel, None).unwrap_err().to_string();
        assert!(text.contains("a.rsp: ") && text.contains(said), "{text}");
    }
    let text = of("table", Some(AccelerationUnit::MetrePerSecondSquared)).unwrap_err().to_string();
    assert!(text.contains("m/s2 (--unit) but g in the file"), "{text}");
    let rows: String = (0..40).map(|k| format!("\t{}\n", k % 3)).collect();
    let labview = format!(
        "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\nY_Unit_Label\tm/s^2\nX0\t0\nDelta_X\t0.01\n\
         ***End_of_Header***\nX_Value\tacc\tComment\n{rows}"
    );
    let path = folder.path().join("a.lvm");
    std::fs::write(&path, labview).unwrap();
    let read = record(&path, &Options::default()).unwrap();
    assert!((read.dt - 0.01).abs() < 1e-12 && read.acceleration[2] == 2.0, "{read:?}");
    assert!(read.facts.iter().any(|f| f.value.contains("times from the header")), "{:?}", read.facts);
}
