use super::*;

fn sheet(name: &str) -> Sheet {
    Sheet::read(&folder(), name).unwrap()
}

#[test]
fn the_sheets_have_no_mistakes_and_are_drawn() {
    let items = list::items(&folder()).unwrap();
    let sheets = SHEETS.map(sheet);
    for sheet in &sheets {
        assert_eq!(sheet.mistakes(&items), Vec::<String>::new());
        kept(&format!("{}.svg", sheet.name), &draw::svg(sheet), false).unwrap();
    }
    kept("parts.csv", &list::csv(&sheets, &items), false).unwrap();
}

/// What the check is for: a pin that goes nowhere, a part that nobody can buy, a value that is none.
#[test]
fn a_mistake_is_named() {
    let items = list::items(&folder()).unwrap();
    let mut loose = sheet("input");
    loose.parts[3].pins[1] = "NOWHERE".into();
    assert!(loose.mistakes(&items)[0].contains("NOWHERE"), "{:?}", loose.mistakes(&items));
    let mut unknown = sheet("input");
    unknown.parts[1].item = "unobtainium".into();
    assert!(unknown.mistakes(&items)[0].contains("unobtainium"));
    let mut naught = sheet("input");
    naught.parts[1].value = 0.0;
    assert!(naught.mistakes(&items)[0].contains("R1"));
}

#[test]
fn a_level_and_a_rail_are_held_to_their_bounds() {
    let sheet = sheet("input");
    let trial = |name: &str| sheet.trials.iter().find(|trial| trial.name == name).unwrap();
    let holds = |name, volts| trial(name).breach(&sheet.output, volts).is_none();
    assert!(holds("0 V", 1.66) && !holds("0 V", 1.67) && !holds("0 V", 1.63));
    assert!(holds("signal wire broken", 3.5) && !holds("signal wire broken", 3.29));
    assert!(holds("amplifier saturated at -12 V", -0.2) && !holds("amplifier saturated at -12 V", 0.01));
}

#[test]
fn a_value_is_written_with_its_prefix() {
    let written = [16.5e3, 100e-9, 1e3, 10e6, 820.0, 0.0].map(list::engineering);
    assert_eq!(written, ["16.5k", "100n", "1k", "10M", "820", ""]);
}
