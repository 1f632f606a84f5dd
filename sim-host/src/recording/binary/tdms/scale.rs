//! The scales that a channel states for its raw values.

use super::super::bytes::Flaw;
use super::objects::Object;

/// The values in the channel's unit.
pub(super) fn apply(object: &Object, mut values: Vec<f64>, notes: &mut Vec<String>) -> Result<Vec<f64>, Flaw> {
    if object.text("NI_Scaling_Status") != Some("unscaled") {
        return Ok(values);
    }
    let count = object.number("NI_Number_Of_Scales").unwrap_or(0.0);
    // Scale 0 is the raw value itself where it has no type.
    for k in 0..(count.clamp(0.0, 100.0) as usize) {
        let key = |what: &str| format!("NI_Scale[{k}]_{what}");
        let Some(kind) = object.text(&key("Scale_Type")) else { continue };
        match kind {
            "Linear" => {
                let number = |what: &str| object.number(&key(what));
                let slope = number("Linear_Slope").ok_or_else(|| missing(&object.path, &key("Linear_Slope")))?;
                let offset = number("Linear_Y_Intercept").unwrap_or(0.0);
                for v in &mut values {
                    *v = *v * slope + offset;
                }
            }
            "Polynomial" => {
                let size = object.number(&key("Polynomial_Coefficients_Size")).unwrap_or(0.0).clamp(0.0, 32.0) as usize;
                let terms: Vec<f64> = (0..size)
                    .map(|i| object.number(&key(&format!("Polynomial_Coefficients[{i}]"))).unwrap_or(0.0))
                    .collect();
                for v in &mut values {
                    *v = terms.iter().rev().fold(0.0, |sum, c| sum * *v + c);
                }
            }
            other => {
                let channel = &object.path;
                return Err(format!(
                    "is TDMS with channel `{channel}` scaled by `{other}`, which is not read; export it scaled"
                ));
            }
        }
        notes.push(format!("`{}`: its {} scale was applied to raw values", object.path, kind.to_lowercase()));
    }
    Ok(values)
}

fn missing(channel: &str, key: &str) -> Flaw {
    format!("is TDMS with channel `{channel}` scaled without {key}; export it scaled")
}
