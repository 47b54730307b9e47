//! From the model to an assembly: the faults that a fleet can have before anything runs.
//!
//! [`check`] is pure: it knows no clock, no thread, no network, and reads nothing but its arguments. A check is a sequence of phases; `examine` is
//! the one place where their order is written down. Each phase looks at everything, so that all faults come in one run, from cheap rules to expensive
//! ones. What depends on a faulty part is not looked at: one mistake gives one diagnostic. `component::State` says of a component that it is faulty.

mod assemble;
mod component;
mod fleet;
mod loops;
mod occurrences;
mod options;
mod properties;
mod report;
mod rules;
mod setting;
mod tasks;
mod unfolding;
mod values;
mod variable;
mod wiring;

use crate::assembly::Assembly;
use crate::diagnostic::{Diagnostic, Diagnostics, codes};
use crate::model::Contribution;
use crate::registry::Registry;
use crate::source::Sources;

use assemble::CheckedFleet;
use fleet::classes;
use report::Report;
use report::severities::Severities;
use unfolding::arena::Arena;
use values::parameters::Parameters;

pub use occurrences::{Occurrences, TopicUse};
pub use options::Options;
pub use report::severities::SeveritySetting;
pub use setting::Setting;
pub use variable::Variable;

/// Checks composites as one fleet, and resolves them when there is no error among `diagnostics`, those from before
/// included, and nothing had to be taken as given.
///
/// ```
/// use saoms_lang::check::{Options, check};
/// use saoms_lang::{diagnostic::Diagnostics, load::load_file, model::Contribution, registry::Registry, source::Sources};
///
/// let text = r#"<composite xmlns="http://www.osoa.org/xmlns/sca/1.0" name="fleet" targetNamespace="urn:fleet">
///     <component name="Robot001"><implementation.java class="robot.Robot001"/></component>
/// </composite>"#;
/// let (mut sources, mut diagnostics) = (Sources::new(), Diagnostics::new());
/// let file = sources.add("fleet.composite", text);
/// let fleet = load_file(file, &sources, &mut diagnostics).unwrap();
/// let fleet = Contribution::of(vec![fleet]);
/// let assembly = check(&fleet, &Registry::new(), &Options::default(), &sources, &mut diagnostics);
/// assert!(assembly.is_none());
/// assert_eq!(diagnostics.iter().next().unwrap().message, "there is no class `robot.Robot001`");
/// ```
pub fn check(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<Assembly> {
    examine(contribution, registry, options, sources, diagnostics, |sound, severities, report| {
        let places = if options.wiring { sound.places(report) } else { Vec::new() };
        let assembly = sound.assemble(|one| classes::library(one, contribution, sources))?;
        if options.wiring {
            let known = report.diagnostics().len();
            rules::traffic::check(&assembly, &places, report);
            severities.apply(known, report.diagnostics());
        }
        Some(assembly)
    })
}

/// Checks composites for the diagnostics alone, without an assembly: the number of components that it would have.
///
/// What [`Options::wiring`] asks for is told of assemblies only.
pub fn count(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    examine(contribution, registry, options, sources, diagnostics, |sound, _, _| sound.count())
}

/// Runs all phases in their order, and makes something of a fleet without errors.
fn examine<T>(
    contribution: &Contribution,
    registry: &Registry,
    options: &Options,
    sources: &Sources,
    diagnostics: &mut Diagnostics,
    make: impl FnOnce(CheckedFleet<'_, '_>, &mut Severities, &mut Report<'_>) -> Option<T>,
) -> Option<T> {
    let assumes = options.assume_classes;
    let mut severities = Severities::of(contribution, options, registry, diagnostics);
    let report = &mut Report::new(sources, diagnostics);
    report.assumes = assumes;
    report.tells_echoes = severities.mentions(&codes::NOT_UNIQUE);
    report.lowers_attributes = severities.mentions(&codes::UNKNOWN_ATTRIBUTE);

    // Composites, includes, inner composites, replicas and conditions become one list of components; each has its class.
    let replicas = Arena::new();
    let mut fleet = unfolding::unfold(contribution, options, &replicas, report);
    let mut parameters = Parameters::of(&fleet, options, report);
    let mut classes = classes::resolve(&mut fleet, contribution, registry, assumes, report);

    // Each component alone: properties, loops, tasks.
    let mut checks = properties::check_all(&fleet, &classes, &mut parameters, report);
    loops::resolve(&mut fleet, &mut classes, &mut checks, registry, &mut parameters, report);
    parameters.finish(&fleet, report);
    // From here on only components that are there count: rules below compare several.
    unfolding::remove_absent::remove(&mut fleet, &mut checks);
    tasks::check_all(&fleet, &classes, &mut checks, report);

    // Services, references, promotions and wires.
    rules::written::check(&fleet, report);
    let is_misread = |one: &Diagnostic| one.code.id.starts_with("S10") && !severities.mentions(one.code);
    let is_misread = report.diagnostics().iter().any(is_misread);
    let known = report.errors();
    rules::contracts::check(&fleet, &classes, report);
    rules::component_types::check(&fleet, &classes, report);
    let promoted = wiring::promotion::check(&fleet, &classes, report);
    let wiring = wiring::check(&fleet, &classes, &promoted, report);
    let has_open_wires = is_misread || report.errors() > known;

    // The expensive rules: constructors, and rules of plugins over the whole fleet.
    rules::constructors::check_all(&fleet, &classes, &checks, options.without_plugin_code, report);
    let rules = registry.rules().iter();
    let rules = rules.filter(|rule| !options.without_plugin_code || rule.origin().is_none());
    rules::plugin_rules::check(&fleet, &classes, &checks, (&wiring, has_open_wires), rules, report);

    // Severities count at the end, and an error anywhere keeps the fleet from running.
    if assumes {
        properties::foreign::lower_missing_files(&fleet, report);
    }
    report.finish();
    severities.apply(0, report.diagnostics());
    if report.has_errors() {
        severities.overruled(report.diagnostics());
        return None;
    }
    let made = make(CheckedFleet { fleet, classes, checks, wiring }, &mut severities, report);
    severities.finish(options.wiring, report.diagnostics());
    severities.overruled(report.diagnostics());
    made.filter(|_| !report.has_errors())
}
