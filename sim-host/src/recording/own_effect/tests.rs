use super::*;

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("own.toml");
    let text = "[[effect]]\nid = \"written_and_read\"\nplace = \"flow\"\nstates = [\"displacement\"]\n\
                expression = \"tilt*displacement\"\nmistaken_for = [\"asymmetric_limit\"]\n\
                parameters.tilt = { unit = \"1/m\", low = -8.0, high = 8.0, start = 0.0, meaning = \"of gain\" }\n";
    std::fs::write(&path, text).unwrap();
    let (entries, errors) = load(&path).unwrap();
    assert!(errors.is_empty() && entries.len() == 1, "{errors:?}");
    let again = to_toml(["null_bias", "written_and_read"].into_iter());
    std::fs::write(&path, &again).unwrap();
    let (second, errors) = load(&path).unwrap();
    assert!(errors.is_empty(), "{errors:?}\n{again}");
    assert!(std::ptr::eq(entries[0], second[0]), "the same effect, word for word");
}
