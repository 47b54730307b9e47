//! From the model to an assembly: the faults that a fleet can have before anything runs.
//!
//! [`check`] is pure: it knows no clock, no thread, no network, and reads nothing but its arguments. It is a sequence
//! of phases, and the one place where their order is written down. Each phase looks at everything, so that all faults
//! come in one run, from cheap rules to expensive ones. What depends on a faulty part is not looked at: one mistake
//! gives one diagnostic. A part that is faulty carries that itself: `judged::Faulty`.

mod assemble;
mod classes;
mod component;
mod contracts;
mod fleet;
mod hidden;
mod judged;
mod loops;
mod occurrences;
mod options;
mod parameters;
mod placement;
mod properties;
mod report;
mod rules;
mod run_settings;
mod tasks;
mod unfolding;
mod values;
mod wanted_tables;
mod web;
mod wiring;

use crate::assembly::Assembly;
use crate::diagnostic::{Diagnostics, codes};
use crate::model::Contribution;
use crate::registry::Registry;
use crate::source::Sources;

use component::ComponentCheck;
use parameters::Parameters;
use report::Report;
use report::severities::Severities;
use tasks::unique_values::RepeatedValues;
use unfolding::append_list::AppendList;

pub use occurrences::{Occurrences, TopicUse};
pub use options::{Options, Setting, Variable};
pub use report::severities::SeveritySetting;
pub use wanted_tables::wanted_tables;

/// Checks composites as one fleet, and resolves them when there is no error among `diagnostics`, those from before
/// included, and nothing had to be taken as given.
///
/// ```
/// use saoms_lang::check::{Options, check};
/// use saoms_lang::{diagnostic::Diagnostics, load::load_file, model::Contribution};
/// use saoms_lang::{registry::Registry, source::Sources};
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
    let mut severities = Severities::of(contribution, options, registry, diagnostics);
    let report = &mut Report::new(sources, diagnostics);

    // Composites, includes, inner composites, replicas and conditions become one list of components; each has its
    // class.
    let replicas = AppendList::new();
    let mut fleet = unfolding::unfold(contribution, options, &severities, &replicas, report);
    let mut parameters = Parameters::of(&fleet, options, report);
    classes::resolve(&mut fleet, registry, options, report);

    // Each component alone: properties, loops, tasks.
    let given = properties::check_all(&fleet, &mut parameters, report);
    let loops = loops::resolve(&mut fleet, &given, (registry, options), &mut parameters, report);
    let mut checks: Vec<_> = given.into_iter().zip(loops).map(ComponentCheck::new).collect();
    parameters.finish(&fleet, report);
    // From here on only components that are there count: rules below compare several.
    unfolding::remove_absent::remove(&mut fleet, &mut checks);
    let repeated = tasks::check_all(&fleet, &mut checks, report);
    // Where it is let pass that components share a value, that is no fault which others come of.
    let repeated = if severities.mentions(&codes::NOT_UNIQUE) { RepeatedValues::default() } else { repeated };

    // Services, references, promotions and wires, to the web, too; what is said of the run; which node runs what.
    contracts::check(&fleet, report);
    run_settings::check(&fleet, report);
    let (wiring, web_ends) = wiring::check(&fleet, options, report);
    let web = web::check(&fleet, &web_ends, report);

    placement::check(&fleet, (&checks, &wiring, &web), options, report);

    // Constructors, and rules of crates of components: the expensive ones.
    rules::check(&fleet, (&checks, &wiring), &repeated, (registry, options), report);

    // Severities count at the end, and an error anywhere keeps the fleet from running.
    if options.assume_classes {
        properties::foreign::lower_missing_files(&fleet, report);
    }
    report.finish();
    hidden::check(contribution, sources, report);
    severities.apply(0, report.diagnostics());
    if report.has_errors() {
        severities.overruled(report.diagnostics());
        return None;
    }
    let places = if options.wiring { rules::traffic::places(&fleet, &checks) } else { Vec::new() };
    let assembly = assemble::assemble(&fleet, checks, (&wiring, web), sources);
    if let Some(assembly) = assembly.as_ref().filter(|_| options.wiring) {
        let known = report.diagnostics().len();
        rules::traffic::check(assembly, &places, report);
        severities.apply(known, report.diagnostics());
    }
    severities.finish(options.wiring, report.diagnostics());
    severities.overruled(report.diagnostics());
    assembly.filter(|_| !report.has_errors())
}
