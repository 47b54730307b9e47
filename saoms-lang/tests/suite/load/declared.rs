//! What files beside composites declare that these name.

use std::fmt::Write as _;
use std::fs;

use expect_test::expect;
use saoms_lang::diagnostic::Diagnostics;
use saoms_lang::load::{MAX_SIZE, load, load_named};
use saoms_lang::model::Contribution;
use saoms_lang::source::Sources;

const OASIS: &str = "http://docs.oasis-open.org/ns/opencsa/sca/200912";

/// What is said of `in/fleet.composite`, with this inside, in a folder of these files.
fn told(inside: &str, files: &[(&str, String)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let fleet = format!(
        "<composite xmlns='{OASIS}' targetNamespace='urn:t' name='fleet' xmlns:t='urn:t' xmlns:o='urn:o' xmlns:xsd='http://www.w3.org/2001/XMLSchema'>\n{inside}</composite>"
    );
    for (name, text) in files.iter().map(|(name, text)| (*name, text)).chain([("in/fleet.composite", &fleet)])
    {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let first = load(&folder.path().join("in/fleet.composite"), &mut sources, &mut diagnostics).unwrap();
    load_named(&mut Contribution::of(vec![first]), MAX_SIZE, &mut sources, &mut diagnostics);
    let mut out = String::new();
    for one in &diagnostics.into_sorted() {
        let at = sources.get(one.location.file).line_column(one.location.span.start);
        let _ = writeln!(
            out,
            "{}:{} {} {} {}",
            at.line,
            at.column,
            one.severity.name(),
            one.code.id,
            one.message
        );
        one.help.iter().for_each(|help| _ = writeln!(out, "  {help}"));
        one.suggestions
            .iter()
            .for_each(|one| _ = writeln!(out, "  {} [{}]", one.description, one.edits[0].replacement));
    }
    out
}

const NAMES: &str = "<property name='a' type='t:Order'/>\n<property name='b' type='t:Ordre'/>\n<property name='c' element='t:Xyz'/>\n<property name='d' type='o:Order'/><property name='e' type='xsd:int'/>
<component name='C' requires='t:safe t:saef t:safe.most o:saef t:other'><implementation.java class='x.Y'/>
<service name='s'><interface.wsdl interface='urn:t#wsdl.interface(Desk)' callbackInterface='urn:t#wsdl.interface(Desc)'/>
<binding.ws wsdlElement='urn:t#wsdl.port(Shop/Prot)'/></service>
<service name='u'><interface.wsdl interface='urn:t#wsdl.porttype(Table)'/><binding.ws wsdlElement='urn:o#wsdl.binding(No)'/></service></component>";

fn schema(inside: &str) -> String {
    format!(
        "<xsd:schema xmlns:xsd='http://www.w3.org/2001/XMLSchema' targetNamespace='urn:t'>{inside}</xsd:schema>"
    )
}

fn files() -> Vec<(&'static str, String)> {
    let wsdl = "<definitions xmlns='http://schemas.xmlsoap.org/wsdl/' targetNamespace='urn:t'><portType name='Desk'/><binding name='B'/><service name='Shop'><port name='Port'/></service></definitions>";
    let definitions = format!(
        "<definitions xmlns='{OASIS}' xmlns:t='urn:t' targetNamespace='urn:t'><intent name='safe'/><policySet name='ps' provides='t:safe'/></definitions>"
    );
    vec![
        ("in/order.xsd", schema("<xsd:complexType name='Order'/><xsd:element name='order'/>")),
        ("in/desk.wsdl", wsdl.to_owned()),
        ("in/META-INF/definitions.xml", definitions),
    ]
}

#[test]
fn names_are_held_against_files_that_declare_others_of_their_namespace() {
    assert_eq!(told(NAMES, &[]), "");
    let known = files();
    expect![[r#"
        3:26 warning S2056 the contribution declares no type `Ordre` in the namespace `urn:t`
          replace `Ordre` with `Order` [t:Order]
        4:29 warning S2056 the contribution declares no element `Xyz` in the namespace `urn:t`
          it declares `order`
        6:38 warning S2056 the contribution declares no intent `saef` in the namespace `urn:t`
          replace `saef` with `safe` [t:safe]
        7:93 warning S2056 the contribution declares no interface of WSDL `Desc` in the namespace `urn:t`
          replace `Desc` with `Desk` [urn:t#wsdl.interface(Desk)]
        8:26 warning S2056 the contribution declares no port of WSDL `Shop/Prot` in the namespace `urn:t`
          replace `Shop/Prot` with `Shop/Port` [urn:t#wsdl.port(Shop/Port)]
        9:46 warning S2056 the contribution declares no interface of WSDL `Table` in the namespace `urn:t`
          it declares `Desk`
    "#]]
    .assert_eq(&told(NAMES, &known));
    // The file may be anywhere in a contribution that says that it is one, and outside of it nowhere.
    let mut far: Vec<(&str, String)> =
        vec![("wsdl/deep/desk.wsdl", known[1].1.clone()), ("xsd/order.xsd", known[0].1.clone())];
    assert_eq!(told(NAMES, &far), "");
    far.push(("META-INF/sca-contribution.xml", format!("<contribution xmlns='{OASIS}'/>")));
    far.push(("META-INF/definitions.xml", known[2].1.clone()));
    assert_eq!(told(NAMES, &far), told(NAMES, &known));
}

/// More may be declared where nobody here looks.
#[test]
fn names_of_what_is_not_whole_are_taken_as_given() {
    let mut including = files();
    including[0].1 = schema("<xsd:include schemaLocation='more.xsd'/><xsd:complexType name='Order'/>");
    including[1].1 =
        including[1].1.replace("<portType", "<import namespace='urn:t' location='more.wsdl'/><portType");
    including.truncate(2);
    assert_eq!(told(NAMES, &including), "");
    let mut broken = files();
    broken[0].1.truncate(40);
    assert_eq!(told(NAMES, &broken), "");
}
