//! The tick can be read aloud: `controller.rs` is short, and `step` is followed through few functions of it.

use super::File;

/// The file of the tick.
const CONTROLLER: &str = "core/src/controller.rs";
/// Lines of code that it stays below; comments and blank lines are not counted.
const LINES: usize = 250;
/// Most functions of the file through which `step` is followed, itself not counted.
const FUNCTIONS: usize = 12;

/// What can be said of the tick: its lines of code, and the functions that `step` leads through.
pub(super) fn describe(files: &[File]) -> String {
    let (lines, through) = measure(files);
    format!("tick: {lines} lines of code, `step` through {} functions ({})", through.len(), through.join(", "))
}

/// Complains of a tick that is too long to be read.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let (lines, through) = measure(files);
    let mut breaches = Vec::new();
    if lines >= LINES {
        breaches.push(format!("{CONTROLLER}: {lines} lines of code; below {LINES}"));
    }
    if through.is_empty() || through.len() > FUNCTIONS {
        let names = through.join(", ");
        breaches.push(format!("{CONTROLLER}: `step` leads through {}, at most {FUNCTIONS}: {names}", through.len()));
    }
    breaches
}

fn measure(files: &[File]) -> (usize, Vec<String>) {
    files.iter().find(|file| file.path == CONTROLLER).map(|file| of_text(&file.text)).unwrap_or_default()
}

fn of_text(text: &str) -> (usize, Vec<String>) {
    let code = || text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    let functions = functions(text);
    let mut through: Vec<String> = Vec::new();
    let mut next = vec!["step".to_owned()];
    while let Some(name) = next.pop() {
        let Some((_, body)) = functions.iter().find(|(known, _)| *known == name) else { continue };
        for (called, _) in &functions {
            let found = [format!("self.{called}("), format!("Self::{called}(")].iter().any(|call| body.contains(call));
            if found && called != "step" && !through.contains(called) {
                through.push(called.clone());
                next.push(called.clone());
            }
        }
    }
    (code().count(), through)
}

/// The methods of a formatted file, each with its body.
fn functions(text: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        let name = line.strip_prefix("    ").filter(|rest| !rest.starts_with(' ')).and_then(name_of);
        if let Some(name) = name {
            found.push((name, String::new()));
            inside = true;
        }
        if let (true, Some((_, body))) = (inside, found.last_mut()) {
            body.push_str(line);
            body.push('\n');
        }
        inside &= line != "    }";
    }
    found
}

/// The function's name in the line that begins it.
fn name_of(line: &str) -> Option<String> {
    let (before, after) = line.split_once("fn ")?;
    let plain = before.split_whitespace().all(|word| word.starts_with("pub") || word == "const");
    plain.then(|| after.split(['(', '<']).next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: &str = "\
impl Controller {
    // A comment.
    pub fn step(&mut self) {
        self.one();
    }

    fn one(&mut self) {
        self.two(1);
        self.field.other();
    }

    const fn two(&self, count: u32) {}

    fn unused(&self) {}
}
";

    #[test]
    fn calls_are_followed_and_lines_counted() {
        assert_eq!(of_text(TICK), (11, vec!["one".to_owned(), "two".to_owned()]));
    }

    #[test]
    fn a_long_tick_is_found() {
        let file = |text: String| [File { path: CONTROLLER.into(), text }];
        assert!(check(&file(TICK.into())).is_empty());
        assert_eq!(check(&file(TICK.repeat(30))).len(), 1);
        let many: String = (0..13).map(|k| format!("    fn f{k}(&self) {{}}\n")).collect();
        let calls: String = (0..13).map(|k| format!("        self.f{k}();\n")).collect();
        assert_eq!(check(&file(format!("    fn step(&self) {{\n{calls}    }}\n{many}"))).len(), 1);
        assert_eq!(check(&[]).len(), 1);
    }
}
