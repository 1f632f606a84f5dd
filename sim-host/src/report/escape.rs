//! Text into HTML and JSON so that no string, whatever it holds, can leave its place.

use std::fmt::Write as _;

/// Escapes text for an element's content or a quoted attribute.
pub(crate) fn text(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    for c in raw.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            // HTML has no way to write these, not even as references.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Escapes running text; a pair of backticks sets what is between them as code.
pub(crate) fn prose(raw: &str) -> String {
    let parts: Vec<&str> = raw.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return text(raw); // a backtick without its partner is a backtick
    }
    parts.iter().enumerate().fold(String::new(), |mut out, (i, part)| {
        let part = text(part);
        let _ = if i % 2 == 1 { write!(out, "<code>{part}</code>") } else { write!(out, "{part}") };
        out
    })
}

/// Raises the exponents of a bracketed unit: `acceleration [m/s2]` reads `acceleration [m/s²]`. A pure number has no unit.
pub(crate) fn units(label: &str) -> String {
    let label = &without_one(label);
    let mut out = String::with_capacity(label.len());
    let mut depth = 0_u32;
    let mut last = ' ';
    for c in label.chars() {
        match c {
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        let raised = match c {
            '2' => '²',
            '3' => '³',
            c => c,
        };
        out.push(if depth > 0 && last.is_alphabetic() { raised } else { c });
        last = c;
    }
    out
}

/// A label without ` [1]`, which says of a pure number that it is one.
pub(crate) fn without_one(label: &str) -> String {
    label.replace(" [1]", "")
}

/// Makes JSON safe inside a `<script>` element: `</script>` and `<!--` cannot occur in it any more.
pub(crate) fn json(raw: &str) -> String {
    raw.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn units_are_raised_only_in_brackets() {
        assert_eq!(units("acceleration [m/s2]"), "acceleration [m/s²]");
        assert_eq!(units("E_a2, chi2 [1/s2]"), "E_a2, chi2 [1/s²]");
        assert_eq!(units("run 2 [1]"), "run 2");
    }

    #[test]
    fn code_is_set_only_between_pairs() {
        assert_eq!(prose("run `a<b` now"), "run <code>a&lt;b</code> now");
        assert_eq!(prose("5` wide"), "5` wide");
    }

    proptest! {
        #[test]
        fn no_text_opens_a_tag(raw in any::<String>()) {
            for safe in [text(&raw), prose(&raw).replace("<code>", "").replace("</code>", "")] {
                prop_assert!(!safe.contains(['<', '>', '"', '\'']), "{safe}");
                prop_assert!(!safe.contains('\0'));
            }
        }

        #[test]
        fn no_json_ends_its_script(raw in any::<String>()) {
            let value = serde_json::Value::String(raw.clone());
            let safe = json(&value.to_string());
            let unsafe_here = safe.contains(['<', '>', '\u{2028}', '\u{2029}']);
            prop_assert!(!unsafe_here);
            prop_assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), raw);
        }
    }
}
