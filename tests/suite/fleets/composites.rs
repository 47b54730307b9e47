//! Every shipped composite: checks without errors, says what it shows, and runs.

use std::fs;
use std::time::Duration;

use saoms_core::report::RunStatus;
use saoms_testkit::{Fleet, expect_diagnostics};

use crate::support::{code, saoms, shipped, stderr, stdout};

#[test]
fn the_contribution_of_two_teams_shares_the_work() {
    let checked = saoms(&["check", "composites/teams"]);
    assert_eq!(stdout(&checked), "9 components: 0 errors, 0 warnings\n", "{}", stderr(&checked));
    let run = saoms(&["run", "composites/teams", "--virtual"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let shown = stdout(&run);
    assert!(shown.contains("20 of 20 pieces of luggage delivered, no collision, 0 stranded"), "{shown}");
    for robot in 1..=6 {
        let team = if robot <= 3 { "West" } else { "East" };
        assert!(shown.contains(&format!("{team}/Robot{robot}    deposited luggage")), "robot {robot}: {shown}");
    }
}

#[test]
fn two_sites_from_one_composite_do_not_hear_each_other() {
    let checked = saoms(&["check", "--wiring", "composites/sites"]);
    let wiring = stdout(&checked);
    assert!(wiring.ends_with("13 components: 0 errors, 0 warnings\n"), "{wiring}{}", stderr(&checked));
    assert!(wiring.contains("North/ETOPIC") && wiring.contains("South/ETOPIC"), "{wiring}");
    let run = saoms(&["run", "composites/sites", "--virtual"]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let shown = stdout(&run);
    assert!(shown.contains("25 of 25 pieces of luggage delivered, no collision, 0 stranded"), "{shown}");
    let delivered = |site: &str| {
        let of_site = shown.lines().filter(|line| line.contains(&format!("{site}/Robot")));
        of_site.filter(|line| line.contains("deposited luggage")).count()
    };
    assert_eq!((delivered("North"), delivered("South")), (10, 15), "{shown}");
}

#[test]
fn robots_of_two_sites_in_one_world_are_judged_together() {
    let robot = |name: &str, number: u32| {
        format!(
            "<component name=\"{name}\" saoms:site=\"{name}\"><implementation.rust class=\"saoms.Robot\"/>\
             <property name=\"ID\">Robot{number}</property><property name=\"period\">100ms</property>\
             <reference name=\"world\" target=\"World\"/></component>"
        )
    };
    let fleet = |robots: String| {
        let text = format!(
            "<composite xmlns=\"http://docs.oasis-open.org/ns/opencsa/sca/200912\" xmlns:saoms=\"urn:saoms:1\" name=\"f\" \
             targetNamespace=\"urn:f\"><component name=\"World\"><implementation.rust class=\"saoms.World\"/>\
             <property name=\"ID\">World</property><property name=\"period\">100ms</property></component>{robots}</composite>"
        );
        Fleet::of_text(text).diagnostics()
    };
    let found = fleet(robot("North", 1) + &robot("South", 1));
    assert!(
        found.contains("error S5004") && found.contains("robots `North` and `South` both have the number 1"),
        "{found}"
    );
    let found = fleet(robot("North", 1) + &robot("South", 2));
    assert!(found.contains("error S5012") && found.contains("`South/POSTOPIC`"), "{found}");
    assert!(!found.contains("S5004"), "{found}");
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
