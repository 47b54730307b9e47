//! Diagnostics of the checker for real files when classes are taken as given.

use std::fs;
use std::path::Path;

use saoms_lang::diagnostic::{Diagnostic, Severity};
use saoms_lang::project::Project;
use saoms_lang::registry::Registry;
use saoms_lang::source::{Location, Sources, Span};
use saoms_lang::syntax;

use crate::check::support::shown;
use crate::load::collection::collection;

fn checked(path: &Path) -> (Vec<Diagnostic>, Sources) {
    let compilation = Project::new().file(path).assume_classes(true).compile(&Registry::new());
    (compilation.diagnostics, compilation.sources)
}

/// A row of `verdicts.tsv`.
struct Row {
    path: String,
    is_valid_by_schema: bool,
    verdict: String,
    evidence: String,
    message: String,
    needs: String,
}

fn rows(folder: &Path) -> Vec<Row> {
    let table = fs::read_to_string(folder.join("verdicts.tsv")).unwrap();
    let row = |line: &str| {
        let columns: Vec<&str> = line.split('\t').collect();
        let column = |place: usize| columns.get(place).copied().unwrap_or_default().to_owned();
        Row {
            path: column(0),
            is_valid_by_schema: columns[3] == "valid",
            verdict: column(4),
            evidence: column(5),
            message: column(7),
            needs: column(9),
        }
    };
    table.lines().skip(1).map(row).collect()
}

/// Files that are not called invalid, and that other runtimes accept, with the error that they have all the same, and
/// where. Each of them breaks a rule.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    // These two include each other, so that neither has an end (ASM60031: what is left after inclusion has to be
    // valid). They are there to show that a runtime does not hang; its result is not asserted.
    ("itest/recursive/src/main/resources/Demo1Composite.composite", "S2032", "sample:Demo1Composite"),
    ("itest/recursive/src/main/resources/Demo2Composite.composite", "S2032", "sample:Demo2Composite"),
    // An attribute is misspelt, so that the intent that it names holds nowhere. The schema forbids it (ASM13001); the
    // test that reads the file is about other parts of it.
    ("org/apache/tuscany/sca/policy/xml/Calculator.composite", "S1007", "requiers"),
    // A component gives one property two values in two elements, and no rule says which counts (ASM50031): what this
    // file is there to show. The same project calls it invalid elsewhere (`DuplicateComponentPropertyName`).
    ("vtest/assembly/component/src/main/resources/component_duplicate_property.composite", "S3005", "strProperty"),
    // A component has one reference twice (ASM50007): what this file is there to show.
    ("vtest/assembly/component/src/main/resources/referencename_2.composite", "S2004", "b"),
];

/// Files with a fault that is not reported: the code that is missing, and the reason.
const NOT_JUDGED: &[(&str, &str, &str)] = &[(
    "vtest/assembly/component/src/main/resources/reference_multiplicity_ntargets.composite",
    "S2018",
    "a reference of a foreign implementation has no target: the implementation may find one, and the file is valid",
)];

#[test]
fn what_foreign_implementations_need_is_not_judged() {
    let Some(folder) = collection() else { return };
    let rows = rows(&folder);
    for (path, code, reason) in NOT_JUDGED {
        let row = rows.iter().find(|row| row.path.ends_with(path)).unwrap();
        let (diagnostics, _) = checked(&folder.join("files").join(&row.path));
        assert!(diagnostics.iter().all(|one| one.code.id != *code), "{path}: {reason}");
    }
}

/// The number of files of a kind, and of those with errors.
#[derive(Default)]
struct Tally {
    files: usize,
    faulty: usize,
}

impl Tally {
    fn add(&mut self, is_faulty: bool) {
        self.files += 1;
        self.faulty += usize::from(is_faulty);
    }

    /// True if at most this many of a hundred have errors.
    fn holds(&self, most: usize) -> bool {
        self.faulty * 100 <= self.files * most
    }
}

