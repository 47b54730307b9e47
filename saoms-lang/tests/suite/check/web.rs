//! Services over the web, and references that lead there.

use std::time::Duration;

use expect_test::expect;
use saoms_lang::assembly::Assembly;
use saoms_lang::project::Project;
use saoms_tools::expand::expanded;

use crate::check::classes::with_surveyor;
use crate::check::support::{part, told};

const OWN: &str = "xmlns:s=\"urn:saoms:1\" xmlns:tuscany=\"http://tuscany.apache.org/xmlns/sca/1.1\" \
    xmlns:frascati=\"http://frascati.ow2.org/xmlns/sca/1.1\"";

/// A fleet, and what is told of it; others are composites that it can name.
#[track_caller]
fn compiled(inside: &str, others: &[String]) -> (Option<Assembly>, String) {
    let project = Project::new().in_memory().text("fleet.composite", part("fleet", OWN, inside));
    let project = others
        .iter()
        .zip(0..)
        .fold(project, |project, (text, number)| project.other_text(format!("other{number}.composite"), text));
    let found = project.compile(&with_surveyor());
    let text = told(&found.diagnostics, &found.sources);
    (found.output, text)
}

#[track_caller]
fn faults(inside: &str) -> String {
    compiled(inside, &[]).1
}

fn gps(name: &str, inside: &str) -> String {
    format!("<component name=\"{name}\"><implementation.java class=\"example.Gps\"/>{inside}</component>\n")
}

fn offering(binding: &str) -> String {
    gps("Gps", &format!("<service name=\"position\">{binding}</service>"))
}

fn surveyor(reference: &str) -> String {
    format!(
        "<component name=\"Surveyor\"><implementation.java class=\"example.Surveyor\"/><property name=\"ID\">s</property>\
         <property name=\"period\">1s</property>{reference}</component>\n"
    )
}

/// The paths at which components offer services.
fn paths(assembly: &Assembly) -> String {
    let all = assembly.components.iter().flat_map(|component| {
        component.web.iter().map(|one| format!("{}/{} at {}\n", component.path, one.service, one.path.as_str()))
    });
    all.collect()
}

#[test]
fn a_service_is_offered_at_its_path_however_its_binding_is_written() {
    for (binding, path) in [
        ("<binding.rest uri=\"/stock\"/>", "/stock"),
        ("<binding.rest uri=\"stock/\"/>", "/stock"),
        ("<binding.rest/>", "/services/Gps/position"),
        ("<s:binding.rest uri=\"/stock\"/>", "/stock"),
        ("<binding.rest uri=\"/a%20b/c\"/>", "/a b/c"),
    ] {
        let (assembly, told) = compiled(&offering(binding), &[]);
        assert_eq!(told, "", "{binding}");
        assert_eq!(paths(&assembly.unwrap()), format!("Gps/position at {path}\n"), "{binding}");
    }
    let (assembly, told) = compiled(&offering("<binding.rest uri=\"http://localhost:8085/stock\"/>"), &[]);
    assert!(told.contains("warning S2067: the host of `http://localhost:8085/stock` has no effect"), "{told}");
    assert!(told.contains("write the path alone: `/stock`"), "{told}");
    assert_eq!(paths(&assembly.unwrap()), "Gps/position at /stock\n");
}

