//! What a composite says of the run.

use super::*;
use crate::model::{Hangup, HttpAddress};

/// The diagnostics of a composite with these attributes of SAOMS.
fn said(attributes: &str) -> String {
    let own = "xmlns:s='urn:saoms:1'";
    loaded(&format!("<composite xmlns='{OASIS}' {own} name='c' targetNamespace='u'\n{attributes}/>")).1
}

#[test]
fn where_alerts_go_and_what_a_lost_terminal_leads_to_are_read() {
    let text = format!(
        "<composite xmlns='{OASIS}' xmlns:s='urn:saoms:1' name='c' targetNamespace='u' s:alertUrl=' http://a:1/b ' \
         s:alertTokenEnv='TOKEN' s:alertCommand='./page.sh &quot;a  b&quot;' s:hangup='goOn'/>"
    );
    let (composite, diagnostics) = loaded(&text);
    assert_eq!(diagnostics, "");
    let run = composite.unwrap().run;
    assert_eq!(
        run.alert_url.as_ref().unwrap().value,
        HttpAddress::parse("http://a:1/b", &crate::model::AddressHelp::ALERTS).unwrap()
    );
    assert_eq!(run.token(), Some("TOKEN"));
    assert_eq!(run.alert_command.as_ref().unwrap(), &"./page.sh \"a  b\"");
    assert_eq!(run.hangup.unwrap().value, Hangup::GoOn);
    let written: Vec<&str> = run.written.iter().map(|one| one.as_str()).collect();
    assert_eq!(written, ["s:alertUrl", "s:alertTokenEnv", "s:alertCommand", "s:hangup"]);
}

#[test]
fn wrong_targets_of_alerts_are_told_at_their_place() {
    for (attributes, expected) in [
        ("s:alertUrl=''", "2:1 [s:alertUrl=''] error S1011 the attribute `s:alertUrl` is empty"),
        ("s:alertCommand=' '", "2:1 [s:alertCommand=' '] error S1011 the attribute `s:alertCommand` is empty"),
        (
            "s:alertUrl='page.example/a'",
            "2:13 [page.example/a] error S1011 `page.example/a` has no scheme \
             | replace it with `http://page.example/a`",
        ),
        (
            "s:alertUrl='https://page.example/a'",
            "2:13 [https://page.example/a] error S1011 `https://page.example/a` is an address of HTTPS: SAOMS does \
             not encrypt",
        ),
        (
            "s:alertUrl='http://a' s:alertTokenEnv='$TOKEN'",
            "2:40 [$TOKEN] error S1011 `$TOKEN` is not a name of an environment variable: use letters, digits and \
             `_`, and no digit first | replace it with `TOKEN`",
        ),
        (
            "s:alertTokenEnv='TOKEN'",
            "2:1 [s:alertTokenEnv] error S1008 `s:alertTokenEnv` needs the attribute `s:alertUrl`",
        ),
        (
            "s:alertUri='http://a'",
            "2:1 [s:alertUri] error S1007 `composite` has no attribute `s:alertUri` | replace `s:alertUri` with \
             `s:alertUrl`",
        ),
        (
            "alertCommand='page'",
            "2:1 [alertCommand] error S1007 `composite` has no attribute `alertCommand` | replace `alertCommand` \
             with `s:alertCommand`",
        ),
        ("s:mailTo='a@b'", "2:1 [s:mailTo] error S1007 `composite` has no attribute `s:mailTo`"),
    ] {
        assert_eq!(said(attributes).trim_end(), expected, "{attributes}");
    }
}

#[test]
fn what_a_lost_terminal_leads_to_is_one_of_three() {
    let is = |value: &str, meant: &str| {
        let rest = if meant.is_empty() { String::new() } else { format!(" | replace it with `{meant}`") };
        let expected =
            format!("2:11 [{value}] error S1011 `s:hangup` is `{value}`, expected `end`, `hold` or `goOn`{rest}");
        assert_eq!(said(&format!("s:hangup='{value}'")).trim_end(), expected);
    };
    is("go on", "goOn");
    is("go-on", "goOn");
    is("ignore", "goOn");
    is("estop", "hold");
    is("Hold", "hold");
    is("terminate", "end");
    is("sometimes", "");
}

#[test]
fn a_setting_of_the_run_elsewhere_is_sent_to_the_composite() {
    let own = "xmlns:s='urn:saoms:1'";
    let text = format!(
        "<composite xmlns='{OASIS}' {own} name='c' targetNamespace='u'>\n<component name='a' s:hangup='hold'>{JAVA}\
         </component></composite>"
    );
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let file = sources.add("t.composite", text);
    load_file(file, &sources, &mut diagnostics);
    let all = diagnostics.into_sorted();
    assert_eq!(all.len(), 1, "{all:?}");
    assert_eq!(all[0].code, &codes::UNKNOWN_ATTRIBUTE);
    assert_eq!(all[0].help, ["write it in the start tag of the outermost `composite`"]);
}
