use super::*;
use proptest::prelude::*;

fn table(text: &str, wanted: &[&str]) -> Result<Table, String> {
    read(text.as_bytes(), Path::new("a.csv"), wanted).map_err(|e| e.to_string())
}

#[test]
fn every_separator_gives_the_same_table() {
    let texts = [
        "time,x y,v\n0,1,2\n0.5,NaN,-3e2\n",
        "time;x y;v\r\n0;1;2\r\n0.5;nan;-3e2\r\n",
        "time\tx y\tv\n0\t1\t2\n\n0.5\tNaN\t-3e2",
        "time  \"x y\" v\n  0   1 2\n 0.5 NaN   -3e2  \n",
        "\u{feff}\ntime, x y ,v,\n0, 1,2,\n0.5,NaN ,-3e2,\n",
    ];
    for text in texts {
        let table = table(text, &["v", "x y"]).unwrap();
        assert_eq!(table.columns[0], [2.0, -300.0], "{text}");
        assert!(table.columns[1][0] == 1.0 && table.columns[1][1].is_nan(), "{text}");
    }
}

#[test]
fn a_column_without_name_or_field_is_refused() {
    let refused = table("time,x,\n0,1\n", &[""]).unwrap_err();
    assert!(refused.contains("line 2"), "{refused}");
}

#[test]
fn units_in_brackets_are_read_with_blanks_too() {
    let table = table("time [s] x [mm]\n0 1\n", &["x"]).unwrap();
    assert_eq!(table.headings[0].unit.as_deref(), Some("mm"));
}

#[test]
fn messages_name_file_line_column_and_remedy() {
    let cases: [(&str, &[&str], &str); 9] = [
        ("t,x\n0,1\n1,abc\n", &["x"], "a.csv, line 3, `x`: `abc` is not a number"),
        ("t;x\n0;1,5\n", &["x"], "a.csv, line 2, `x`: `1,5` is not a number; the decimal sign must be a point"),
        ("t,x\n0,\n", &["x"], "a.csv, line 2, `x`: `` is not a number; write NaN for a sample that was dropped"),
        (
            "t,x\n\n0,1,2\n",
            &["x"],
            "a.csv, line 3: 3 fields where the header has 2; write NaN for a sample that was dropped",
        ),
        (
            "t,displacement\n0,1\n",
            &["dispalcement"],
            "a.csv, line 1, `dispalcement`: no column `dispalcement`; did you mean `displacement`?; there are: t, displacement",
        ),
        ("x,x\n0,1\n", &["x"], "a.csv, line 1, `x`: 2 columns have this name; give each its own in the header"),
        (
            "0.1,0.2\n0,1\n",
            &["x"],
            "a.csv, line 1: holds numbers; the first line must be a header that names the columns",
        ),
        ("\u{feff}t\0,\0x\0\n\0", &["x"], "a.csv: is UTF-16 or no text at all; save it as text in UTF-8"),
        ("", &["x"], "a.csv: is empty; a header line that names the columns is expected"),
    ];
    for (text, wanted, message) in cases {
        assert_eq!(table(text, wanted).unwrap_err(), message);
    }
}

#[test]
fn an_endless_line_is_refused_before_it_fills_memory() {
    let endless = Read::chain("t,x\n".as_bytes(), std::io::repeat(b'1'));
    let error = read(endless, Path::new("a.csv"), &["x"]).unwrap_err().to_string();
    assert!(error.contains("holds more than 1048576 bytes in one line"), "{error}");
}

proptest! {
    #[test]
    fn no_bytes_crash_the_reader(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(bytes.as_slice(), Path::new("a.csv"), &["x"]);
    }

    #[test]
    fn no_near_csv_crashes_the_reader(text in "[xt,; \t\n\r\"0-9.eN\\-\\[\\]]{0,120}") {
        let _ = read(text.as_bytes(), Path::new("a.csv"), &["x"]);
        let _ = read(format!("t,x\n{text}").as_bytes(), Path::new("a.csv"), &["x"]);
    }

    #[test]
    fn what_is_written_is_read_back(values in prop::collection::vec(-1e9..1e9f64, 1..50)) {
        let rows: Vec<String> = values.iter().enumerate().map(|(k, value)| format!("{k};{value:?}")).collect();
        let text = format!("t;x [mm]\n{}", rows.join("\n"));
        prop_assert_eq!(&table(&text, &["x"]).unwrap().columns[0], &values);
    }
}
