//! What a diagnosis may be told beside its experiment.

/// Is told what is being done, with a share of the whole between 0 and 1.
pub type Progress<'a> = &'a (dyn Fn(&str, f64) + Sync);

/// What a diagnosis may be told.
#[derive(Clone, Copy, Default)]
pub struct Options<'a> {
    /// Told what is being done, with a share of the whole between 0 and 1.
    pub progress: Option<Progress<'a>>,
}

impl std::fmt::Debug for Options<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Options").field("progress", &self.progress.is_some()).finish()
    }
}

impl Options<'_> {
    pub(super) fn say(&self, what: &str, share: f64) {
        if let Some(progress) = self.progress {
            progress(what, share);
        }
    }
}
