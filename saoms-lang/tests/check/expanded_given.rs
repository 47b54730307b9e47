//! Composites whose classes are taken as given, written anew from what they come to.

use std::fs;
use std::path::{Path, PathBuf};

use expect_test::{Expect, expect};
use saoms_lang::check::{Options, expand};
use saoms_lang::diagnostic::{Diagnostics, Severity};
use saoms_lang::load::{MAX_SIZE, load_file, load_named, read_values};
use saoms_lang::model::Contribution;
use saoms_lang::registry::Registry;
use saoms_lang::source::{FileId, Sources};
use saoms_lang::xml;
use saoms_tools::format::{WIDTH, format};

use crate::classes::registry;
use crate::corpus::collection;
use crate::support::{part, shown};

/// What is left of texts, each called by its path; all but the first are others that the first can name. Where there are errors, these.
fn expanded(texts: &[(&str, &str)], registry: &Registry) -> Result<String, String> {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let files: Vec<_> = texts.iter().map(|(path, text)| sources.add(*path, *text)).collect();
    let composites = files.iter().filter_map(|file| load_file(*file, &sources, &mut diagnostics));
    let mut composites: Vec<_> = composites.collect();
    for composite in &mut composites {
        read_values(composite, MAX_SIZE, &mut sources, &mut diagnostics);
    }
    let others = composites.split_off(composites.len().min(1));
    let mut all = Contribution::with(composites, others);
    load_named(&mut all, MAX_SIZE, &mut sources, &mut diagnostics);
    let options = Options { assume_classes: true, ..Options::default() };
    let expansion = expand(&all, registry, &options, &sources, &mut diagnostics);
    let Some(expansion) = expansion else {
        let errors = diagnostics.iter().filter(|one| one.severity == Severity::Error);
        return Err(errors.map(|one| shown(one, &sources)).collect());
    };
    let text = expansion.text(&all.asked_for()[0], diagnostics.iter()).into();
    Ok(format(&xml::parse(FileId(0), &text).document.unwrap(), WIDTH))
}

/// What is left of texts, which is the same when it is expanded again.
fn settled(texts: &[&str]) -> String {
    let texts: Vec<(&str, &str)> = texts.iter().map(|text| ("/t/t.composite", *text)).collect();
    let text = expanded(&texts, &registry()).unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(expanded(&[("/t/t.composite", &text)], &registry()), Ok(text.clone()));
    text
}

fn comes_to(texts: &[&str], expected: &Expect) {
    expected.assert_eq(&settled(texts));
}

fn composites(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut all: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    all.sort();
    for path in all {
        match path.extension() {
            _ if path.is_dir() => composites(&path, found),
            Some(extension) if extension == "composite" => found.push(path),
            _ => {}
        }
    }
}

/// What others wrote, as far as it has no errors, is left as a composite without errors that is the same when it is expanded again.
#[test]
fn files_of_others_come_to_composites_without_errors() {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/corpus");
    let mut paths = Vec::new();
    composites(&shipped, &mut paths);
    let least = paths.len() / 2;
    if let Some(folder) = collection() {
        composites(&folder.join("files"), &mut paths);
    }
    let mut texts: Vec<String> = Vec::new();
    let mut count = 0;
    for path in paths {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        if texts.contains(&text) {
            continue;
        }
        let name = path.to_str().unwrap();
        // Those with errors are tested elsewhere.
        if let Ok(left) = expanded(&[(name, &text)], &Registry::new()) {
            let again = expanded(&[(name, &left)], &Registry::new());
            assert_eq!(again.as_ref(), Ok(&left), "{name}");
            count += 1;
        }
        texts.push(text);
    }
    assert!(count >= least, "{count} of {}", texts.len());
}

