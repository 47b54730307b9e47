use saoms_core::observe::{Interest, Observer};
use saoms_core::report::RunReport;

use super::outputs::Output;
use crate::output::json;

/// The observer that writes the report as JSON (`--report`).
pub(super) struct ReportFile {
    pub(super) output: Output,
    /// True if it leaves the records of the journal out.
    pub(super) is_short: bool,
}

impl Observer for ReportFile {
    fn interest(&self) -> Interest {
        Interest::NONE
    }

    fn end(&self, report: &RunReport) {
        let short = self.is_short.then(|| report.without_records());
        let report = short.as_ref().unwrap_or(report);
        self.output.write(|to| json(to, report));
    }
}
