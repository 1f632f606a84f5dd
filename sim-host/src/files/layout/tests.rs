use super::*;
use proptest::prelude::*;

fn found(text: &str) -> Result<Layout, Unclear> {
    find(&text.lines().collect::<Vec<_>>(), &Stated::default())
}

fn refused(text: &str) -> String {
    found(text).unwrap_err().to_string()
}

#[test]
fn separators_and_decimal_signs_are_found_together() {
    use Decimal::{Comma as DecimalComma, Point};
    for (text, delimiter, decimal, width) in [
        ("a,b\n1.5,2\n2.5,3\n", Delimiter::Comma, Point, 2),
        ("a;b\n1,5;2\n2,5;3\n", Delimiter::Semicolon, DecimalComma, 2),
        ("a\tb\n1,5\t2,25\n2,5\t3\n", Delimiter::Tab, DecimalComma, 2),
        ("1,5 2,25\n2,5 3\n", Delimiter::Blank, DecimalComma, 2),
        ("1 2\n3 4\n", Delimiter::Blank, Point, 2),
        ("acceleration [g]\n1,5\n2,5\n", Delimiter::Tab, DecimalComma, 1),
        ("t [s],a [g]\n1,5\n2,5\n", Delimiter::Comma, Point, 2),
        ("0.1\n-0.2\n", Delimiter::Tab, Point, 1),
    ] {
        let layout = found(text).unwrap();
        assert_eq!((layout.delimiter, layout.decimal, layout.width), (delimiter, decimal, width), "{text}");
    }
}

#[test]
fn two_readings_are_refused_and_both_are_shown() {
    let text = refused("1,5\n2,5\n3,25\n");
    assert!(text.contains("2 ways") && text.contains("1 and 5") && text.contains("1.5"), "{text}");
    let stated = Stated { decimal: Some(Decimal::Comma), ..Stated::default() };
    let layout = find(&["1,5", "2,5"], &stated).unwrap();
    assert_eq!(layout.width, 1);
}

#[test]
fn a_header_of_another_width_is_refused() {
    let text = refused("time,a\n0,005,1,25\n0,010,1,5\n");
    assert!(text.contains("names 2 columns") && text.contains("have 4") && text.contains("decimal comma"), "{text}");
}

#[test]
fn preamble_names_and_units_are_told_from_the_rows() {
    let text = "Rig 7\nrate 100\n\nTime;Weg\ns;mm\n0,00;1,5\n0,01;1,6\n0,02;1,7\n";
    let layout = found(text).unwrap();
    assert_eq!((layout.header, layout.units, layout.first_row), (Some(3), Some(4), 5));
    assert_eq!(
        (layout.names.as_slice(), layout.column_units.as_slice()),
        (&["Time".to_owned(), "Weg".into()][..], &["s".to_owned(), "mm".into()][..])
    );
    let notes = layout.notes().join("; ");
    assert!(
        notes.contains("2 lines of preamble") && notes.contains("units in line 5") && notes.contains("decimal comma"),
        "{notes}"
    );
    assert!(found("a,b\n1.5,2\n").unwrap().notes().is_empty());
}

#[test]
fn columns_of_text_and_empty_fields_are_columns() {
    let dated = found("t;x;v\n2024-01-01 12:00:00;0,5;1,5\n2024-01-01 12:00:01;0,6;1,6\n").unwrap();
    assert_eq!((dated.width, dated.decimal, dated.delimiter), (3, Decimal::Comma, Delimiter::Semicolon));
    let empty = found("t,x\n0,\n1,\n").unwrap();
    assert_eq!((empty.width, empty.header), (2, Some(0)));
    let trailing = found("t,x,\n0,1,\n1,2,\n").unwrap();
    assert_eq!((trailing.width, trailing.names.len()), (2, 2));
    let spoilt = found("0.1\n0.2\nabc\n0.3\n").unwrap();
    assert_eq!((spoilt.first_row, spoilt.width), (0, 1));
}

#[test]
fn what_is_stated_goes_before_what_is_found() {
    let lines = ["1 2", "a b", "3 4", "5 6"];
    let layout = find(&lines, &Stated { skip_lines: Some(1), ..Stated::default() }).unwrap();
    assert_eq!((layout.header, layout.first_row, layout.names.len()), (Some(1), 2, 2));
    let units = Some(vec!["mm".to_owned()]);
    let wrong = find(&lines, &Stated { units, skip_lines: Some(1), ..Stated::default() }).unwrap_err();
    assert!(wrong.reason.contains("--units names 1"), "{wrong}");
    assert!(find(&["a", "b"], &Stated::default()).is_err());
}

/// A unit that the header contradicts is refused; another spelling of the same and nothing are not.
#[test]
fn stated_units_agree_with_the_header() {
    let lines = ["time [s],a (m/s²)", "0,1", "1,2"];
    let with = |units: [&str; 2]| {
        let units = Some(units.map(str::to_owned).to_vec());
        find(&lines, &Stated { units, ..Stated::default() }).map_err(|unclear| unclear.reason)
    };
    assert!(with(["s", "m/s^2"]).is_ok() && with(["", ""]).is_ok());
    assert!(with(["s", "g"]).unwrap_err().contains("says g of the column `a (m/s²)`"));
}

proptest! {
    #[test]
    fn no_text_crashes_it(text in "[xt,; \t\n\r\"0-9.eN\\-\\[\\]#]{0,200}", skip in 0..20usize) {
        let lines: Vec<&str> = text.lines().collect();
        let _ = find(&lines, &Stated { skip_lines: Some(skip), ..Stated::default() });
        let _ = find(&lines, &Stated::default());
    }
}
