//! What every command writes as JSON is what `docs/schema` says, key by key: nothing is missing, nothing has another type, and
//! nothing is written that the schema does not describe.
//!
//! The schemas use `type`, `properties`, `required`, `items` and `additionalProperties` of JSON Schema; the check is stricter than
//! theirs, for a key that nobody documented is no error to them.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::{Value, json};
use shakedown_tests::binary::shakedown;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A schema and the command line that is held against it; earlier ones leave files for later ones.
const QUICK: [(&str, &str); 9] = [
    ("effects", "effects"),
    ("effects", "effects coulomb_friction"),
    ("run", "run --controller strong"),
    ("modify", "modify near-field-strong --method clip --out drive.csv"),
    ("run", "run --record drive.csv --controller strong"),
    ("faults", "faults --runs 4 --seed 1"),
    ("live", "live --seconds 1"),
    ("sweep", "sweep slew-rate"),
    ("init", "init recordings --force --out first.toml"),
];

/// Those that take their time.
const SLOW: [(&str, &str); 14] = [
    ("modify", "modify near-field-strong --method taut"),
    ("qualify", "qualify --synthesise x.csv --standard ac156 --sds 1.0 --z-over-h 0"),
    ("sweep", "sweep slew-rate bode"),
    ("init", "init recordings --force --out first.toml"),
    ("identify", "identify recordings/experiment.toml --out found.toml"),
    ("diagnose", "diagnose recordings/experiment.toml"),
    ("compare", "compare recordings/experiment.toml copy/experiment.toml"),
    ("design", "design found.toml"),
    ("learn", "learn --velocity 0.2 --runs 2"),
    ("prove", "prove --cases 1"),
    ("faults", "faults --runs 100 --seed 2"),
    ("table1", "table1"),
    ("bench", "bench"),
    ("demo", "demo"),
];

fn schemas() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/schema")
}

fn schema(name: &str) -> Value {
    let path = schemas().join(format!("{name}.json"));
    serde_json::from_str(&std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))).unwrap()
}

fn is(value: &Value, kind: &str) -> bool {
    match kind {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        other => panic!("the schemas use a type `{other}` that this check does not know"),
    }
}

/// What of `value` is not as `schema` says.
fn faults(value: &Value, schema: &Value, place: &str) -> Vec<String> {
    let kinds: Vec<&str> = match &schema["type"] {
        Value::String(kind) => vec![kind],
        Value::Array(kinds) => kinds.iter().filter_map(Value::as_str).collect(),
        _ => Vec::new(),
    };
    if !kinds.is_empty() && !kinds.iter().any(|kind| is(value, kind)) {
        return vec![format!("{place}: {value} is no {}", kinds.join(" or "))];
    }
    match value {
        Value::Object(members) if schema["properties"].is_object() || schema["additionalProperties"].is_object() => {
            let required = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
            let absent =
                required.filter(|key| !members.contains_key(*key)).map(|key| format!("{place}.{key}: missing"));
            let wrong = members.iter().flat_map(|(key, member)| {
                let place = format!("{place}.{key}");
                match (&schema["properties"][key], &schema["additionalProperties"]) {
                    (Value::Null, Value::Null) => vec![format!("{place}: not documented")],
                    (Value::Null, any) => faults(member, any, &place),
                    (own, _) => faults(member, own, &place),
                }
            });
            absent.chain(wrong).collect()
        }
        Value::Array(items) if schema["items"].is_object() => items
            .iter()
            .enumerate()
            .flat_map(|(k, item)| faults(item, &schema["items"], &format!("{place}[{k}]")))
            .collect(),
        _ => Vec::new(),
    }
}

/// Runs the lines and holds what they write against the schemas; figures beside it.
fn checked(lines: &[(&str, &str)]) {
    let folder = TempDir::new().unwrap();
    for name in ["recordings", "copy"] {
        let made = shakedown().current_dir(folder.path()).args(["sweep", "--write", name]).output().unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    }
    let mut wrong = Vec::new();
    for (number, (name, line)) in lines.iter().enumerate() {
        let out = folder.path().join(format!("{number}.json"));
        let figures = folder.path().join(format!("figures-{number}"));
        let mut command = shakedown();
        command.current_dir(folder.path()).args(line.split(' ')).arg("--json").arg(&out).arg("--figures").arg(&figures);
        let output = command.output().unwrap();
        assert!(out.exists(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        let read = |path: &Path| serde_json::from_str::<Value>(&std::fs::read_to_string(path).unwrap()).unwrap();
        let found = faults(&read(&out), &schema(name), name);
        wrong.extend(found.into_iter().take(12).map(|fault| format!("{line}: {fault}")));
        let drawn = read(&figures.join("figures.json"));
        wrong.extend(faults(&drawn, &schema("figures"), "figures").into_iter().take(5).map(|f| format!("{line}: {f}")));
        for figure in drawn["figures"].as_array().unwrap() {
            if let Some(file) = figure["file"].as_str() {
                let svg = std::fs::read_to_string(figures.join(file)).unwrap();
                assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{line}: {file}");
            }
        }
    }
    assert!(wrong.is_empty(), "{} faults:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn quick_commands_write_what_their_schemas_say() {
    checked(&QUICK);
}

#[test]
#[ignore = "minutes of commands: cargo xtask nightly"]
fn slow_commands_write_what_their_schemas_say() {
    checked(&SLOW);
}

/// Every schema is one that a test reads, or one of a device, which the tests of the image write.
#[test]
fn every_schema_is_read() {
    let devices = ["device-list", "device-run", "device-status", "figures"];
    let tested: Vec<&str> = QUICK.iter().chain(&SLOW).map(|(name, _)| *name).chain(devices).collect();
    for entry in std::fs::read_dir(schemas()).unwrap() {
        let name = entry.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned();
        assert!(tested.contains(&name.as_str()), "docs/schema/{name}.json is read by no test");
        assert!(schema(&name)["title"].is_string(), "{name}");
    }
}

/// The check itself: each kind of fault is found out.
#[test]
fn what_is_not_as_the_schema_says_is_found_out() {
    let schema = json!({"type": "object", "required": ["a"], "properties": {
        "a": {"type": "array", "items": {"type": ["number", "null"]}}, "b": {"type": "object", "additionalProperties": {"type": "string"}}}});
    let found = |value: Value| faults(&value, &schema, "x").join("; ");
    assert_eq!(found(json!({"a": [1, null], "b": {"any": "word"}})), "");
    assert_eq!(found(json!({"b": {}})), "x.a: missing");
    assert_eq!(found(json!({"a": [1, "2"]})), "x.a[1]: \"2\" is no number or null");
    assert_eq!(found(json!({"a": [], "c": 1})), "x.c: not documented");
    assert_eq!(found(json!({"a": [], "b": {"any": 1}})), "x.b.any: 1 is no string");
    assert_eq!(found(json!([])), "x: [] is no object");
}