/// All that a test asserts to be valid, and 99 of 100 of those that a test loads and of those that the schema lets
/// pass.
#[test]
fn files_that_nobody_calls_invalid_have_no_errors() {
    let Some(folder) = collection() else { return };
    let [mut asserted, mut loaded, mut passed] = [Tally::default(), Tally::default(), Tally::default()];
    let mut open: Vec<&str> = EXCEPTIONS.iter().map(|(path, ..)| *path).collect();
    for row in rows(&folder) {
        let is_called_valid = row.verdict == "valid";
        let is_passed = row.is_valid_by_schema && row.verdict != "invalid";
        if !(is_called_valid || is_passed) {
            continue;
        }
        let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
        let error = diagnostics.iter().find(|one| one.severity == Severity::Error);
        if is_called_valid {
            let is_weak = row.evidence.contains("heuristic");
            if is_weak { &mut loaded } else { &mut asserted }.add(error.is_some());
        }
        if is_passed {
            passed.add(error.is_some());
        }
        let Some(error) = error else { continue };
        let exception = EXCEPTIONS.iter().find(|(path, ..)| row.path.ends_with(path));
        let Some((path, code, at)) = exception else { panic!("{}: {}", row.path, shown(error, &sources)) };
        assert_eq!((error.code.id, sources.snippet(error.location)), (*code, *at), "{}", row.path);
        open.retain(|known| known != path);
    }
    assert!(asserted.holds(0), "{} of {}", asserted.faulty, asserted.files);
    assert!(loaded.holds(1), "{} of {}", loaded.faulty, loaded.files);
    assert!(passed.holds(1), "{} of {}", passed.faulty, passed.files);
    assert!(asserted.files >= 15 && loaded.files > 200 && passed.files > 500, "{}", passed.files);
    assert!(open.is_empty(), "no exceptions any more: {open:?}");
}

/// The messages of Tuscany as diagnostics: code, and the text that it points at. `docs/rules.md` has the same by code.
pub(crate) const MESSAGES: &[(&str, &str, &str)] = &[
    ("AttributeCompositeMissing", "S1008", "deployable"),
    ("AttributeNameSpaceMissing", "S1004", "export"),
    ("AttributePackageMissing", "S1004", "export.java"),
    ("ComponentReferenceTargetNotFound", "S2011", "AddServiceComponent_one"),
    ("ContributionReadException", "S0102", "components"),
    ("DuplicateComponentName", "S2002", "AddServiceComponent"),
    ("DuplicateComponentPropertyName", "S3005", "serviceName"),
    ("DuplicateImplementationPropertyName", "S2003", "serviceName"),
    ("DuplicateImplementationReferenceName", "S2003", "addService"),
    ("MissingComponentTypeFile", "S2044", "tuscany:implementation.osgi"),
    ("MultipleBindingsForService", "S2040", "addBinding"),
    ("NoComponentImplementation", "S1010", "component"),
    ("NoCompositeNamespace", "S1009", "composite"),
    ("PromotedReferenceNotFound", "S2011", "AddService"),
    ("PromotedServiceNotFound", "S2011", "AddServiceComponent_one"),
    ("UnexpectedBindingElement", "S1005", "binding.ws"),
    ("UnexpectedImplementationElement", "S1005", "implementation.java"),
    ("UnexpectedInterfaceElement", "S1005", "interface.java"),
    ("UnresolvedComponentImplementation", "S2031", "sca:dummyImplementation.composite"),
];

