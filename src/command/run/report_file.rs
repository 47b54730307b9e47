use saoms_core::observe::{Interest, Observer};
use saoms_core::report::RunReport;

use super::outputs::Output;

/// The observer that writes the report as JSON (`--report`).
pub(super) struct ReportFile {
    pub(super) output: Output,
}

impl Observer for ReportFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn end(&self, report: &RunReport) {
        self.output.write(|to| {
            serde_json::to_writer_pretty(&mut *to, report)?;
            to.write_all(b"\n")
        });
    }
}