#[test]
fn all_but_classes_is_resolved() {
    let shop = part(
        "shop",
        r#"xmlns:o="urn:orders" requires="t:confidential" autowire="true""#,
        r#"
<include name="t:robots"/>
<property name="currency">EUR</property>
<property name="region" mustSupply="true"/>
<property name="order" element="o:Order"><o:Order><o:line n="1">A</o:line><o:line n="2">B</o:line></o:Order></property>
<property name="places" many="true"><value>north</value><value>south</value></property>
<service name="Shop" promote="front/Shop"><binding.ws uri="http://x/shop"/></service>
<component name="front"><implementation.composite name="t:front" requires="t:fast"/>
  <property name="cur" source="$currency"/><property name="reg" source="$region"/><reference name="stock" target="Robot*/S"/></component>
<reference name="bank" promote="front/bank" multiplicity="0..1"><interface.java interface="a.Bank"/></reference>"#,
    );
    let front = part(
        "front",
        r#"xmlns:f="urn:foreign" policySets="t:ps""#,
        r#"
<property name="cur">USD</property><property name="reg"/>
<service name="Shop" promote="ui/Pages"><binding.sca name="fast"/></service>
<reference name="bank" promote="ui/bank" multiplicity="0..1"/>
<reference name="stock" promote="ui/stock" multiplicity="1..n"/>
<component name="ui"><f:implementation.php file="a.php"><f:x y="t:z">of <f:b/> two</f:x></f:implementation.php>
  <property name="currency" source="$cur"/><property name="region" source="$reg"/>
  <service name="Pages"><interface.java interface="a.Shop"/></service>
  <reference name="stock" multiplicity="1..n"/><reference name="bank" multiplicity="0..1"/><reference name="log"/></component>
<component name="log"><implementation.java class="a.Log"/><service name="Log"/></component>
<wire source="ui/log" target="log/Log"/>"#,
    );
    let robots = part(
        "robots",
        r#"xmlns:s="urn:saoms:1""#,
        r#"
<component name="Robot${index}" s:count="2"><implementation.java class="a.Robot${index}"/>
  <property name="place" source="$places[${index}]"/><property name="first" source="$order/line[1]"/><property name="order" source="$order"/>
  <service name="S"><binding.ws uri="/r${index}"/></service><reference name="next" target="Robot*"/></component>"#,
    );
    comes_to(
        &[&shop, &front, &robots],
        &expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912"
            xmlns:f="urn:foreign"
            xmlns:o="urn:orders"
            xmlns:s="urn:saoms:1"
            xmlns:t="urn:t"
            targetNamespace="urn:t"
            name="shop"
            requires="t:confidential"
            autowire="true">
          <property name="region" mustSupply="true"/>
          <service name="Shop" promote="front.ui/Pages">
            <binding.ws uri="http://x/shop"/>
          </service>
          <component name="Robot1">
            <implementation.java class="a.Robot1"/>
            <property name="place">north</property>
            <property name="first">A</property>
            <property name="order" element="o:Order">
              <o:Order>
                <o:line n="1">A</o:line>
                <o:line n="2">B</o:line>
              </o:Order>
            </property>
            <service name="S">
              <binding.ws uri="/r1"/>
            </service>
            <reference name="next" target="Robot2"/>
          </component>
          <component name="Robot2">
            <implementation.java class="a.Robot2"/>
            <property name="place">south</property>
            <property name="first">A</property>
            <property name="order" element="o:Order">
              <o:Order>
                <o:line n="1">A</o:line>
                <o:line n="2">B</o:line>
              </o:Order>
            </property>
            <service name="S">
              <binding.ws uri="/r2"/>
            </service>
            <reference name="next" target="Robot1"/>
          </component>
          <component name="front.ui" s:path="front/ui" requires="t:fast" policySets="t:ps" autowire="false">
            <f:implementation.php file="a.php">
              <f:x y="t:z">of <f:b/> two</f:x>
            </f:implementation.php>
            <property name="currency">EUR</property>
            <property name="region" source="$region"/>
            <service name="Pages">
              <interface.java interface="a.Shop"/>
              <binding.sca name="fast"/>
            </service>
            <reference name="stock" multiplicity="1..n" target="Robot1/S Robot2/S"/>
            <reference name="bank" multiplicity="0..1"/>
            <reference name="log" target="front.log/Log"/>
          </component>
          <component name="front.log" s:path="front/log" requires="t:fast" policySets="t:ps" autowire="false">
            <implementation.java class="a.Log"/>
            <service name="Log"/>
          </component>
          <reference name="bank" promote="front.ui/bank" multiplicity="0..1">
            <interface.java interface="a.Bank"/>
          </reference>
        </composite>
    "#]],
    );
}