/// Messages without a file in the collection, and the code that says the same.
pub(crate) const MORE_MESSAGES: &[(&str, &str)] = &[
    ("AttributeURIMissing", "S1008"),
    ("BindingNotFound", "S2013"),
    ("BothTypeAndElementAttributeFound", "S2039"),
    ("ComponentIncompatibleInterface", "S2015"),
    ("CompositeNotFound", "S2030"),
    ("CompositeReferenceIncompatibleMultiplicity", "S2036"),
    ("CompositeReferencePromotesNonOverridableReference", "S2037"),
    ("DuplicateComponentReferenceName", "S2004"),
    ("DuplicateComponentServiceName", "S2004"),
    ("DuplicateCompositeName", "S2001"),
    ("DuplicateImplementationServiceName", "S2003"),
    ("IllegalCompositeIncusion", "S2034"),
    ("LocalAttibuteMissmatch", "S2034"),
    ("MultipleBindingsForReference", "S2040"),
    ("NoComponentReferenceTarget", "S2018"),
    ("PropertXSDTypesDontMatch", "S3007"),
    ("PropertyFileValueInvalid", "S0001"),
    ("PropertyHasManyValues", "S3011"),
    ("PropertyMustSupplyNull", "S3006"),
    ("PropertyNotFound", "S3004"),
    ("PropertyOverrideManyAttribute", "S3011"),
    ("PropertySourceNotFound", "S2024"),
    ("PropertySourceValueInvalid", "S2023"),
    ("PropertySourceXPathInvalid", "S2023"),
    ("PropertyTypeNotFound", "S2050"),
    ("PropertyValueDoesNotMatchComplexType", "S3007"),
    ("PropertyValueDoesNotMatchElement", "S3007"),
    ("PropertyValueDoesNotMatchSimpleType", "S3007"),
    ("PropertyXpathExpressionReturnedNull", "S2023"),
    ("ReferenceEndPointMixWithTarget", "S2054"),
    ("ReferenceIncompatibleComponentInterface", "S2007"),
    ("ReferenceIncompatibleInterface", "S2015"),
    ("ReferenceIncompatibleMultiplicity", "S2008"),
    ("ReferenceInterfaceNotSubSet", "S2007"),
    ("ReferenceNotFound", "S2006"),
    ("ReferenceNotFoundForComponentReference", "S2006"),
    ("ReferencePromotionIncompatibleInterface", "S2015"),
    ("ReferenceWithoutTargets", "S2018"),
    ("ServiceIncompatibleComponentInterface", "S2007"),
    ("ServiceInterfaceNotSubSet", "S2007"),
    ("ServiceNotFoundForComponentService", "S2005"),
    ("TooManyReferenceTargets", "S2017"),
    ("TooManyTargetServices", "S2014"),
    ("URIFoundOnServiceSCABinding", "S2041"),
    ("ValueAttributeForPropertyElement", "S3012"),
    ("WireIncompatibleInterface", "S2015"),
    ("WireSourceNotFound", "S2016"),
    ("WireTargetNotFound", "S2011"),
];