#[test]
fn bindings_of_other_runtimes_are_no_faults_and_not_served() {
    for uri in [
        "", " uri=\"/stock\"", " uri=\"http://host:8090/\"", " uri=\"/\"", " uri=\"https://host/a?b=c\"",
        " method=\"GET\"",
    ] {
        let binding = format!("<frascati:binding.rest{uri}><tuscany:wireFormat.json/></frascati:binding.rest>");
        let both = offering(&binding) + &gps("Other", &format!("<service name=\"position\">{binding}</service>"));
        let referring = format!("<reference name=\"other\">{binding}</reference>");
        let all = both + &gps("Hasty", &referring) + &surveyor(&referring.replace("other", "gps"));
        let (assembly, told) = compiled(&all, &[]);
        assert_eq!(told.matches("warning S2009: `binding.rest` of another namespace").count(), 4, "{told}");
        assert!(!told.contains("error"), "{told}");
        assert_eq!(paths(assembly.as_ref().unwrap()), "");
        let wires = assembly.iter().flat_map(|one| &one.components).flat_map(|one| &one.references);
        assert!(wires.into_iter().all(|wire| wire.web.is_empty()));
    }
    let beside = format!(
        "{}{}",
        gps("Gps", ""),
        surveyor("<reference name=\"gps\" target=\"Gps\"><frascati:binding.rest uri=\"http://host/\"/></reference>")
    );
    let project = Project::new().in_memory().text(
        "fleet.composite",
        part("fleet", OWN, &beside)
            .replace("http://docs.oasis-open.org/ns/opencsa/sca/200912", "http://www.osoa.org/xmlns/sca/1.0"),
    );
    let found = project.compile(&with_surveyor());
    let told = told(&found.diagnostics, &found.sources);
    assert!(told.contains("warning S2009") && !told.contains("error"), "{told}");
}

#[test]
fn composites_offer_the_services_that_they_promote() {
    let inner = |binding: &str| {
        let inside = gps("Gps", "") + &format!("<service name=\"where\" promote=\"Gps\">{binding}</service>");
        part("hall", "", &inside)
    };
    let hall = |name: &str, inside: &str| {
        format!("<component name=\"{name}\"><implementation.composite name=\"t:hall\"/>{inside}</component>")
    };
    let offered = |outer: &str, inside: &str| {
        let (assembly, told) = compiled(outer, &[inner(inside)]);
        assembly.map_or(told, |assembly| paths(&assembly))
    };
    let outermost = gps("Gps", "") + "<service name=\"where\" promote=\"Gps/position\"><binding.rest/></service>";
    assert_eq!(offered(&outermost, ""), "Gps/position at /services/where\n");
    let two = hall("North", "") + &hall("South", "");
    assert_eq!(
        offered(&two, "<binding.rest/>"),
        "North/Gps/position at /services/North/where\nSouth/Gps/position at /services/South/where\n"
    );
    let own = hall("North", "<service name=\"where\"><binding.rest uri=\"/north\"/></service>");
    assert_eq!(offered(&own, "<binding.rest uri=\"/inner\"/>"), "North/Gps/position at /north\n");
    let told = offered(&two, "<binding.rest uri=\"/where\"/>");
    assert!(told.contains("S2068: the path `/where` of service `where` is that of another service"), "{told}");
}

#[test]
fn replicas_have_paths_of_their_own() {
    let replicas = |uri: &str| {
        let inside = format!("<service name=\"position\"><binding.rest{uri}/></service>");
        gps("Gps${index}", &inside).replace("<component ", "<component s:count=\"2\" ")
    };
    let offered = |uri: &str| paths(&compiled(&replicas(uri), &[]).0.unwrap());
    assert_eq!(offered(" uri=\"/gps/${index}\""), "Gps1/position at /gps/1\nGps2/position at /gps/2\n");
    assert_eq!(offered(""), "Gps1/position at /services/Gps1/position\nGps2/position at /services/Gps2/position\n");
    expect![[r#"
        2:129-133 error S2068: the path `/gps` of service `position` is that of another service (in `Gps2`, index 2)
          help: give each replica its own: `uri=".../${index}"`, or leave `uri` out: the default has the name of the component
    "#]].assert_eq(&faults(&replicas(" uri=\"/gps\"")));
}

