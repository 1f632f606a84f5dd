//! Nothing in the tree knows the machine it was written on.

use super::File;

/// Beginnings of paths that exist on one machine only. Written apart, so that this file passes its own check.
const STRAY: &[&str] = &[concat!("/wo", "rk/"), concat!("/ro", "ot/"), concat!("/ho", "me/"), concat!("C:", "\\Users")];

/// Names lines that hold such a path.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let of_file = |file: &File| -> Vec<String> {
        let lines = file.text.lines().enumerate();
        let stray = lines.filter(|(_, line)| STRAY.iter().any(|path| line.contains(path)));
        stray.map(|(i, line)| format!("{}:{}: a machine's path: {}", file.path, i + 1, line.trim())).collect()
    };
    files.iter().flat_map(of_file).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stray_path_is_named_with_its_line() {
        let text = format!("fine\nread {}me/data.csv\n", concat!("/ro", "ot/"));
        let breaches = check(&[File { path: "a.md".into(), text }]);
        assert_eq!(breaches.len(), 1);
        assert!(breaches[0].starts_with("a.md:2:"), "{breaches:?}");
    }
}
