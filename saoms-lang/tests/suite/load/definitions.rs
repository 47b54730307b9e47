//! `definitions.xml`, by itself, in a folder and beside a composite.

use expect_test::expect;
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::{Finder, MAX_SIZE, SideFile, load, load_folder, load_named};
use saoms_lang::model::Contribution;
use saoms_lang::source::{OpenTexts, Sources};

use crate::load::support::{shown, written};

pub(crate) const OASIS: &str = "http://docs.oasis-open.org/ns/opencsa/sca/200912";
pub(crate) const OSOA: &str = "http://www.osoa.org/xmlns/sca/1.0";

pub(crate) fn definitions(namespace: &str, inside: &str) -> String {
    format!(
        "<definitions xmlns='{namespace}' xmlns:sca='{namespace}' xmlns:t='urn:t' xmlns:o='urn:o' xmlns:x='urn:x' targetNamespace='urn:t'>\n{inside}\n</definitions>"
    )
}

/// What is said of a file by itself.
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
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    load_folder(folder.path(), MAX_SIZE, &mut sources, &mut diagnostics);
    shown(folder.path(), &sources, diagnostics)
}

/// What is said of `fleet.composite` and of what it names, in a folder of these files.
pub(crate) fn of_fleet(files: &[(&str, String)]) -> String {
    let folder = written(files);
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let first = load(&folder.path().join("fleet.composite"), &mut sources, &mut diagnostics).unwrap();
    load_named(&mut Contribution::of(vec![first]), MAX_SIZE, &mut sources, &mut diagnostics);
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
        definitions.xml:3:37 [sca:] warning S1011 `sca:` is no name with a prefix
          write `prefix:name`, with a prefix that is bound to the namespace
          other programs refuse it
        definitions.xml:3:73 [interactions] error S1011 `intentType` is `interactions`, and has to be `interaction` or `implementation`
          replace it with `interaction`
        definitions.xml:3:106 [maybe] error S1011 `mutuallyExclusive` is `maybe` and has to be `true` or `false`
        definitions.xml:3:123 [q:x] warning S1011 the prefix `q` is bound to no namespace
          declare it: `xmlns:q="..."`
        definitions.xml:4:23 [c d] error S1011 `c d` cannot be a name: it holds ` `
          names are used in targets as `component/service`, and in lists between blanks
        definitions.xml:4:43 [description] error S1006 `intent` has a second description
        definitions.xml:4:57 [qualifer] error S1004 SCA 1.1 has no element `qualifer`
          replace `qualifer` with `qualifier`
        definitions.xml:4:77 [qualifier] error S1008 `qualifier` needs the attribute `name`
          add `name="..."` to it
        definitions.xml:4:89 [component] error S1005 `component` cannot stand in `intent`
          `intent` can hold `description`, `qualifier`
        definitions.xml:5:29 [provide] error S1007 `policySet` has no attribute `provide`
          replace `provide` with `provides`
        definitions.xml:5:43 [text] error S1012 text in `policySet`, which holds no text
          remove it; comments stand between `<!--` and `-->`
        definitions.xml:5:48 [intentMap] error S1008 `intentMap` needs the attribute `provides`
          add `provides="..."` to it
        definitions.xml:5:58 [default] warning S1007 `default` is an attribute of SCA 1.0, and this file is of SCA 1.1
          the intent says which of its qualifiers is the default
        definitions.xml:5:81 [name=''] error S1011 the attribute `name` is empty
        definitions.xml:5:103 [policySetReference] error S1008 `policySetReference` needs the attribute `name`
          add `name="..."` to it
        definitions.xml:5:124 [allow] error S1004 SCA 1.1 has no element `allow`
          `policySet` can hold `policySetReference`, `intentMap`
        definitions.xml:6:10 [intentMap] error S1005 `intentMap` cannot stand in `definitions`
          `definitions` can hold `intent`, `policySet`, `bindingType`, `implementationType`, `externalAttachment`, `documentation`
        definitions.xml:6:37 [bindingType] error S1008 `bindingType` needs the attribute `type`
          add `type="..."` to it
        definitions.xml:6:69 [sca:implementation.java] error S1011 `sca:implementation.java` is no binding
          it names the element of the binding: `sca:binding.NAME`
        definitions.xml:7:81 [mayProvides] error S1007 `implementationType` has no attribute `mayProvides`
          replace `mayProvides` with `mayProvide`
        definitions.xml:8:10 [externalAttachment] error S1008 `externalAttachment` needs the attribute `attachTo`
          add `attachTo="..."` to it
        definitions.xml:8:48 [externalAttachment] warning S1008 `externalAttachment` attaches nothing
          name `intents` or `policySets`
        definitions.xml:8:84 [binding.http] error S1004 SCA 1.1 has no element `binding.http`
          replace `binding.http` with `bindingType`
        definitions.xml:8:84 [binding.http] error S1008 `binding.http` needs the attribute `type`
          add `type="..."` to it
    "#]].assert_eq(&alone("definitions.xml", definitions(OASIS, inside)));
    let bare = format!("<definitions xmlns='{OASIS}'/>");
    expect![[r#"
        definitions.xml:1:2 [definitions] error S1008 `definitions` needs the attribute `targetNamespace`
          add `targetNamespace="..."` to it
    "#]]
    .assert_eq(&alone("definitions.xml", bare));
}

#[test]
fn what_1_0_does_not_have_is_told_there() {
    let inside = "
        <intent name='a' intentType='interaction'><qualifier name='q'/></intent>
        <policySet name='p' attachTo='//x'/><policySet name='r' appliesTo='x'><allow/><runAs/><authorization><allow/></authorization></policySet>
        <externalAttachment attachTo='//x' intents='t:a'/><documentation/>";
    expect![[r#"
        definitions.xml:3:26 [intentType] warning S1014 `intentType` of `intent` is an attribute of SCA 1.1, and this file is of SCA 1.0
          it counts here, and other programs do not know it: let the file be one of SCA 1.1
        definitions.xml:3:52 [qualifier] error S1004 SCA 1.0 has no element `qualifier`
          `intent` can hold `description`
        definitions.xml:4:10 [policySet] error S1008 `policySet` needs the attribute `appliesTo`
          add `appliesTo="..."` to it
        definitions.xml:4:29 [attachTo] warning S1007 `policySet` has no attribute `attachTo`
          `policySet` has the attributes `name`, `provides`, `appliesTo`
        definitions.xml:4:80 [allow] error S1008 `allow` needs the attribute `roles`
          add `roles="..."` to it
        definitions.xml:4:88 [runAs] error S1008 `runAs` needs the attribute `role`
          add `role="..."` to it
        definitions.xml:4:111 [allow] error S1008 `allow` needs the attribute `roles`
          add `roles="..."` to it
        definitions.xml:5:10 [externalAttachment] warning S1004 `externalAttachment` is an element of SCA 1.1, and this file is of SCA 1.0
          other programs refuse it
        definitions.xml:5:60 [documentation] warning S1004 `documentation` is an element of SCA 1.1, and this file is of SCA 1.0
          other programs refuse it
          write a comment instead
    "#]].assert_eq(&alone("definitions.xml", definitions(OSOA, inside)));
}

#[test]
fn what_contradicts_itself_is_told() {
    let inside = "
        <intent name='safe' requires='t:safe' excludes='t:safe'><qualifier name='low'/><qualifier name='high'/><qualifier name='low'/></intent>
        <intent name='fast'><qualifier name='a' default='true'/><qualifier name='b' default='1'/></intent><intent name='slow'/>
        <policySet name='p' provides='t:safe t:slow'><policySetReference name='t:p'/><policySetReference name='t:r'/>
            <intentMap provides='t:safe'><qualifier name='low'/><qualifier name='medium'/></intentMap>
            <intentMap provides='t:safe'><qualifier name='low'/><qualifier name='high'/><qualifier name='high'/></intentMap>
            <intentMap provides='t:fast'><qualifier name='a'/><qualifier name='b'/></intentMap><intentMap provides='t:slow'/>
        </policySet>
        <policySet name='r' provides='t:fast'/><intent name='fast'/><bindingType type='sca:binding.ws'/><bindingType type='sca:binding.ws'/>";
    expect![[r#"
        definitions.xml:3:23 [safe] error S2058 no qualifier of the intent `safe` is the default
          write `default="true"` in one of them
        definitions.xml:3:39 [t:safe] error S2058 the intent `safe` stands for itself
          remove it
        definitions.xml:3:57 [t:safe] error S2058 the intent `safe` excludes itself
          remove it
        definitions.xml:3:129 [low] error S2058 the intent `safe` has the qualifier `low` twice
          remove one of them
        definitions.xml:4:82 [b] error S2058 the intent `fast` has two default qualifiers
          one of its qualifiers is meant where none is said
        definitions.xml:5:80 [t:p] error S2058 the policy set `p` takes over itself
          remove it
        definitions.xml:5:112 [t:r] error S2058 the policy set `p` takes over `t:r`, and does not provide `t:fast`, as that does
          name it in `provides`
        definitions.xml:6:34 [t:safe] error S2058 the map of `t:safe` lacks its qualifier `high`
          a map has all qualifiers of its intent
        definitions.xml:6:82 [medium] error S2058 the intent `t:safe` has no qualifier `medium`
          it has `low`, `high`, `low`
        definitions.xml:7:34 [t:safe] error S2058 the policy set `p` maps `t:safe` twice
          put all qualifiers into one map
        definitions.xml:7:106 [high] error S2058 the map of `t:safe` has the qualifier `high` twice
          remove one of them
        definitions.xml:8:34 [t:fast] error S2058 the policy set `p` maps `t:fast`, and does not provide it
          name the intent in its `provides`
        definitions.xml:8:97 [intentMap] error S2058 `intentMap` maps nothing
          write a `qualifier` in it for each qualifier of the intent
        definitions.xml:10:62 [fast] error S2057 the intent `fast` is declared twice
          give each its own name, or remove one of them
        definitions.xml:10:124 [sca:binding.ws] error S2057 the type of binding `sca:binding.ws` is declared twice
          give each its own name, or remove one of them
    "#]].assert_eq(&alone("definitions.xml", definitions(OASIS, inside)));
    let old = "<intent name='safe'/><intent name='t:safe'/><policySet name='p' provides='t:safe' appliesTo='x'>
        <intentMap provides='t:save' default='c'><qualifier name='a'/><qualifier name='b'/></intentMap></policySet>";
    expect![[r#"
        definitions.xml:2:36 [t:safe] warning S2057 the intent `t:safe` is declared twice
          give each its own name, or remove one of them
        definitions.xml:3:30 [t:save] warning S2058 the policy set `p` maps `t:save`, and does not provide it
          it provides `t:safe`
        definitions.xml:3:47 [c] warning S2058 the map has no qualifier `c`
          it has `a`, `b`
    "#]]
    .assert_eq(&alone("definitions.xml", definitions(OSOA, old)));
}

#[test]
fn names_are_held_to_what_is_declared() {
    let inside = "
        <intent name='safe' requires='t:saef o:safe t:other'><qualifier name='low'/></intent><policySet name='p' provides='t:safe.lwo sca:confidentality sca:own'/>
        <bindingType type='sca:binding.ws' mayProvide='t:safe.low t:none'/><externalAttachment attachTo='x' policySets='t:q t:ps'/><policySet name='ps'/>";
    expect![[r#"
        definitions.xml:3:39 [t:saef] warning S2056 the contribution declares no intent `saef` in the namespace `urn:t`
          replace `saef` with `safe`
        definitions.xml:3:53 [t:other] warning S2056 the contribution declares no intent `other` in the namespace `urn:t`
          declare it, or let the files that declare it be in the contribution
        definitions.xml:3:124 [t:safe.lwo] warning S2056 the intent `safe` has no qualifier `lwo`
          it has `low`
        definitions.xml:3:135 [sca:confidentality] warning S2056 the contribution declares no intent `confidentality` in the namespace `http://docs.oasis-open.org/ns/opencsa/sca/200912`
          replace `confidentality` with `confidentiality`
        definitions.xml:4:67 [t:none] warning S2056 the contribution declares no intent `none` in the namespace `urn:t`
          declare it, or let the files that declare it be in the contribution
        definitions.xml:4:121 [t:q] warning S2056 the contribution declares no policy set `q` in the namespace `urn:t`
          declare it, or let the files that declare it be in the contribution
    "#]].assert_eq(&alone("definitions.xml", definitions(OASIS, inside)));
}

#[test]
fn files_of_one_contribution_belong_together() {
    let one = definitions(OASIS, "<intent name='safe'/><policySet name='p' provides='t:fast'/>");
    let other = definitions(OASIS, "<intent name='safe'/><intent name='fast'/>");
    let mut files =
        vec![("META-INF/definitions.xml", one.clone()), ("policies/definitions.xml", other.clone())];
    // Nobody says that they do.
    expect![[r#"
        META-INF/definitions.xml:2:52 [t:fast] warning S2056 the contribution declares no intent `fast` in the namespace `urn:t`
          declare it, or let the files that declare it be in the contribution
    "#]].assert_eq(&of_folder(&files));
    files.push(("META-INF/sca-contribution.xml", format!("<contribution xmlns='{OASIS}'/>")));
    expect![[r#"
        policies/definitions.xml:2:15 [safe] error S2057 the intent `safe` is declared twice
          give each its own name, or remove one of them
    "#]]
    .assert_eq(&of_folder(&files));
    // What is called so and is something else is nobody's business here.
    let foreign = "<definitions xmlns='http://schemas.xmlsoap.org/wsdl/'/>".to_owned();
    expect![[r#"
        FOLDER:1:1 [] error S0002 a directory without composites
          the names of composites end with `.composite`
    "#]]
    .assert_eq(&of_folder(&[("definitions.xml", foreign.clone())]));
    expect![[r#"
        definitions.xml:1:2 [definitions] error S1001 `definitions` is in the namespace `http://schemas.xmlsoap.org/wsdl/`, and has to be in one of SCA
          a file of this name holds intents and policy sets
          that is `http://docs.oasis-open.org/ns/opencsa/sca/200912` (SCA 1.1), `http://docs.oasis-open.org/ns/opencsa/sca/200903` (SCA 1.1 (draft)) or `http://www.osoa.org/xmlns/sca/1.0` (SCA 1.0)
    "#]].assert_eq(&alone("definitions.xml", foreign.clone()));
    expect!["no file beside composites"].assert_eq(&alone("desk.wsdl", foreign));
    expect!["no file beside composites"].assert_eq(&alone("definitions.xml", "<definitions".to_owned()));
    expect![[r#"
        my.xml:2:2 [intent] error S1008 `intent` needs the attribute `name`
          add `name="..."` to it
    "#]]
    .assert_eq(&alone("my.xml", definitions(OASIS, "<intent/>")));
}

#[test]
fn what_is_beside_a_composite_is_checked_where_that_names_intents() {
    let fleet = |requires: &str| {
        format!(
            "<composite xmlns='{OASIS}' xmlns:t='urn:t' targetNamespace='urn:t' name='fleet'><component name='C'{requires}><implementation.java class='x.Y'/></component></composite>"
        )
    };
    let told = |requires: &str| {
        let faulty = definitions(OASIS, "<intent name='safe' exclude='t:a'/>");
        of_fleet(&[("fleet.composite", fleet(requires)), ("META-INF/definitions.xml", faulty)])
    };
    expect![""].assert_eq(&told(""));
    expect![[r#"
        META-INF/definitions.xml:2:21 [exclude] error S1007 `intent` has no attribute `exclude`
          replace `exclude` with `excludes`
    "#]]
    .assert_eq(&told(" requires='t:safe'"));
}
