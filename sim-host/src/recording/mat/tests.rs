use super::*;
use proptest::prelude::*;
use std::io::Write as _;

/// Builds files the way the format's description has it, little-endian.
fn element(kind: u32, data: &[u8]) -> Vec<u8> {
    let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
    bytes.extend(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

fn matrix(class: u32, dimensions: [i32; 2], name: &str, contents: &[u8]) -> Vec<u8> {
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let dimensions: Vec<u8> = dimensions.iter().flat_map(|d| d.to_le_bytes()).collect();
    let body = [element(6, &flags), element(5, &dimensions), element(1, name.as_bytes()), contents.to_vec()].concat();
    element(element::MATRIX, &body)
}

fn doubles(name: &str, dimensions: [i32; 2], values: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    matrix(6, dimensions, name, &element(9, &bytes))
}

fn text(name: &str, text: &str) -> Vec<u8> {
    matrix(4, [1, i32::try_from(text.len()).unwrap()], name, &element(16, text.as_bytes()))
}

fn structure(name: &str, dimensions: [i32; 2], fields: &[&str], contents: &[Vec<u8>]) -> Vec<u8> {
    let names: Vec<u8> = fields
        .iter()
        .flat_map(|f| {
            let mut padded = f.as_bytes().to_vec();
            padded.resize(32, 0);
            padded
        })
        .collect();
    let body = [element(5, &32i32.to_le_bytes()), element(1, &names), contents.concat()].concat();
    matrix(2, dimensions, name, &body)
}

fn compressed(variable: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(variable).unwrap();
    let packed = encoder.finish().unwrap();
    [element::COMPRESSED.to_le_bytes().to_vec(), (packed.len() as u32).to_le_bytes().to_vec(), packed].concat()
}

fn file(variables: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    bytes.extend(variables.concat());
    bytes
}

fn table(bytes: &[u8], wanted: &[&str]) -> Result<Table, String> {
    read(bytes, Path::new("a.mat"), wanted).map_err(|e| e.to_string())
}

#[test]
fn vectors_plain_and_compressed_and_columns_of_a_matrix() {
    let bytes = file(&[
        doubles("t", [3, 1], &[0.0, 0.1, 0.2]),
        compressed(&doubles("x", [1, 3], &[1.0, f64::INFINITY, 3.0])),
        matrix(9, [3, 1], "pulses", &element(2, &[0, 1, 255])),
        doubles("both", [3, 2], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
    ]);
    let table = table(&bytes, &["t", "x", "pulses", "both(:,2)"]).unwrap();
    assert_eq!(table.columns[0], [0.0, 0.1, 0.2]);
    assert!(table.columns[1][1].is_nan() && table.columns[1][2] == 3.0);
    assert_eq!(table.columns[2], [0.0, 1.0, 255.0]);
    assert_eq!(table.columns[3], [4.0, 5.0, 6.0]);
}

#[test]
fn a_recorder_s_structure_is_called_by_the_names_in_it() {
    let signal = |name: &str, values: &[f64]| {
        vec![text("", name), text("", "mm"), doubles("", [1, i32::try_from(values.len()).unwrap()], values)]
    };
    let y = structure(
        "",
        [1, 2],
        &["Name", "Unit", "Data"],
        &[signal("table x", &[1.0, 2.0]), signal("ref", &[3.0, 4.0])].concat(),
    );
    let bytes = file(&[compressed(&structure("rec", [1, 1], &["Y"], &[y]))]);
    let table = table(&bytes, &["table x", "rec.Y(2).Data"]).unwrap();
    assert_eq!(table.columns, [[1.0, 2.0], [3.0, 4.0]]);
    assert_eq!(table.headings[0].unit.as_deref(), Some("mm"));
}

#[test]
fn messages_say_what_is_wrong() {
    let good = file(&[doubles("t", [3, 1], &[0.0; 3]), doubles("kp", [1, 1], &[2.0])]);
    let cases = [
        (table(&good, &["T"]), "a.mat, `T`: no column `T`; did you mean `t`?; there are: t, kp"),
        (table(&good, &["t", "kp"]), "a.mat, `kp`: has 1 values where the first channel has 3"),
        (table(&good[..good.len() - 4], &["t"]), "a.mat: is cut off in the middle of a variable"),
        (table(b"short", &["t"]), "a.mat: is no MATLAB v5 file: it ends within its header"),
        (table(&[b' '; 200], &["t"]), "a.mat: is no MATLAB v5 file; save it with `-v7`"),
        (
            table(&file(&[doubles("t", [4, 1], &[0.0; 3])]), &["t"]),
            "a.mat: gives `t` 4 values by its dimensions but holds 3",
        ),
    ];
    for (outcome, message) in cases {
        assert_eq!(outcome.unwrap_err(), message);
    }
}

#[test]
fn a_variable_that_unfolds_without_end_is_refused() {
    let mut nested = doubles("x", [1, 1], &[1.0]);
    for _ in 0..40 {
        nested = structure("s", [1, 1], &["f"], &[nested]);
    }
    assert!(table(&file(&[nested]), &["x"]).unwrap_err().contains("nested too deep"));
    let many = structure("s", [i32::MAX, 1], &["f"], &[]);
    assert!(table(&file(&[many]), &["x"]).unwrap_err().contains("ends too early"));
}

#[test]
fn the_real_files_are_read() {
    let data = std::env::var("SHAKEDOWN_DATA").unwrap_or_else(|_| "../../shared/data".into());
    let path = Path::new(&data).join("recordings/emps/DATA_EMPS.mat");
    if !path.exists() {
        crate::skipped::without(&path);
        return;
    }
    let table = crate::recording::file::read(&path, &["t", "qg", "qm", "vir"]).unwrap();
    assert!(table.columns.iter().all(|c| c.len() == 24_841));
    let names = crate::recording::file::headings(&path.with_file_name("DATA_EMPS_PULSES.mat")).unwrap();
    let names: Vec<&str> = names.iter().map(|h| h.name.as_str()).collect();
    assert_eq!(names, ["gtau", "kp", "kv", "pulses_N", "qg", "qm", "t", "vir"]);
}

proptest! {
    #[test]
    fn no_bytes_crash_the_reader(bytes in prop::collection::vec(any::<u8>(), 0..300), pack in any::<bool>()) {
        let _ = table(&bytes, &["x"]);
        let variable = if pack { compressed(&bytes) } else { element(element::MATRIX, &bytes) };
        let _ = table(&file(&[variable]), &["x"]);
    }

    #[test]
    fn no_damaged_file_crashes_the_reader(place in 128usize..700, byte in any::<u8>()) {
        let y = structure("s", [1, 2], &["Name", "Data"], &[text("", "x"), doubles("", [1, 2], &[1.0, 2.0]), text("", "y"), doubles("", [2, 1], &[3.0, 4.0])]);
        let mut bytes = file(&[y]);
        let place = place.min(bytes.len() - 1);
        bytes[place] = byte;
        let _ = table(&bytes, &["x"]);
    }
}
