//! What the checker says of real files when classes are taken as given.

use std::fs;
use std::path::{Path, PathBuf};

use saoms_core::check::{Options, check};
use saoms_core::diagnostic::{Diagnostic, Diagnostics, Severity};
use saoms_core::load::{MAX_SIZE, load, load_named};
use saoms_core::model::Contribution;
use saoms_core::registry::Registry;
use saoms_core::source::{Location, Sources};
use saoms_core::xml;

use crate::support::shown;

/// The folder of the collection: `shared/corpus` beside the workspace, or beside one of the folders around it.
fn collection() -> Option<PathBuf> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    workspace.ancestors().map(|folder| folder.join("shared/corpus")).find(|folder| folder.is_dir())
}

fn checked(path: &Path) -> (Vec<Diagnostic>, Sources) {
    let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
    let composite = load(path, &mut sources, &mut diagnostics);
    let mut all = Contribution::of(composite.into_iter().collect());
    load_named(&mut all, MAX_SIZE, &mut sources, &mut diagnostics);
    let options = Options { assume_classes: true, ..Options::default() };
    check(&all, &Registry::new(), &options, &sources, &mut diagnostics);
    (diagnostics.into_sorted(), sources)
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

/// Files that nobody calls invalid and that the schema lets pass, with the error that they have all the same, and where. Every one of them
/// breaks a rule that no schema can state.
const EXCEPTIONS: &[(&str, &str, &str)] = &[
    // These two include each other, so that neither has an end (ASM60031: what is left after inclusion has to be valid). They are there to show
    // that a runtime does not hang; what it makes of them nobody asserts.
    ("itest/recursive/src/main/resources/Demo1Composite.composite", "S2032", "sample:Demo1Composite"),
    ("itest/recursive/src/main/resources/Demo2Composite.composite", "S2032", "sample:Demo2Composite"),
    // Four references of the composite have one name (ASM60006, and SCA 1.0 alike). It is run as a whole only, where nobody names them; the
    // same project calls the same mistake invalid elsewhere (`DuplicateImplementationReferenceName`).
    ("itests/soap12/HelloWorldSOAP12.composite", "S2003", "helloWorldWS"),
    // A component gives one property two values in two elements, of which nothing says which counts (ASM50031): what this file is there to show.
    // The same project calls it invalid elsewhere (`DuplicateComponentPropertyName`).
    (
        "vtest/assembly/component/src/main/resources/component_duplicate_property.composite",
        "S3005",
        "strProperty",
    ),
    // A component has one reference twice (ASM50007): what this file is there to show.
    ("vtest/assembly/component/src/main/resources/referencename_2.composite", "S2004", "b"),
];

#[test]
fn files_that_nobody_calls_invalid_have_no_errors() {
    let Some(folder) = collection() else { return };
    let (mut sound, mut known) = (0, 0);
    for row in rows(&folder) {
        let is_strong = row.verdict == "valid" && !row.evidence.contains("heuristic");
        if row.verdict == "invalid" || !(row.is_valid_by_schema || is_strong) {
            continue;
        }
        let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
        let Some(error) = diagnostics.iter().find(|one| one.severity == Severity::Error) else {
            sound += 1;
            continue;
        };
        let exception = EXCEPTIONS.iter().find(|(path, ..)| row.path.ends_with(path));
        let Some((_, code, at)) = exception.filter(|_| !is_strong) else {
            panic!("{}: {}", row.path, shown(error, &sources));
        };
        assert_eq!((error.code.id, sources.snippet(error.location)), (*code, *at), "{}", row.path);
        known += 1;
    }
    assert!(known <= EXCEPTIONS.len() && sound >= 99 * known, "{sound} without errors, {known} known");
    assert!(sound > 500, "{sound} files were looked at");
}

/// What the messages of Tuscany come to here: code, and the text that it points at. `docs/rules.md` has the same by code.
pub(crate) const MESSAGES: &[(&str, &str, &str)] = &[
    ("AttributeNameSpaceMissing", "S1004", "export"),
    ("AttributePackageMissing", "S1004", "export.java"),
    ("AttributeUnrecognizedNamespace", "S1011", "hna:HelloWorld"),
    ("AttributeWithoutNamespace", "S1011", "{HelloWorld"),
    ("ComponentReferenceTargetNotFound", "S2011", "AddServiceComponent_one"),
    ("ContributionReadException", "S0102", "components"),
    ("DoesntProcessDestinationType", "S1011", "type=\"queue\""),
    ("DoesntProcessResponseDestinationType", "S1011", "type=\"queue\""),
    ("DuplicateComponentName", "S2002", "AddServiceComponent"),
    ("DuplicateComponentPropertyName", "S3005", "serviceName"),
    ("DuplicateImplementationPropertyName", "S2003", "serviceName"),
    ("DuplicateImplementationReferenceName", "S2003", "addService"),
    ("EJBLinkAttributeMissing", "S1008", "implementation.ejb"),
    ("InvalidCorrelationScheme", "S1011", "correlationScheme"),
    ("InvalidJMSDeliveryMode", "S1011", "NON_PERSISTENTS"),
    ("InvalidJMSPriority", "S1011", "20"),
    ("InvalidResponseDestinationType", "S1011", "no"),
    ("InvalidWSDLInterfaceAttr", "S1011", "http://sample/calculator"),
    ("InvalidWsdlElementAttr", "S1011", "http://sample/calculator"),
    ("LocationAttributeMissing", "S1008", ""),
    ("MissingActivationSpecName", "S1011", "name=\"\""),
    ("MissingComponentTypeFile", "S2044", "tuscany:implementation.osgi"),
    ("MissingConnectionFactoryName", "S1011", "name=\"\""),
    ("MissingResponseActivationSpec", "S1011", "name=\"\""),
    ("MissingResponseConnectionFactory", "S1011", "name=\"\""),
    ("MultipleBindingsForService", "S2040", "addBinding"),
    ("MustStartWithSchema", "S1011", "tuscany://localhost:17171"),
    ("NoComponentImplementation", "S1010", "component"),
    ("NoCompositeNamespace", "S1009", "composite"),
    ("PromotedReferenceNotFound", "S2011", "AddService"),
    ("PromotedServiceNotFound", "S2011", "AddServiceComponent_one"),
    ("PropertyShouldSpecifySR", "S1008", "tuscany:properties"),
    ("UnexpectedBindingElement", "S1005", "binding.ws"),
    ("UnexpectedElement", "S1004", "UnexpectedElement"),
    ("UnexpectedImplementationElement", "S1005", "implementation.java"),
    ("UnexpectedInterfaceElement", "S1005", "interface.java"),
    ("UnknownEJBSessionType", "S1011", "state"),
    ("UnknownEJBVersion", "S1011", "EJB4"),
    ("UnknownTokenInURI", "S1011", "jms://queue.sample?transport.jms=QueueConnectionFactory"),
    ("UnresolvedComponentImplementation", "S2031", "sca:dummyImplementation.composite"),
];

/// Messages of which the collection has no file, and the code that says the same.
pub(crate) const MORE_MESSAGES: &[(&str, &str)] = &[
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
    ("InvalidCreate", "S1011"),
    ("InvalidDeliveryMode", "S1011"),
    ("InvalidDestinationType", "S1011"),
    ("InvalidPriority", "S1011"),
    ("LocalAttibuteMissmatch", "S2034"),
    ("MissingJMSOperationPropertyName", "S1008"),
    ("MultipleBindingsForReference", "S2040"),
    ("PropertXSDElementsDontMatch", "S3007"),
    ("PropertXSDTypesDontMatch", "S3007"),
    ("PropertyFileValueInvalid", "S0001"),
    ("PropertyHasManyValues", "S3011"),
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
    ("ReferenceIncompatibleComponentInterface", "S2007"),
    ("ReferenceIncompatibleInterface", "S2015"),
    ("ReferenceIncompatibleMultiplicity", "S2008"),
    ("ReferenceNotFound", "S2006"),
    ("ReferenceNotFoundForComponentReference", "S2006"),
    ("ReferencePromotionIncompatibleInterface", "S2015"),
    ("ReferenceWithoutTargets", "S2018"),
    ("ServiceIncompatibleComponentInterface", "S2007"),
    ("ServiceNotFoundForComponentService", "S2005"),
    ("TooManyReferenceTargets", "S2017"),
    ("URIFoundOnServiceSCABinding", "S2041"),
    ("ValueAttributeForPropertyElement", "S3012"),
    ("WireIncompatibleInterface", "S2015"),
    ("WireSourceNotFound", "S2016"),
    ("WireTargetNotFound", "S2011"),
];

/// Messages for what cannot be seen. `AttributeURIMissing` is about an `export.resource` of the contribution's description, which is not in the
/// collection; the composite beside it has that element in a comment, and no fault.
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
    assert!(found >= 32, "{found} rows were looked at");
}

/// Every diagnostic about every file of the collection is at a name, an attribute, a value or a text, or in one.
#[test]
fn diagnostics_are_at_things_that_can_be_named() {
    let Some(folder) = collection() else { return };
    let mut count = 0;
    for row in rows(&folder) {
        let (diagnostics, sources) = checked(&folder.join("files").join(&row.path));
        for one in &diagnostics {
            let labels = one.labels.iter().map(|label| label.location);
            for place in labels.chain([one.location]) {
                assert!(is_at_a_thing(place, &sources), "{}: {}", row.path, shown(one, &sources));
                count += 1;
            }
        }
    }
    assert!(count > 200, "{count} places were looked at");
}

fn is_at_a_thing(place: Location, sources: &Sources) -> bool {
    let text = sources.get(place.file).text();
    let Some(document) = xml::parse(place.file, text).document else { return true };
    let element = document.element_at(place.span.start);
    let names = [Some(element.name_span()), element.text_span(), element.end_name_span()];
    let attributes = element.attributes().chain(element.namespace_declarations()).map(|one| one.span());
    !place.span.is_empty()
        && names.into_iter().flatten().chain(attributes).any(|thing| thing.contains(place.span))
}
