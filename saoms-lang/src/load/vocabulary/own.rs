//! What SAOMS adds to SCA in its own namespace.

use super::{Holds, Kind, Known};

const fn own(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { name, holds, doc, required: false, only_1_0: false, only_1_1: false }
}

const fn must(name: &'static str, holds: Holds, doc: &'static str) -> Known {
    Known { required: true, ..own(name, holds, doc) }
}

const IF: Known = own(
    "if",
    Holds::Condition,
    "It is there only where this is true: a comparison of properties of the composite, as `robots > 10 and site == 'north'`.",
);

/// The attributes that SAOMS adds in its own namespace, each with the element that has it; `composite/property` is that of a composite.
pub const OWN_ATTRIBUTES: &[(&str, Known)] = &[
    (
        "component",
        own(
            "path",
            Holds::Text,
            "The path that the component had before `saoms expand` resolved the composites around it.",
        ),
    ),
    (
        "component",
        own(
            "count",
            Holds::Number,
            "How many replicas there are of the component. Its name has to hold an expression such as `${index}` or `${index:03}`; its values and targets can.",
        ),
    ),
    ("component", own("from", Holds::Number, "The index of the first replica; 1 unless given.")),
    (
        "component",
        own(
            "overrides",
            Holds::Table,
            "A table (CSV) beside the composite: a line for each replica that differs, a column for each property that does.",
        ),
    ),
    ("component", IF),
    ("include", IF),
    ("wire", IF),
    (
        "composite/property",
        own(
            "env",
            Holds::Variable,
            "The environment variable that the value is taken from, where it is set and nothing else gives one.",
        ),
    ),
];

/// The elements that SAOMS adds in its own namespace.
pub const OWN_ELEMENTS: &[&str] = &["implementation.rust", "interface.rust", "loop", "severity"];

/// The elements of SCA that a `severity` stands in.
pub const SEVERITY_PARENTS: &[&str] = &["composite", "component", "service", "reference", "wire", "include"];

/// The elements of SCA that an element of SAOMS stands in.
pub(in crate::load) fn own_parents(name: &str) -> &'static [&'static str] {
    match name {
        "severity" => SEVERITY_PARENTS,
        "interface.rust" => &["service", "reference"],
        _ => &["component"],
    }
}

/// What a composite says about how bad a diagnostic is.
pub static SEVERITY: Kind = Kind {
    name: "severity",
    doc: "Sets how bad the diagnostics of one code are: in a composite for all of it, in a component, service, reference, wire or include for that.",
    attributes: &[
        must("code", Holds::Code, "The code of the diagnostics, such as `S4001`."),
        must("level", Holds::Level, "What they become: `allow`, `note`, `warning` or `error`."),
        must("reason", Holds::Text, "Why; it stands in the output for machines."),
    ],
    children: &["documentation"],
};