#[test]
fn what_is_wrong_with_a_service_is_told() {
    for (uri, expected) in [
        ("", "S2067: `` names no path of a service"),
        ("/", "S2067: `/` names no path of a service"),
        ("/v1/stock", "S2067: `/v1/stock` begins with `/v1`, where the server of the run has its own pages"),
        ("/stock?x=1", "S2067: `/stock?x=1` has a part after `?`"),
        ("https://host/stock", "S2067: `https://host/stock` is an address of HTTPS"),
        ("http:///stock", "S2067: `http:///stock` has no host"),
        ("http://host:80/", "S2067: `http://host:80/` names no path of a service"),
    ] {
        let told = faults(&offering(&format!("<binding.rest uri=\"{uri}\"/>")));
        assert!(told.contains(expected), "{uri}: {told}");
    }
    expect![[r#"
        2:144-148 error S2068: the path `/gps` of service `position` is that of another service
          2:109-113 the other service
          help: give each its own, or leave `uri` out: the default has the name of the component
        3:82-89 error S2005: class `example.Gps` has no service `positon`
          fix: replace `positon` with `position` [3:82-89 "position"]
        4:103-105 warning S2066: the deadline of service `position` has no effect: it is not offered over the web
          help: remove it, or offer the service over the web: write `<binding.rest/>` in it
    "#]]
    .assert_eq(&faults(
        &(offering("<binding.rest uri=\"/gps\"/><binding.rest name=\"b\" uri=\"gps/\"/>")
            + &gps("Other", "<service name=\"positon\"><binding.rest uri=\"/v1\"/></service>")
            + &gps("Late", "<service name=\"position\" s:deadline=\"2s\"/>")),
    ));
}

#[test]
fn a_binding_that_is_wrong_says_so_and_what_it_holds_is_known() {
    expect![[r#"
        2:104-107 error S1007: `binding.rest` has no attribute `url`
          fix: replace `url` with `uri` [2:104-107 "uri"]
        2:113-117 error S1007: `binding.rest` has no attribute `path`
          help: `binding.rest` has the attributes `name`, `uri`, `requires`, `policySets`
        2:123-127 error S1012: unexpected text in `binding.rest`: it contains elements only
          help: remove it, or write a comment between `<!--` and `-->`
    "#]]
    .assert_eq(&faults(&offering("<binding.rest url=\"/x\" path=\"/y\">text</binding.rest>")));
}

#[test]
fn a_reference_leads_to_a_server() {
    let (assembly, told) = compiled(
        &surveyor(
            "<reference name=\"gps\" s:deadline=\"2s\" s:tokenEnv=\"GPS_TOKEN\"><binding.rest uri=\"http://127.0.0.1:8080/gps\"/></reference>",
        ),
        &[],
    );
    assert_eq!(told, "");
    let assembly = assembly.unwrap();
    let wire = &assembly.components[0].references[0];
    assert_eq!((wire.ends(), wire.targets.len(), wire.deadline), (1, 0, Some(Duration::from_secs(2))));
    assert_eq!(wire.web[0].address.written(), "http://127.0.0.1:8080/gps");
    assert_eq!(wire.web[0].token_env.as_deref(), Some("GPS_TOKEN"));
    assert_eq!(wire.web[0].operations[0].signature, "position() -> int32");
}

#[test]
fn composites_give_the_references_that_they_promote_a_server() {
    let inner = |inside: &str, reference: &str| {
        let promoting = format!("<reference name=\"far\" promote=\"Surveyor/gps\">{reference}</reference>");
        part("hall", "", &(surveyor(inside) + &promoting))
    };
    let servers = |outer: &str, inner: &str| {
        let outer = format!("<component name=\"Hall\"><implementation.composite name=\"t:hall\"/>{outer}</component>");
        let (assembly, told) = compiled(&outer, &[inner.to_owned()]);
        let Some(assembly) = assembly else { return told };
        let wires = assembly.components.iter().flat_map(|component| &component.references);
        let all: Vec<String> = wires.flat_map(|wire| wire.web.iter().map(|one| one.address.written())).collect();
        all.join(" ")
    };
    let rest = |host: &str| format!("<binding.rest uri=\"http://{host}/\"/>");
    let outer = |host: &str| format!("<reference name=\"far\">{}</reference>", rest(host));
    assert_eq!(servers(&outer("outer"), &inner("", "")), "http://outer/");
    assert_eq!(servers("", &inner("", &rest("inner"))), "http://inner/");
    assert_eq!(servers(&outer("outer"), &inner("", &rest("inner"))), "http://outer/");
    let own = format!("<reference name=\"gps\">{}</reference>", rest("own"));
    assert_eq!(servers(&outer("outer"), &inner(&own, "")), "http://outer/");
    assert_eq!(servers("", &inner(&own, "")), "http://own/");
    let alone = surveyor("") + "<reference name=\"far\" promote=\"Surveyor/gps\">" + &rest("alone") + "</reference>";
    assert_eq!(compiled(&alone, &[]).0.unwrap().components[0].references[0].web.len(), 1);
}

#[test]
fn what_is_wrong_with_a_reference_to_a_server_is_told() {
    for (uri, expected) in [
        ("", "S2067: `binding.rest` of a reference has no `uri`"),
        ("/gps", "S2067: `/gps` has no scheme"),
        ("host:80/gps", "S2067: `host:80/gps` has no scheme"),
        ("ftp://host/gps", "S2067: `ftp://host/gps` has the scheme `ftp`, expected `http`"),
        ("https://host/gps", "S2067: `https://host/gps` is an address of HTTPS: SAOMS does not encrypt"),
        ("http:///gps", "S2067: `http:///gps` has no host"),
        ("http://me:secret@host/gps", "S2067: `http://me:secret@host/gps` has an account before `@`"),
        ("http://host/gps?a=b", "S2067: `http://host/gps?a=b` has a query after `?`"),
    ] {
        let told = faults(&surveyor(&format!("<reference name=\"gps\"><binding.rest uri=\"{uri}\"/></reference>")));
        assert!(told.contains(expected), "{uri}: {told}");
    }
    let sent = "<reference name=\"gps\" s:tokenEnv=\"TOKEN\"><binding.rest uri=\"http://gps.example/\"/></reference>";
    let told = faults(&surveyor(sent));
    assert!(told.contains("warning S2071: the token of reference `gps` leaves this machine unencrypted"), "{told}");
    let two = "<binding.rest name=\"a\" uri=\"http://one/\"/><binding.rest name=\"b\" uri=\"http://two/\"/>";
    expect![[r#"
        2:178-183 error S2071: each of the 2 servers of reference `gps` would get its token
          help: let each server have a reference, or a component, of its own
        2:255-266 error S2017: reference `gps` of component `Surveyor` allows one target, found 2
          2:213-224 the first
          help: keep one of them
        3:110-121 error S2070: reference `other` of `Hasty` leads to a web server: a call waits for its answer, and class `example.Gps` is not `apart`
          help: call from a class that declares `apart`: its components run on threads of their own, and others wire to one of them
    "#]].assert_eq(&faults(
        &(surveyor(&format!("<reference name=\"gps\" s:tokenEnv=\"TOKEN\">{two}</reference>"))
            + &gps("Hasty", "<reference name=\"other\"><binding.rest uri=\"http://one/\"/></reference>")),
    ));
}

#[test]
fn expansion_keeps_what_is_offered_and_called_over_the_web() {
    let inner = part(
        "hall",
        OWN,
        &(offering("<binding.rest name=\"a\" uri=\"/a b\"/><binding.rest name=\"b\"/>")
            .replace("\"position\"", "\"position\" s:deadline=\"2s\"")
            + &surveyor("")
            + "<reference name=\"far\" promote=\"Surveyor/gps\" s:tokenEnv=\"TOKEN\"><binding.rest uri=\"http://localhost/x\"/></reference>"),
    );
    let outer = "<component name=\"Hall\"><implementation.composite name=\"t:hall\"/></component>";
    let project = Project::new().in_memory().text("fleet.composite", part("fleet", "", outer));
    let found = project.other_text("hall.composite", inner).compile(&with_surveyor());
    assert_eq!(told(&found.diagnostics, &found.sources), "");
    let text = expanded(&found).unwrap();
    let again = Project::new().in_memory().text("fleet.composite", text.clone()).compile(&with_surveyor());
    assert_eq!(told(&again.diagnostics, &again.sources), "", "{text}");
    let (before, after) = (found.output.unwrap(), again.output.unwrap());
    for (one, other) in before.components.iter().zip(&after.components) {
        assert_eq!((&one.path, &one.web, &one.references), (&other.path, &other.web, &other.references), "{text}");
    }
}
