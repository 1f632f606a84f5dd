//! What a parser says of a TOML document, in the words of whoever wrote it.

use super::nearest::nearest;

/// What was found, what is known here, and the nearest of it as a question: of a message that names both between back ticks.
fn unknown(text: &str) -> Option<(&str, String, String)> {
    let names: Vec<&str> = text.split('`').skip(1).step_by(2).collect();
    let (found, known) = names.split_first()?;
    let meant = nearest(found, known.iter().copied());
    Some((found, known.join(", "), meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"))))
}

/// The message of a deserializer: unknown keys with the nearest known one, types by their names in TOML.
pub(crate) fn plain(message: &str) -> String {
    if let Some((found, known, meant)) = message.strip_prefix("unknown field ").and_then(unknown) {
        return format!("unknown key `{found}`{meant}; known here: {known}");
    }
    if let Some((found, known, meant)) = message.strip_prefix("unknown variant ").and_then(unknown) {
        return format!("`{found}` is not among {known}{meant}");
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("{key} is missing");
    }
    let typed = message.strip_prefix("invalid type: ").or_else(|| message.strip_prefix("invalid value: "));
    if let Some((found, expected)) = typed.and_then(|rest| rest.split_once(", expected ")) {
        return format!("is {} where {} is expected", kind(found), kind(expected));
    }
    message.to_owned()
}

/// A type as TOML calls it.
fn kind(name: &str) -> String {
    match name {
        "sequence" | "a sequence" => "a list".into(),
        "map" | "a map" => "a table".into(),
        "f64" | "f32" => "a number".into(),
        "usize" | "u8" | "u16" | "u32" | "u64" => "a whole number that is not negative".into(),
        "i8" | "i16" | "i32" | "i64" => "a whole number".into(),
        "path string" => "a path in quotes".into(),
        "a string" => "a text in quotes".into(),
        other => match other.split_once(' ') {
            Some(("string", value)) => format!("the text {value}"),
            Some(("integer" | "floating", value)) => {
                format!("the number {}", value.trim_start_matches("point ").trim_matches('`'))
            }
            Some(("boolean", value)) => value.trim_matches('`').to_owned(),
            Some(("struct", _)) => "a table".into(),
            _ => other.to_owned(),
        },
    }
}

/// The remedy for a line that is no TOML: a decimal comma, where it holds one.
pub(crate) fn comma(line: &str) -> &'static str {
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    let parts = value.split_once(',');
    let number = |part: &str| !part.is_empty() && part.trim_start_matches('-').bytes().all(|b| b.is_ascii_digit());
    if parts.is_some_and(|(whole, rest)| number(whole) && number(rest)) { "; the decimal sign is a point" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_deserializer_speaks_plainly() {
        for (said, wanted) in [
            (
                "unknown field `controler`, expected one of `name`, `controller`",
                "unknown key `controler`; did you mean `controller`?; known here: name, controller",
            ),
            ("unknown field `x`, expected `name`", "unknown key `x`; known here: name"),
            (
                "unknown variant `sclae`, expected one of `scale`, `trim`",
                "`sclae` is not among scale, trim; did you mean `scale`?",
            ),
            ("missing field `factor`", "`factor` is missing"),
            ("invalid type: sequence, expected a string", "is a list where a text in quotes is expected"),
            ("invalid type: string \"a\", expected f64", "is the text \"a\" where a number is expected"),
            (
                "invalid value: integer `-3`, expected usize",
                "is the number -3 where a whole number that is not negative is expected",
            ),
            ("unclosed table, expected `]`", "unclosed table, expected `]`"),
        ] {
            assert_eq!(plain(said), wanted);
        }
    }

    #[test]
    fn a_decimal_comma_is_seen() {
        assert!(!comma("b0 = 138,0").is_empty() && !comma("b0 = -1,5").is_empty());
        assert!(comma("b0 = 138.0").is_empty() && comma("x = [1,5]").is_empty() && comma("").is_empty());
    }
}
