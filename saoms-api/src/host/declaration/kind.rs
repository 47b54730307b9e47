/// The type of a property, as declarations name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PropertyKind {
    /// `true` or `false`; as in XML Schema also `1` or `0`.
    Boolean,
    /// A whole number in decimal digits, with an optional sign.
    Integer,
    /// A finite number: decimals and an exponent are allowed.
    Float,
    /// Any text.
    String,
    /// A duration, as [`parse_duration`](crate::host::parse_duration) reads it.
    Duration,
    /// One of the allowed texts.
    Enumeration,
    /// Properties of its own.
    Complex,
}

impl PropertyKind {
    /// All of them.
    pub const ALL: [PropertyKind; 7] = [
        PropertyKind::Boolean,
        PropertyKind::Integer,
        PropertyKind::Float,
        PropertyKind::String,
        PropertyKind::Duration,
        PropertyKind::Enumeration,
        PropertyKind::Complex,
    ];

    /// The name that declarations use.
    pub const fn name(self) -> &'static str {
        match self {
            PropertyKind::Boolean => "boolean",
            PropertyKind::Integer => "integer",
            PropertyKind::Float => "float",
            PropertyKind::String => "string",
            PropertyKind::Duration => "duration",
            PropertyKind::Enumeration => "enumeration",
            PropertyKind::Complex => "complex",
        }
    }

    /// The type of this name.
    pub fn from_name(name: &str) -> Option<PropertyKind> {
        PropertyKind::ALL.into_iter().find(|kind| kind.name() == name)
    }
}
