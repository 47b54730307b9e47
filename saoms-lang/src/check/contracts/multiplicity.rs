//! Multiplicities that components give references, held against those of classes.

use crate::check::report::Report;
use crate::diagnostic::{Diagnostic, codes, quoted};
use crate::model::{Multiplicity, ReferenceElement};
use crate::registry::ReferenceDeclaration;

/// The number of targets a reference of the class can have.
pub(crate) fn of_class(declared: &ReferenceDeclaration) -> Multiplicity {
    match (declared.optional, declared.many) {
        (true, false) => Multiplicity::ZeroOrOne,
        (false, false) => Multiplicity::One,
        (true, true) => Multiplicity::Any,
        (false, true) => Multiplicity::OneOrMore,
    }
}

/// Checks that the multiplicity that a component gives narrows that of what implements it.
pub(crate) fn check(reference: &ReferenceElement, own: Multiplicity, whose: &str, report: &mut Report<'_>) {
    let Some(given) = reference.multiplicity else { return };
    if given.value.narrows(own) {
        return;
    }
    let message = format!(
        "the multiplicity {} of {} is wider than {} in {whose}",
        quoted(given.value.name()),
        quoted(&reference.name),
        quoted(own.name())
    );
    let one = Diagnostic::new(&codes::MULTIPLICITY_WIDER, given.location, message);
    let narrower = Multiplicity::ALL.into_iter().filter(|one| one.narrows(own));
    let names: Vec<&str> = narrower.map(Multiplicity::name).collect();
    report.push(match own {
        Multiplicity::One => one.help("leave `multiplicity` out: `1..1` is the default"),
        _ => one.help(format!("it can be {}", names.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(" or "))),
    });
}