/// Files that are invalid by what others define, and are taken as given here, each with the reason. The others of this
/// kind are in [`MESSAGES`].
const GIVEN_UP: &[(&str, &str)] = &[
    (
        "bindingejb/UnknownEJBSessionType/account.composite",
        "What EJB asks of its bindings and implementations is judged by those who run them.",
    ),
    (
        "bindingjms/InvalidJMSDeliveryMode/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    ("bindingjms/InvalidJMSPriority/service.composite", "What `binding.jms` holds is judged by those who serve it."),
    (
        "bindingjms/MissingActivationSpecName/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    (
        "bindingjms/MissingResponseActivationSpec/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    ("bindingjms/MustStartWithSchema/service.composite", "What `binding.jms` holds is judged by those who serve it."),
    ("bindingjms/UnexpectedElement/service.composite", "What `binding.jms` holds is judged by those who serve it."),
    ("impl/bpel/AttributeWithoutNamespace/helloworld.composite", "The process is a name that BPEL gives a meaning."),
    (
        "impl/resource/LocationAttributeMissing/resource.composite",
        "`implementation.resource` of Tuscany is judged by Tuscany.",
    ),
    (
        "impl/widget/LocationAttributeMissing/widget.composite",
        "`implementation.widget` of Tuscany is judged by Tuscany.",
    ),
    (
        "interfacewsdl/xml/InvalidWSDLInterfaceAttr/Calculator.composite",
        "WSDL is not read, so that no part of it is looked for.",
    ),
    (
        "binding/wsxml/InvalidWsdlElementAttr/Calculator.composite",
        "WSDL is not read, so that no part of it is looked for.",
    ),
    (
        "bindingjms/DoesntProcessDestinationType/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    (
        "bindingjms/InvalidCorrelationScheme/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    (
        "bindingjms/InvalidResponseDestinationType/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    (
        "bindingjms/MissingConnectionFactoryName/service.composite",
        "What `binding.jms` holds is judged by those who serve it.",
    ),
    ("bindingjms/UnknownTokenInURI/service.composite", "What `binding.jms` holds is judged by those who serve it."),
    (
        "impl/bpel/AttributeUnrecognizedNamespace/helloworld.composite",
        "The process is a name that BPEL gives a meaning.",
    ),
    (
        "impl/ejb/EJBLinkAttributeMissing/ejb.composite",
        "What EJB asks of its bindings and implementations is judged by those who run them.",
    ),
    (
        "impl/spring/LocationAttributeMissing/SpringHelloWorld.composite",
        "Where Spring is configured is judged by Spring.",
    ),
    (
        "impl/xquery/LocationAttributeMissing/HelloWorld.composite",
        "`implementation.xquery` of Tuscany is judged by Tuscany.",
    ),
];

/// Messages for what cannot be seen. `AttributeURIMissing` is about an `export.resource` of the contribution's
/// description, which is not in the collection; the composite beside it has that element in a comment, and no fault.
const UNSEEN: &[&str] = &["AttributeURIMissing"];

#[test]
fn files_that_are_invalid_by_what_is_written_have_a_diagnostic_there() {
    let Some(folder) = collection() else { return };
    let mut found = 0;
    for row in rows(&folder) {
        let is_written = row.needs == "composite-only" || row.needs == "composite+sibling-xml";
        if row.verdict != "invalid" || !is_written {
            continue;
        }
        if UNSEEN.contains(&&*row.message) {
            let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
            let all: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
            assert!(diagnostics.is_empty(), "{}: {all}", row.path);
            continue;
        }
        if GIVEN_UP.iter().any(|(path, _)| row.path.ends_with(path)) {
            continue;
        }
        let known = MESSAGES.iter().find(|(message, ..)| *message == row.message);
        let (_, code, at) = known.unwrap_or_else(|| panic!("{} of {}", row.message, row.path));
        let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
        let is_meant = |one: &Diagnostic| {
            let snippet = sources.snippet(one.location);
            one.code.id == *code && one.severity >= Severity::Warning && snippet.contains(at)
        };
        let all: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
        assert!(diagnostics.iter().any(is_meant), "{} of {}:\n{all}", row.message, row.path);
        found += 1;
    }
    assert!(found >= 11, "{found} rows were looked at");
}

/// Every diagnostic about every file of the collection, and about what is beside it, is at the name of an element, at
/// an attribute, its name or its value, at a text, or at a part of one that stands by itself; and the diagnostic speaks
/// of that, or of what it is a part of.
#[test]
fn diagnostics_are_at_what_they_name() {
    let Some(folder) = collection() else { return };
    let (mut count, mut beside) = (0, 0);
    for row in rows(&folder) {
        let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
        for one in &diagnostics {
            let labels = one.labels.iter().map(|label| label.location);
            for place in labels.chain([one.location]) {
                let things = things_at(place, &sources);
                assert!(things.is_some(), "{}: {}", row.path, shown(one, &sources));
                count += 1;
                beside += usize::from(!sources.get(place.file).path().ends_with(&row.path));
            }
            let said = [std::slice::from_ref(&one.message), &one.help[..]].concat().join("\n");
            let things = things_at(one.location, &sources).unwrap_or_default();
            let is_named = things.is_empty() || things.iter().any(|thing| said.contains(thing.as_str()));
            assert!(is_named, "{}: none of {things:?} is in {}", row.path, shown(one, &sources));
        }
    }
    assert!(count > 200 && beside > 0, "{count} places were looked at, {beside} of them beside the files");
}

/// The text at a place, the name of the attribute and the element that it is in; `None` where it is at no such thing.
/// None at all where the file is no well-formed XML, in which a place is at what is not understood.
fn things_at(place: Location, sources: &Sources) -> Option<Vec<String>> {
    let text = sources.get(place.file).text();
    let Ok(document) = syntax::parse(place.file, text).well_formed() else {
        return Some(Vec::new());
    };
    let element = document.innermost(place.span.start).unwrap();
    let snippet = sources.snippet(place);
    let mut things = vec![snippet.to_owned(), element.local_name().to_owned()];
    things.extend(snippet.split([':', '/']).filter(|part| !part.is_empty()).map(str::to_owned));
    if [Some(element.name_span()), element.end_name_span()].contains(&Some(place.span)) {
        return Some(things);
    }
    let mut attributes = element.attributes().chain(element.namespace_declarations());
    if let Some(attribute) = attributes.find(|one| one.span().contains(place.span)) {
        things.push(attribute.name().to_owned());
        let is_whole = place.span == attribute.span() || place.span == attribute.name_span();
        return (is_whole || is_part(place, attribute.value_span(), text)).then_some(things);
    }
    is_part(place, element.text_span()?, text).then_some(things)
}

/// True if a place is a part of a value, or all of it, that begins and ends where a word does.
fn is_part(place: Location, value: Span, text: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let (start, end) = (place.span.start as usize, place.span.end as usize);
    let is_cut =
        |before: Option<char>, behind: Option<char>| before.is_some_and(is_word) && behind.is_some_and(is_word);
    let starts = !is_cut(text[..start].chars().next_back(), text[start..].chars().next());
    let ends = !is_cut(text[..end].chars().next_back(), text[end..].chars().next());
    value.contains(place.span) && !place.span.is_empty() && starts && ends
}
