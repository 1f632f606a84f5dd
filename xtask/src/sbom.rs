//! The list of all that is built into the host tool and the firmware, as `CycloneDX` 1.5 JSON, from Cargo's own record.

use crate::boards;
use crate::output::say;
use crate::shell::{Problem, metadata, top};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// What is shipped of this workspace beside the boards' images.
const SHIPPED: [&str; 2] = ["shakedown", "shakedown-core"];

/// The chore: writes the list to a file, or prints it.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    let text = of(&[SHIPPED.map(String::from).to_vec(), boards::packages()?].concat())?;
    match words {
        [] => say(text.trim_end()),
        [path] => std::fs::write(path, text).map_err(|e| Problem::Failed(format!("{path}: {e}")))?,
        _ => return Err(Problem::Usage("sbom takes one file name, or none".into())),
    }
    Ok(())
}

/// The list of what is built into the packages named, as text.
pub(crate) fn of(shipped: &[String]) -> Result<String, Problem> {
    let list = list(&metadata(true)?, &checksums()?, shipped);
    serde_json::to_string_pretty(&list).map(|text| text + "\n").map_err(|e| Problem::Failed(e.to_string()))
}

/// Every package's SHA-256 as `Cargo.lock` pins it, by name and version.
fn checksums() -> Result<BTreeMap<(String, String), String>, Problem> {
    let path = top().join("Cargo.lock");
    let fail = |e: String| Problem::Failed(format!("{}: {e}", path.display()));
    let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
    let lock: toml::Table = text.parse().map_err(|e: toml::de::Error| fail(e.to_string()))?;
    let packages = lock.get("package").and_then(toml::Value::as_array).into_iter().flatten();
    let field = |package: &toml::Value, name: &str| package.get(name).and_then(toml::Value::as_str).map(String::from);
    Ok(packages.filter_map(|p| Some(((field(p, "name")?, field(p, "version")?), field(p, "checksum")?))).collect())
}

/// The list from `cargo metadata`: what the shipped packages need to run, tests and build-time chores left out.
fn list(metadata: &Value, checksums: &BTreeMap<(String, String), String>, shipped: &[String]) -> Value {
    let needs = needs(metadata);
    let mut reached: BTreeSet<&str> = BTreeSet::new();
    let mut open: Vec<&str> = packages(metadata)
        .filter(|p| p["source"].is_null() && shipped.iter().any(|name| name == text(p, "name")))
        .map(|p| text(p, "id"))
        .collect();
    while let Some(id) = open.pop() {
        if reached.insert(id) {
            open.extend(needs.get(id).into_iter().flatten());
        }
    }
    let parts: Vec<&Value> = packages(metadata).filter(|p| reached.contains(text(p, "id"))).collect();
    json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": {"type": "application", "name": "shakedown", "version": env!("CARGO_PKG_VERSION")}},
        "components": parts.iter().map(|p| component(p, checksums)).collect::<Vec<_>>(),
        "dependencies": parts.iter().map(|p| {
            let on = needs.get(text(p, "id")).into_iter().flatten();
            let names = on.filter_map(|id| parts.iter().find(|p| text(p, "id") == *id)).map(|p| address(p));
            json!({"ref": address(p), "dependsOn": names.collect::<Vec<_>>()})
        }).collect::<Vec<_>>(),
    })
}

fn packages(metadata: &Value) -> impl Iterator<Item = &Value> {
    metadata["packages"].as_array().into_iter().flatten()
}

fn text<'a>(value: &'a Value, field: &str) -> &'a str {
    value[field].as_str().unwrap_or_default()
}

/// Each package's needs at run time, by identifier.
fn needs(metadata: &Value) -> BTreeMap<&str, Vec<&str>> {
    let nodes = metadata["resolve"]["nodes"].as_array().into_iter().flatten();
    let normal = |dependency: &&Value| {
        dependency["dep_kinds"].as_array().into_iter().flatten().any(|kind| kind["kind"].is_null())
    };
    nodes
        .map(|node| {
            let on = node["deps"].as_array().into_iter().flatten().filter(normal).map(|d| text(d, "pkg"));
            (text(node, "id"), on.collect())
        })
        .collect()
}

/// A package's address, the same on every machine.
fn address(package: &Value) -> String {
    format!("pkg:cargo/{}@{}", text(package, "name"), text(package, "version"))
}

fn component(package: &Value, checksums: &BTreeMap<(String, String), String>) -> Value {
    let (name, version) = (text(package, "name"), text(package, "version"));
    let mut component = json!({
        "type": "library",
        "bom-ref": address(package),
        "name": name,
        "version": version,
        "purl": address(package),
    });
    if let Some(licence) = package["license"].as_str() {
        component["licenses"] =
            json!([{"expression": licence.split('/').map(str::trim).collect::<Vec<_>>().join(" OR ")}]);
    }
    if let Some(checksum) = checksums.get(&(name.to_owned(), version.to_owned())) {
        component["hashes"] = json!([{"alg": "SHA-256", "content": checksum}]);
    }
    component
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_built_in_is_listed_with_its_licence_and_hash() {
        let list = list(&metadata(true).unwrap(), &checksums().unwrap(), &SHIPPED.map(String::from));
        let parts = list["components"].as_array().unwrap();
        let named = |name: &str| parts.iter().find(|p| p["name"] == name);
        let libm = named("libm").expect("core's one dependency for functions");
        assert_eq!(libm["hashes"][0]["content"].as_str().unwrap().len(), 64);
        assert!(libm["licenses"][0]["expression"].as_str().unwrap().contains("MIT"));
        assert!(named("proptest").is_none(), "a test's dependency is not built in");
        assert!(parts.iter().all(|p| p["licenses"].is_array()), "a part without a licence");
        assert!(!list.to_string().contains("path+file"), "the list names this machine");
    }
}
