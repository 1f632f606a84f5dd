//! The colours of a page against what they stand on: text at 4.5 to 1, curves at 3 to 1 (WCAG 2.1, 1.4.3 and 1.4.11).

const STYLE: &str = include_str!("../../assets/report/page.css");

/// Relative luminance of `#rrggbb`.
fn luminance(colour: &str) -> f64 {
    let part = |i: usize| f64::from(u8::from_str_radix(&colour[i..i + 2], 16).unwrap()) / 255.0;
    let linear = |c: f64| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    0.2126 * linear(part(1)) + 0.7152 * linear(part(3)) + 0.0722 * linear(part(5))
}

fn contrast(a: &str, b: &str) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

/// The colour of a variable in a block of the style.
fn colour<'a>(block: &'a str, name: &str) -> &'a str {
    let at = block.find(&format!("--{name}: #")).unwrap_or_else(|| panic!("--{name}"));
    &block[at + name.len() + 4..at + name.len() + 11]
}

#[test]
fn words_and_curves_stand_out_in_light_and_in_dark() {
    let (light, dark) = STYLE.split_once("prefers-color-scheme: dark").unwrap();
    let mut low = Vec::new();
    for (scheme, block) in [("light", light), ("dark", dark)] {
        for words in ["ink", "muted", "accent"] {
            for paper in ["paper", "raised", "note-back"] {
                let found = contrast(colour(block, words), colour(block, paper));
                low.extend((found < 4.5).then(|| format!("{scheme}: {words} on {paper} {found:.2}")));
            }
        }
        for curve in (0..7).map(|i| format!("curve-{i}")).chain(["dashed", "faint", "note"].map(String::from)) {
            let found = contrast(colour(block, &curve), colour(block, "paper"));
            low.extend((found < 3.0).then(|| format!("{scheme}: {curve} {found:.2}")));
        }
    }
    assert!(low.is_empty(), "{}", low.join("\n"));
    assert!((contrast("#000000", "#ffffff") - 21.0).abs() < 1e-9);
}
