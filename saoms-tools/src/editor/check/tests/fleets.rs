//! What is checked, and what is kept.

use std::path::Path;
use std::sync::Arc;

use super::{Desk, FOLDER, RIGHT, WRONG, named, shown};

#[test]
fn a_change_has_the_fleets_of_its_file_checked_alone() {
    let (a, b) = (named("a", WRONG), named("b", WRONG));
    let mut desk = Desk::new(&[("a.composite", &a), ("b.composite", &b)]);
    let before = desk.updates(true).pop().unwrap();
    assert_eq!(shown(&before), ["a.composite S3001", "b.composite S3001"]);
    desk.write("a.composite", &named("a", RIGHT));
    let mut after = desk.updates(false);
    assert_eq!(after.len(), 1, "the other fleet is not checked");
    let after = after.pop().unwrap();
    assert_eq!(shown(&after), ["b.composite S3001"]);
    let other = Path::new(FOLDER).join("b.composite");
    assert!(Arc::ptr_eq(&before[&other], &after[&other]));
}

#[test]
fn a_changed_name_has_all_fleets_checked_those_of_its_file_first() {
    let user = named("user", "<include xmlns:f=\"urn:f\" name=\"f:a\"/>");
    let mut desk =
        Desk::new(&[("a.composite", &named("a", "")), ("user.composite", &user), ("b.composite", &named("b", WRONG))]);
    assert_eq!(shown(&desk.updates(true).pop().unwrap()), ["b.composite S3001"]);
    desk.write("a.composite", &named("another", ""));
    let updates: Vec<Vec<String>> = desk.updates(false).iter().map(shown).collect();
    assert_eq!(updates.len(), 2, "{updates:?}");
    assert!(updates[1].iter().any(|one| one.starts_with("user.composite")), "{updates:?}");
    desk.write("a.composite", &named("a", ""));
    assert_eq!(shown(&desk.updates(false).pop().unwrap()), ["b.composite S3001"]);
}

#[test]
fn an_included_file_is_checked_with_those_that_include_it() {
    let (outer, inner) = (named("outer", "<include xmlns:f=\"urn:f\" name=\"f:inner\"/>"), named("inner", WRONG));
    let mut desk = Desk::new(&[("outer.composite", &outer), ("inner.composite", &inner)]);
    assert_eq!(desk.found(), ["inner.composite S3001"]);
    desk.write("inner.composite", &named("inner", RIGHT));
    assert!(shown(&desk.updates(false).pop().unwrap()).is_empty());
    // What is added in the outer one is found in both.
    desk.write("outer.composite", &named("outer", &format!("<include xmlns:f=\"urn:f\" name=\"f:inner\"/>{RIGHT}")));
    let found = shown(&desk.updates(false).pop().unwrap());
    assert_eq!(found.len(), 1, "two components of one name: {found:?}");
}

#[test]
fn what_several_fleets_find_in_a_shared_file_is_shown_once() {
    let robots = "<component name=\"R${index}\" s:count=\"2\" s:overrides=\"t.csv\"><implementation.java \
                  class=\"saoms.Robot\"/></component>";
    let (a, b) = (named("a", robots), named("b", robots));
    let table = ("t.csv", "index,battery\n1,much\n");
    let mut desk = Desk::new(&[("a.composite", &a), ("b.composite", &b), table]);
    let found = desk.found();
    assert_eq!(found.iter().filter(|one| one.starts_with("t.csv")).count(), 1, "{found:?}");
}

#[test]
fn a_file_that_no_fleet_leads_to_is_checked_alone() {
    // The composite around it is broken before the include.
    let outer = named("outer", "").replace("<composite", "<composit");
    let mut desk = Desk::new(&[("outer.composite", &outer), ("inner.composite", &named("inner", WRONG))]);
    assert!(desk.found().contains(&"inner.composite S3001".to_owned()));
}

#[test]
fn a_closed_file_has_nothing_to_report() {
    let mut desk = Desk::new(&[("a.composite", &named("a", WRONG)), ("b.composite", &named("b", WRONG))]);
    assert_eq!(desk.found().len(), 2);
    desk.open.remove(&Path::new(FOLDER).join("a.composite"));
    assert_eq!(desk.found(), ["b.composite S3001"]);
}

#[test]
fn a_check_that_is_not_wanted_reports_nothing_and_is_made_up_for() {
    let mut desk = Desk::new(&[("a.composite", &named("a", WRONG))]);
    desk.checker.check(&desk.open, true, &|| false, &mut |update| panic!("{update:?}"));
    assert_eq!(shown(&desk.updates(false).pop().unwrap()), ["a.composite S3001"]);
}
