//! Elements and attributes of SAOMS in its own namespace.

use super::Known;

attributes! {
    PATH = known "path" Text: "The path that the component had before `saoms expand` resolved the composites around it.";
    COUNT = known "count" Number: "How many replicas there are of the component. Its name has to hold an expression such as `${index}` or `${index:03}`; its values and targets can.";
    FROM = known "from" Number: "The index of the first replica; 1 unless given.";
    OVERRIDES = known "overrides" Table: "A table (CSV) beside the composite: a line for each replica that differs, a column for each property that does.";
    IF = known "if" Condition: "It is there only where this is true: a comparison of properties of the composite, as `robots > 10 and site == 'north'`.";
    ENV = known "env" Variable: "The environment variable that the value is taken from, where it is set and nothing else gives one.";
}

/// The attributes that SAOMS adds in its own namespace, each with the element that has it; `composite/property` is that
/// of a composite.
pub const OWN_ATTRIBUTES: &[(&str, Known)] = &[
    ("component", PATH),
    ("component", COUNT),
    ("component", FROM),
    ("component", OVERRIDES),
    ("component", IF),
    ("include", IF),
    ("wire", IF),
    ("composite/property", ENV),
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

kinds! {
    /// Severities of diagnostics in a composite.
    pub SEVERITY = "severity": "Sets how bad the diagnostics of one code are: in a composite for all of it, in a component, service, reference, wire or include for that." {
        required "code" Code: "The code of the diagnostics, such as `S4001`.";
        required "level" Level: "What they become: `allow`, `note`, `warning` or `error`.";
        required "reason" Text: "Why; it stands in the output for machines.";
    } ["documentation"]
}