/// What nobody knows the name of is left to the composite: services, and wires from any reference.
#[test]
fn what_only_a_class_could_name_is_left_as_it_is() {
    let outer = part(
        "outer",
        "",
        r#"
<component name="in"><implementation.composite name="t:in"/>
  <service name="Pages"><interface.java interface="a.Pages"/><binding.ws uri="http://x/pages"/></service></component>
<component name="user"><implementation.java class="a.User"/><reference name="pages" target="in/Pages"/></component>
<wire source="user" target="in"/>"#,
    );
    let inner = part(
        "in",
        "",
        r#"<component name="page"><implementation.java class="a.Page"/></component><service name="Pages" promote="page"/>"#,
    );
    comes_to(
        &[&outer, &inner],
        &expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912"
            xmlns:s="urn:saoms:1"
            targetNamespace="urn:t"
            name="outer">
          <service name="in.Pages" promote="in.page">
            <interface.java interface="a.Pages"/>
            <binding.ws uri="http://x/pages"/>
          </service>
          <component name="in.page" s:path="in/page">
            <implementation.java class="a.Page"/>
          </component>
          <component name="user">
            <implementation.java class="a.User"/>
            <reference name="pages" target="in.page"/>
          </component>
          <wire source="user" target="in.page"/>
        </composite>
    "#]],
    );
}

/// Where some classes are known, what these make of their values and wires is written, and what is wired to others stays so.
#[test]
fn components_with_and_without_a_class_stand_beside_each_other() {
    let fleet = part(
        "fleet",
        r#"autowire="true""#,
        r#"
<property name="pace">250us</property>
<component name="Robot"><implementation.java class="example.Robot001"/><property name="ID">r</property><property name="period" source="$pace"/></component>
<component name="C"><implementation.java class="example.Conductor"/><reference name="wheels" target="T/left T/right"/></component>
<component name="T"><implementation.java class="example.Twins"/><service name="left"><interface.java interface="example.Wheels"/></service></component>
<component name="Other"><implementation.java class="a.Other"/><reference name="r" target="Robot"/></component>"#,
    );
    comes_to(
        &[&fleet],
        &expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912"
            targetNamespace="urn:t"
            name="fleet"
            autowire="true">
          <component name="Robot">
            <implementation.rust class="example.Robot001"/>
            <property name="ID">r</property>
            <property name="period">250us</property>
          </component>
          <component name="C">
            <implementation.rust class="example.Conductor"/>
            <reference name="wheels" target="T/left T/right"/>
          </component>
          <component name="T">
            <implementation.rust class="example.Twins"/>
            <service name="left">
              <interface.java interface="example.Wheels"/>
            </service>
          </component>
          <component name="Other">
            <implementation.java class="a.Other"/>
            <reference name="r" target="Robot"/>
          </component>
        </composite>
    "#]],
    );
}

/// An address and targets do not stand in one reference of SCA 1.1.
#[test]
fn a_reference_with_an_address_is_wired_from_outside() {
    let fleet = part(
        "fleet",
        "",
        r#"
<component name="A"><implementation.java class="a.A"/><reference name="r" multiplicity="0..n"><binding.ws uri="http://x"/></reference></component>
<component name="B"><implementation.java class="a.B"/></component><wire source="A/r" target="B"/>"#,
    );
    comes_to(
        &[&fleet],
        &expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912" targetNamespace="urn:t" name="fleet">
          <component name="A">
            <implementation.java class="a.A"/>
            <reference name="r" multiplicity="0..n">
              <binding.ws uri="http://x"/>
            </reference>
          </component>
          <component name="B">
            <implementation.java class="a.B"/>
          </component>
          <wire source="A/r" target="B"/>
        </composite>
    "#]],
    );
}

