use super::read as read_csv;
use super::*;
use crate::files::layout::Stated;
use crate::recording::unit::Unit;
use proptest::prelude::*;

fn table(text: &str, wanted: &[&str]) -> Result<Table, String> {
    read(text.as_bytes(), Path::new("a.csv"), wanted, &Stated::default()).map_err(|e| e.to_string())
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
    assert!(refused.contains("no column"), "{refused}");
}

#[test]
fn units_in_brackets_are_read_with_blanks_too() {
    let table = table("time [s] x [mm]\n0 1\n", &["x"]).unwrap();
    assert_eq!(table.headings[0].unit.as_deref(), Some("mm"));
}

#[test]
fn messages_name_file_line_column_and_remedy() {
    let cases: [(&str, &[&str], &str); 11] = [
        ("t,x\n0,1\n1,abc\n", &["x"], "a.csv, line 3, `x`: `abc` is not a number"),
        (
            "t;x\n0;1.5\n0.5;1.5\n1;2,5\n",
            &["x"],
            "a.csv, line 4, `x`: `2,5` is not a number; the decimal sign must be a point, as in the rows before",
        ),
        ("t,x\n0,\n", &["x"], "a.csv, line 2, `x`: `` is not a number; write NaN for a sample that was dropped"),
        (
            "t,x\n\n0,1\n0,1,2\n",
            &["x"],
            "a.csv, line 4: 3 fields where the header has 2; write NaN for a sample that was dropped",
        ),
        (
            "t,x\n\n0,1,2\n",
            &["x"],
            "a.csv, line 1: the header names 2 columns, the rows below have 3; correct the header, or say how with \
             --skip-lines, --delimiter and --decimal, in an experiment under [text]",
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
            "a.csv, line 1: holds numbers; the line above the first row must be a header that names the columns",
        ),
        ("t\0,\0x\0\n\0", &["x"], "a.csv: is UTF-16 without the mark that says so: save it as UTF-8"),
        (
            "t,x\n0,1\n1,1e300\n",
            &["x"],
            "a.csv, line 3, `x`: `1e300` is beyond 1e15, which nothing measured; write NaN for a sample that was dropped",
        ),
        ("", &["x"], "a.csv: is empty; a header line that names the columns is expected"),
    ];
    for (text, wanted, message) in cases {
        assert_eq!(table(text, wanted).unwrap_err(), message);
    }
}

#[test]
fn an_endless_line_is_refused_before_it_fills_memory() {
    let endless = Read::chain("t,x\n".as_bytes(), std::io::repeat(b'1'));
    let error = read(endless, Path::new("a.csv"), &["x"], &Stated::default()).unwrap_err().to_string();
    assert!(error.contains("holds more than 1048576 bytes in one line"), "{error}");
}

proptest! {
    #[test]
    fn no_bytes_crash_the_reader(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = read(bytes.as_slice(), Path::new("a.csv"), &["x"], &Stated::default());
    }

    #[test]
    fn no_near_csv_crashes_the_reader(text in "[xt,; \t\n\r\"0-9.eN\\-\\[\\]]{0,120}") {
        let _ = table(&text, &["x"]);
        let _ = table(&format!("t,x\n{text}"), &["x"]);
    }

    #[test]
    fn what_is_written_is_read_back(values in prop::collection::vec(-1e9..1e9f64, 1..50)) {
        let rows: Vec<String> = values.iter().enumerate().map(|(k, value)| format!("{k};{value:?}")).collect();
        let text = format!("t;x [mm]\n{}", rows.join("\n"));
        prop_assert_eq!(&table(&text, &["x"]).unwrap().columns[0], &values);
    }
}

