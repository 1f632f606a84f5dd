//! The word that was meant by one that is not known.

/// The entry of `known` that was meant by `word`, where one is near enough or begins with it.
pub(crate) fn suggestion<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(word, known)
}

/// The entry of `known` nearest to `word`, where one is near enough to have been meant; else the one that begins with it.
pub(crate) fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let lower = word.to_lowercase();
    let known: Vec<&str> = known.into_iter().collect();
    let mut begins = known.iter().filter(|k| lower.len() >= 3 && k.to_lowercase().starts_with(&lower));
    let begun = begins.next().filter(|_| begins.next().is_none()).map(|k| (*k).to_owned());
    known
        .into_iter()
        .map(|k| (edit_distance(&lower, &k.to_lowercase()), k))
        .min()
        .filter(|&(distance, k)| distance <= 1 + k.chars().count().min(word.chars().count()) / 4)
        .map(|(_, k)| k.to_owned())
        .or(begun)
}

/// Insertions, deletions, replacements and swaps of neighbours that make one word of the other. Long words are cut.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(80).collect(), b.chars().take(80).collect());
    let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            if i == 0 || j == 0 {
                table[i][j] = i.max(j);
                continue;
            }
            let replaced = table[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            table[i][j] = replaced.min(table[i - 1][j] + 1).min(table[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                table[i][j] = table[i][j].min(table[i - 2][j - 2] + 1);
            }
        }
    }
    table[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_one_that_could_have_been_meant() {
        let known = ["displacement", "velocity", "command"];
        assert_eq!(nearest("dispalcement", known).as_deref(), Some("displacement"));
        assert_eq!(nearest("Velocity", known).as_deref(), Some("velocity"));
        assert_eq!(nearest("temperature", known), None);
        assert_eq!(nearest("coulomb", ["coulomb_friction", "command"]).as_deref(), Some("coulomb_friction"));
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("ues", "use"), 1);
    }
}
