//! Every shipped composite: checks without errors, says what it shows, and runs.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, expect_diagnostics};

use crate::support::{composites, root};

fn shipped() -> Vec<PathBuf> {
    let found = composites(&root().join("composites"));
    assert!(found.len() >= 4, "{found:?}");
    found
}

#[test]
fn each_checks_without_errors() {
    for path in shipped() {
        if path.parent().unwrap().ends_with("manual") {
            // The manual's own files, as they are there, are warned of.
            let found = Fleet::of_file(&path).diagnostics();
            assert!(!found.contains("error "), "{}:\n{found}", path.display());
        } else {
            expect_diagnostics(&path);
        }
    }
}

#[test]
fn each_says_what_it_shows() {
    for path in shipped() {
        let text = fs::read_to_string(&path).unwrap();
        let head = text.split("<composite").next().unwrap();
        assert!(head.contains("<!--"), "{} opens without a comment", path.display());
    }
}

#[test]
fn each_runs_for_a_minute_and_fails_nowhere() {
    for path in shipped() {
        let report = Fleet::of_file(&path).run(1, Duration::from_secs(60));
        assert_ne!(report.outcome.status, RunStatus::Failed, "{}: {:?}", path.display(), report.outcome.reasons);
    }
}
