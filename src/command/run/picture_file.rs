use std::path::Path;

use saoms_api::TopicDeclaration;
use saoms_core::observe::{Interest, Observer, Sent};
use saoms_core::report::RunReport;

use super::outputs::Output;
use super::summary::outcome;
use crate::paths::Paths;

/// The observer that draws the robots' paths (`--paths`).
pub(super) struct PictureFile {
    pub(super) output: Output,
    title: String,
    paths: Paths,
}

impl PictureFile {
    pub(super) fn new(path: &Path, title: String) -> PictureFile {
        PictureFile { output: Output::new("picture", path), title, paths: Paths::default() }
    }
}

impl Observer for PictureFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn wants_topic(&self, name: &str, declared: &TopicDeclaration<'_>) -> bool {
        self.paths.wants_topic(name, declared)
    }

    fn message(&self, sent: &Sent) {
        self.paths.message(sent);
    }

    fn end(&self, report: &RunReport) {
        self.output.write(Ok(self.paths.picture(&self.title, &outcome(report))));
    }
}
