use std::io;
use std::path::Path;

use saoms_core::observe::{Interest, Observer};
use saoms_core::report::RunReport;

use super::outputs::Output;

/// The observer that writes the report as JSON (`--report`).
pub(super) struct ReportFile {
    pub(super) output: Output,
}

impl ReportFile {
    pub(super) fn new(path: &Path) -> ReportFile {
        ReportFile { output: Output::new("report", path) }
    }
}

impl Observer for ReportFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn end(&self, report: &RunReport) {
        let text = serde_json::to_string_pretty(report).map(|text| text + "\n");
        self.output.write(text.map_err(io::Error::from));
    }
}
