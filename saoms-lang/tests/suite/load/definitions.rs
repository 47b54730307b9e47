//! `definitions.xml`, by itself, in a folder and beside a composite.

use expect_test::expect;
use saoms_lang::contribution::{Finder, SideFile};
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::MAX_SIZE;
use saoms_lang::source::{OpenTexts, Sources};

use crate::load::support::{loaded_folder, shown, written};

pub(crate) const OASIS: &str = "http://docs.oasis-open.org/ns/opencsa/sca/200912";
pub(crate) const OSOA: &str = "http://www.osoa.org/xmlns/sca/1.0";

pub(crate) fn definitions(namespace: &str, inside: &str) -> String {
    format!(
        "<definitions xmlns='{namespace}' xmlns:sca='{namespace}' xmlns:t='urn:t' xmlns:o='urn:o' xmlns:x='urn:x' targetNamespace='urn:t'>\n{inside}\n</definitions>"
    )
}

/// The diagnostics of a file by itself.
pub(crate) fn alone(name: &str, text: String) -> String {
    let folder = written(&[(name, text)]);
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let mut finder = Finder::new(OpenTexts::default());
    let found = finder.load_side_file(&folder.path().join(name), MAX_SIZE, &mut sources, &mut diagnostics);
    match found {
        Some(SideFile::Checked) => shown(folder.path(), &sources, diagnostics),
        Some(SideFile::ComponentType(_)) => "a component type".to_owned(),
        None => "no file beside composites".to_owned(),
    }
}

pub(crate) fn of_folder(files: &[(&str, String)]) -> String {
    let folder = written(files);
    let (_, sources, diagnostics) = loaded_folder(folder.path());
    shown(folder.path(), &sources, diagnostics)
}

#[test]
fn all_that_the_schemas_allow_is_right() {
    let new = "
        <documentation>Policies.</documentation>
        <intent name='safe' constrains='sca:binding sca:implementation' requires='o:other sca:integrity' excludes='t:fast' mutuallyExclusive='true' intentType='interaction' x:note='1'>
            <description>Nobody reads along.</description>
            <qualifier name='low' default='true'><description>A little.</description><x:more/></qualifier><qualifier name='high'/><x:more/>
        </intent>
        <intent name='fast' intentType='implementation'/><intent name='one'><qualifier name='only'/></intent>
        <policySet name='fast'/>
        <policySet name='both' provides='t:safe sca:confidentiality.message t:safe.low' appliesTo='//sca:binding.ws' attachTo='//sca:reference'>
            <intentMap provides='t:safe'><qualifier name='high'><x:policy/></qualifier><qualifier name='low'/></intentMap>
            <policySetReference name='t:fast'/><policySetReference name='o:theirs'/><x:policy/>
        </policySet>
        <bindingType type='sca:binding.ws' alwaysProvides='' mayProvide='sca:SOAP t:safe'><documentation/></bindingType>
        <implementationType type='x:implementation.lua' alwaysProvides='t:fast'/>
        <externalAttachment intents='t:safe' policySets='t:both o:theirs' attachTo='//sca:service'/>
        <x:anything/>";
    expect![""].assert_eq(&alone("definitions.xml", definitions(OASIS, new)));
    let old = "
        <intent name='t:safe' constrains='binding'><description>Nobody reads along.</description></intent>
        <intent name='safe.low'/><intent name='safe.high'/>
        <policySet name='t:both' provides='t:safe' appliesTo='sca:binding.ws'>
            <intentMap provides='t:safe' default='low'>
                <qualifier name='low'><intentMap provides='much' default='a'><qualifier name='a'><x:policy/></qualifier></intentMap></qualifier>
                <qualifier name='high'><x:policy/></qualifier>
            </intentMap>
        </policySet>
        <policySet name='roles' appliesTo='implementation.java'><allow roles='a b'/><permitAll/><denyAll/><runAs role='r'/></policySet>
        <binding.jms name='usual'><destination name='Desk'/></binding.jms>
        <bindingType type='binding.jms' mayProvide='JMS'/><x:anything/>";
    expect![""].assert_eq(&alone("definitions.xml", definitions(OSOA, old)));
}