#[test]
fn other_software_is_read_as_it_writes() {
    let read = |bytes: &[u8], wanted: &[&str]| read(bytes, Path::new("a.txt"), wanted, &Stated::default()).unwrap();
    let text = "Pr\u{fc}fer: Kh\n\nZeit;Weg\ns;mm\n0,0;1,5\n0,1;-2,25\n";
    let expected = [1.5, -2.25];
    let utf16 = [0xff, 0xfe].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect::<Vec<u8>>();
    let windows: Vec<u8> = text.chars().map(|c| c as u32 as u8).collect();
    for bytes in [text.as_bytes().to_vec(), utf16, windows] {
        let table = read(&bytes, &["Weg"]);
        assert_eq!((table.columns[0].as_slice(), table.headings[0].unit.as_deref()), (&expected[..], Some("mm")));
        assert!(table.notes.join("; ").contains("decimal comma"), "{:?}", table.notes);
    }
    let labview = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n\
        ***End_of_Header***\t\n\t\nChannels\t2\t\nSamples\t2\t2\nDelta_X\t0,1\t0,1\n***End_of_Header***\t\t\t\n\
        X_Value\tWeg\tKraft\tComment\n0,0\t1,5\t3,0\n0,1\t-2,25\t4,0\n";
    let table = read(labview.as_bytes(), &["Weg", "Kraft"]);
    assert_eq!((table.columns[0].as_slice(), table.columns[1].as_slice()), (&expected[..], &[3.0, 4.0][..]));
    assert!(table.notes[0].contains("LabVIEW"), "{:?}", table.notes);
}

/// Units from the header; times of the header's, one column of them, or one for each channel; remarks; a block more.
#[test]
fn labview_states_units_and_times() {
    let head = |columns: &str| {
        format!(
            "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t{columns}\n***End_of_Header***\t\n\t\n"
        )
    };
    let read = |text: &str, wanted: &[&str]| read_csv(text.as_bytes(), Path::new("a.lvm"), wanted, &Stated::default());
    let block = "Channels\t2\nSamples\t2\t2\nY_Unit_Label\tNewtons\tm/s^2\nX_Dimension\tTime\tTime\nX0\t0.5\t0.5\n\
        Delta_X\t0.25\t0.25\n***End_of_Header***\t\t\nX_Value\tF\ta\tComment\n\t1\t2\n\t3\t4\tlost\n";
    let table = read(&(head("No") + block + "\n" + block), &["X_Value", "F", "a"]).unwrap();
    assert_eq!(table.columns, [[0.5, 0.75], [1.0, 3.0], [2.0, 4.0]]);
    let units: Vec<_> = table.headings.iter().filter_map(|h| h.unit.as_deref().and_then(Unit::in_header)).collect();
    assert_eq!(units.iter().map(|u| u.symbol).collect::<Vec<_>>(), ["s", "N", "m/s2"]);
    assert!(table.notes.join("; ").contains("in steps of 0.25 s"), "{:?}", table.notes);
    let several = "Channels\t2\nY_Unit_Label\tVolts\t\tg\t\nX_Dimension\tTime\t\tTime\n***End_of_Header***\n\
        X_Value\tu\tX_Value\ta\tComment\n0.0\t1\t0.0\t2\n0.1\t3\t0.2\t4\n";
    let table = read(&(head("Multi") + several), &["X_Value of a", "a", "u"]).unwrap();
    assert_eq!(table.columns, [[0.0, 0.2], [2.0, 4.0], [1.0, 3.0]]);
    assert_eq!(table.headings[1].unit.as_deref(), Some("g"));
    // A remark on every row, as programs of their own write it.
    let told = block.replace("\t1\t2\n\t3\t4\tlost\n", "\t1\t2\tOK\n\t3\t4\tlost\n");
    assert_eq!(read(&(head("No") + &told), &["F", "a"]).unwrap().columns, [[1.0, 3.0], [2.0, 4.0]]);
    // Times that differ from channel to channel are none of the rows'.
    let uneven = (head("No") + block).replace("Delta_X\t0.25\t0.25", "Delta_X\t0.25\t0.5");
    assert!(read(&uneven, &["X_Value"]).is_err() && read(&uneven, &["F"]).is_ok());
}

#[test]
fn an_mts_793_text_is_read() {
    let Some(path) = crate::recording::tests::data("files/mts793_specimen.dat") else { return };
    let table = crate::recording::file::read(&path, &["Laufzeit", "Ch 1 Kraft"]).unwrap();
    assert_eq!(table.headings[1].unit.as_deref(), Some("kN"));
    assert_eq!((table.columns[0][0], table.columns[1][0]), (33.549_805, -1.052_420_6));
    assert_eq!(table.columns[0].len(), 669);
    assert!(table.notes.join("; ").contains("left out"), "{:?}", table.notes);
}