#[test]
fn intents_of_all_composites_around_a_component_are_its_own() {
    let outer = part(
        "outer",
        r#"requires="t:a""#,
        r#"<component name="in" requires="t:b"><implementation.composite name="t:in"/><service name="S" requires="t:c"/></component>"#,
    );
    let inner = part(
        "in",
        r#"requires="t:a o:d" xmlns:o="urn:other""#,
        r#"<service name="S" promote="x/S" policySets="o:p"/>
<component name="x" requires="o:d"><implementation.java class="a.X"/><service name="S" requires="t:c"/></component>"#,
    );
    comes_to(
        &[&outer, &inner],
        &expect![[r#"
        <composite xmlns="http://docs.oasis-open.org/ns/opencsa/sca/200912"
            xmlns:o="urn:other"
            xmlns:s="urn:saoms:1"
            xmlns:t="urn:t"
            targetNamespace="urn:t"
            name="outer"
            requires="t:a">
          <component name="in.x" s:path="in/x" requires="o:d t:a t:b">
            <implementation.java class="a.X"/>
            <service name="S" requires="t:c" policySets="o:p"/>
          </component>
        </composite>
    "#]],
    );
}

/// What a composite takes from those that nobody chose: told where it is.
#[test]
fn a_target_of_which_nobody_knows_what_it_means_is_told() {
    let outer = part(
        "outer",
        "",
        r#"<component name="in"><implementation.composite name="t:in"/></component>
<component name="user"><implementation.java class="a.User"/><reference name="r" target="in"/></component>"#,
    );
    let inner = part(
        "in",
        "",
        r#"<component name="x"><implementation.java class="a.X"/><service name="S"/><service name="T"/></component>
<service name="S" promote="x/S"><interface.java interface="a.S"/></service><service name="T" promote="x/T"><interface.java interface="a.T"/></service>"#,
    );
    let found = expanded(&[("t", &outer), ("u", &inner)], &registry()).unwrap_err();
    expect![[r#"
        3:89-91 error S2014: which service of component `in` is meant is not known
          help: its composite has several: write `component/service`
    "#]]
    .assert_eq(&found);
    let named = outer.replace(
        "<reference name=\"r\" target=\"in\"/>",
        "<reference name=\"r\" target=\"in\"><interface.java interface=\"a.T\"/></reference>",
    );
    assert!(settled(&[&named, &inner]).contains(r#"<reference name="r" target="in.x/T">"#));
}

/// What is beside a component that autowire wires is not all that is there once composites are resolved.
#[test]
fn autowire_that_gets_more_to_choose_from_is_told() {
    let user =
        r#"<component name="user"><implementation.java class="a.User"/><reference name="r"/></component>"#;
    let outer = part(
        "outer",
        "",
        r#"<component name="in"><implementation.composite name="t:in"/></component>
<component name="wired" autowire="true"><implementation.java class="a.User"/></component>
<component name="other"><implementation.java class="a.User"/><reference name="r" autowire="true"/><reference name="s" target="wired" autowire="true"/></component>"#,
    );
    let inner = part(
        "in",
        "autowire=\"true\"",
        &format!(
            "{user}<component name=\"not\" autowire=\"false\"><implementation.java class=\"a.X\"/></component>"
        ),
    );
    let told = |texts: &[&str]| {
        let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
        let files: Vec<_> = texts.iter().map(|text| sources.add("t", *text)).collect();
        let mut composites: Vec<_> =
            files.iter().filter_map(|file| load_file(*file, &sources, &mut diagnostics)).collect();
        let others = composites.split_off(1);
        let options = Options { assume_classes: true, ..Options::default() };
        let all = Contribution::with(composites, others);
        assert!(expand(&all, &registry(), &options, &sources, &mut diagnostics).is_some());
        diagnostics.into_sorted().iter().map(|one| shown(one, &sources)).collect::<String>()
    };
    expect![[r#"
        3:35-39 warning S2014: autowire wires component `wired` to others of its composite; once expanded, to any of all composites
          help: which they are only its class knows: give its references each a `target`
        4:92-96 warning S2014: autowire wires component `other` to others of its composite; once expanded, to any of all composites
          help: which they are only its class knows: give its references each a `target`
        t:1:129-133 warning S2014: autowire wires component `user` to others of its composite; once expanded, to any of all composites
          help: which they are only its class knows: give its references each a `target`
    "#]]
    .assert_eq(&told(&[&outer, &inner]));
    // Alone all that is there stands beside it.
    assert_eq!(told(&[&inner]), "");
}