#[test]
fn what_the_schema_of_1_1_forbids_is_told_where_it_stands() {
    let inside = "
        <intent nam='a' constrains='sca:'/><intent name='b' intentType='interactions' mutuallyExclusive='maybe' excludes='q:x'/>
        <intent name='c d'><description/><description/><qualifer name='z'/><qualifier/><component name='x'/></intent>
        <policySet name='p' provide='t:b'>text<intentMap default='x'><qualifier name=''/></intentMap><policySetReference/><allow roles='x'/></policySet>
        <intentMap provides='t:b'/><bindingType/><bindingType type='sca:implementation.java'/>
        <implementationType alwaysProvides='t:b' type='sca:implementation.java' mayProvides='t:b'/>
        <externalAttachment policySets='t:p'/><externalAttachment attachTo='//x'/><binding.http/>";
    expect![[r#"
        definitions.xml:3:17 [nam] error S1007 `intent` has no attribute `nam`
          replace `nam` with `name`
        definitions.xml:4:57 [qualifer] error S1004 SCA 1.1 has no element `qualifer`
          replace `qualifer` with `qualifier`
        definitions.xml:4:77 [qualifier] error S1008 `qualifier` needs the attribute `name`
          add `name="..."` to it
        definitions.xml:4:89 [component] error S1005 `component` is not allowed in `intent`
          `intent` can contain `description`, `qualifier`
        definitions.xml:5:29 [provide] error S1007 `policySet` has no attribute `provide`
          replace `provide` with `provides`
        definitions.xml:5:48 [intentMap] error S1008 `intentMap` needs the attribute `provides`
          add `provides="..."` to it
        definitions.xml:5:81 [name=''] error S1011 the attribute `name` is empty
          write its value between the quotes
        definitions.xml:5:103 [policySetReference] error S1008 `policySetReference` needs the attribute `name`
          add `name="..."` to it
        definitions.xml:6:10 [intentMap] error S1005 `intentMap` is not allowed in `definitions`
          `definitions` can contain `intent`, `policySet`, `bindingType`, `implementationType`, `externalAttachment`, `binding.*`, `documentation`
        definitions.xml:6:37 [bindingType] error S1008 `bindingType` needs the attribute `type`
          add `type="..."` to it
        definitions.xml:7:81 [mayProvides] error S1007 `implementationType` has no attribute `mayProvides`
          replace `mayProvides` with `mayProvide`
        definitions.xml:8:10 [externalAttachment] error S1008 `externalAttachment` needs the attribute `attachTo`
          add `attachTo="..."` to it
        definitions.xml:8:84 [binding.http] error S1004 SCA 1.1 has no element `binding.http`
          if it is an extension, write it with a prefix of its own namespace
          `definitions` can contain `intent`, `policySet`, `bindingType`, `implementationType`, `externalAttachment`, `binding.*`, `documentation`
    "#]].assert_eq(&alone("definitions.xml", definitions(OASIS, inside)));
    let bare = format!("<definitions xmlns='{OASIS}'/>");
    expect![""].assert_eq(&alone("definitions.xml", bare));
}

#[test]
fn elements_of_either_version_are_known() {
    let inside = "
        <intent name='a' intentType='interaction'><qualifier name='q'/></intent>
        <policySet name='p' attachTo='//x'/><policySet name='r' appliesTo='x'><allow/><runAs/><authorization><allow/></authorization></policySet>
        <externalAttachment attachTo='//x' intents='t:a'/><documentation/>";
    expect![""].assert_eq(&alone("definitions.xml", definitions(OSOA, inside)));
}

#[test]
fn only_files_of_sca_are_definitions() {
    let foreign = "<definitions xmlns='http://schemas.xmlsoap.org/wsdl/'/>".to_owned();
    let wrong = definitions(OASIS, "<intent/>");
    expect![[r#"
        FOLDER:1:1 [] error S0002 the folder contains no composites
          the names of composites end with `.composite`
    "#]]
    .assert_eq(&of_folder(&[("definitions.xml", foreign.clone())]));
    expect![[r#"
        META-INF/definitions.xml:2:2 [intent] error S1008 `intent` needs the attribute `name`
          add `name="..."` to it
    "#]]
    .assert_eq(&of_folder(&[("META-INF/definitions.xml", wrong.clone())]));
    expect![[r#"
        definitions.xml:1:2 [definitions] error S1001 `definitions` is in the namespace `http://schemas.xmlsoap.org/wsdl/`, expected one of SCA
          a file of this name holds intents and policy sets
          that is `http://docs.oasis-open.org/ns/opencsa/sca/200912` (SCA 1.1), `http://docs.oasis-open.org/ns/opencsa/sca/200903` (SCA 1.1 (draft)) or `http://www.osoa.org/xmlns/sca/1.0` (SCA 1.0)
    "#]].assert_eq(&alone("definitions.xml", foreign.clone()));
    expect!["no file beside composites"].assert_eq(&alone("desk.wsdl", foreign));
    expect!["no file beside composites"].assert_eq(&alone("definitions.xml", "<definitions".to_owned()));
    expect![[r#"
        my.xml:2:2 [intent] error S1008 `intent` needs the attribute `name`
          add `name="..."` to it
    "#]]
    .assert_eq(&alone("my.xml", wrong));
}

#[test]
fn a_file_that_is_no_xml_is_judged_as_far_as_it_can_be_read() {
    let damaged = definitions(OASIS, "<intent name=safe/>\n<intent/>\n<policySet nam='both'/>\n</definition>");
    expect![[r#"
        definitions.xml:2:14 [safe] error S0105 the value of `name` is not in quotes
          put it in quotes
        definitions.xml:3:2 [intent] error S1008 `intent` needs the attribute `name`
          add `name="..."` to it
        definitions.xml:4:12 [nam] error S1007 `policySet` has no attribute `nam`
          replace `nam` with `name`
        definitions.xml:5:1 [</definition>] error S0102 `</definition>` found where `</definitions>` is expected
          replace it with `</definitions>`
        definitions.xml:6:1 [</definitions>] error S0102 `</definitions>` closes nothing: no element is open
    "#]]
    .assert_eq(&alone("definitions.xml", damaged));
}
