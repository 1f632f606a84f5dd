//! The arming step of the page: a number is given, and given back within a few seconds, before the device is asked to arm.
//!
//! It keeps a single stray key or click from arming. That another page cannot arm is for [`super::super::Admission`], and that
//! noise on the line cannot is for the device's own challenge.

use std::path::{Path, PathBuf};

/// How long the number can be confirmed, ms.
pub(crate) const CONFIRM_WITHIN: u64 = 10_000;

/// The number last given and when.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Arming {
    given: Option<(u32, u64)>,
    count: u32,
}

impl Arming {
    /// Gives a number, at `now`, ms; the one given before counts no more.
    pub(super) fn ask(&mut self, now: u64) -> u32 {
        self.count = self.count.wrapping_add(1);
        // Any number that is not the last one will do: it guards against accidents.
        let number = self.count.wrapping_mul(7919) % 9000 + 1000;
        self.given = Some((number, now));
        number
    }

    /// Takes a number back, once.
    pub(super) fn confirm(&mut self, number: u32, now: u64) -> Result<(), String> {
        match self.given.take() {
            Some((given, at)) if given == number && now < at + CONFIRM_WITHIN => Ok(()),
            Some((given, _)) if given == number => Err("the confirmation came too late; arm again".into()),
            _ => Err("there is nothing to confirm; arm again".into()),
        }
    }

    /// What was given counts no more.
    pub(super) fn forget(&mut self) {
        self.given = None;
    }
}

/// Most tests in one folder.
const TESTS: u32 = 99_999;

/// The folder of the next test: `test-001`, or the first number that is free.
pub(super) fn next_folder(folder: &Path) -> PathBuf {
    let free = (1..=TESTS).map(|number| folder.join(format!("test-{number:03}"))).find(|path: &PathBuf| !path.exists());
    free.unwrap_or_else(|| folder.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_arms_once_in_time_and_only_the_last_one() {
        let mut arming = Arming::default();
        assert!(arming.confirm(0, 0).is_err(), "nothing was given");
        let [first, second] = [arming.ask(0), arming.ask(1)];
        assert_ne!(first, second);
        assert!(arming.confirm(first, 2).is_err());
        assert!(arming.confirm(second, 2).is_err(), "a wrong answer uses the number up");
        let third = arming.ask(100);
        assert_eq!(arming.confirm(third, 100 + CONFIRM_WITHIN - 1), Ok(()));
        assert!(arming.confirm(third, 101).is_err(), "once");
        let late = arming.ask(0);
        assert!(arming.confirm(late, CONFIRM_WITHIN).unwrap_err().contains("too late"));
        let stopped = arming.ask(0);
        arming.forget();
        assert!(arming.confirm(stopped, 1).is_err());
    }

    #[test]
    fn every_test_has_a_folder_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        assert!(next_folder(folder.path()).ends_with("test-001"));
        std::fs::create_dir(folder.path().join("test-001")).unwrap();
        assert!(next_folder(folder.path()).ends_with("test-002"));
    }
}
