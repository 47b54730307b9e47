//! Services and references, with their interfaces, callbacks and bindings.

use std::time::Duration;

use smol_str::SmolStr;

use super::Origin;
use crate::source::{Located, Text};

/// A service: of a component, or of a composite, which promotes one of a component.
#[derive(Clone, Debug, PartialEq)]
pub struct ServiceElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `promote`, of a composite's service: `component` or `component/service`.
    pub promote: Option<Text>,
    /// `deadline`, in the namespace of SAOMS: the time within which a call from the web is answered, in a box: most
    /// have none.
    pub deadline: Option<Box<Located<Duration>>>,
    /// Its interface, bindings and callback, in a box: most have none. [`Self::contract`] gives it.
    pub contract: Option<Box<Contract>>,
}

/// A reference: of a component, or of a composite, which promotes those of components.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceElement {
    /// The origin in its file.
    pub origin: Origin,
    /// `name`; empty, at the tag, when the file has none.
    pub name: Text,
    /// `target`: each URI, `component`, `component/service` or `component/service/binding`, with its own place.
    pub targets: Vec<Text>,
    /// `promote`, of a composite's reference: each URI with its own place.
    pub promote: Vec<Text>,
    /// `multiplicity`.
    pub multiplicity: Option<Located<Multiplicity>>,
    /// `autowire`.
    pub autowire: Option<Located<bool>>,
    /// `wiredByImpl`.
    pub wired_by_impl: Option<Located<bool>>,
    /// `nonOverridable` (1.1).
    pub non_overridable: Option<Located<bool>>,
    /// `deadline`, in the namespace of SAOMS: the time within which a call of another program is answered, in a box:
    /// most have none.
    pub deadline: Option<Box<Located<Duration>>>,
    /// `tokenEnv`, in the namespace of SAOMS: the environment variable with the token for a server of the web, in a
    /// box: most have none.
    pub token_env: Option<Box<Text>>,
    /// Its interface, bindings and callback, in a box: most have none. [`Self::contract`] gives it.
    pub contract: Option<Box<Contract>>,
}

/// Interface, bindings and callback of a service or a reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contract {
    /// Its interface.
    pub interface: Option<InterfaceElement>,
    /// Its bindings in order.
    pub bindings: Vec<Binding>,
    /// Its callback.
    pub callback: Option<Callback>,
}

static NO_CONTRACT: Contract = Contract { interface: None, bindings: Vec::new(), callback: None };

impl ServiceElement {
    /// Its interface, bindings and callback.
    pub fn contract(&self) -> &Contract {
        self.contract.as_deref().unwrap_or(&NO_CONTRACT)
    }
}

impl ReferenceElement {
    /// Its interface, bindings and callback.
    pub fn contract(&self) -> &Contract {
        self.contract.as_deref().unwrap_or(&NO_CONTRACT)
    }
}

/// The number of targets that a reference can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Multiplicity {
    /// `0..1`
    ZeroOrOne,
    /// `1..1`, the default.
    One,
    /// `0..n`
    Any,
    /// `1..n`
    OneOrMore,
}

impl Multiplicity {
    /// All, as the specification lists them.
    pub const ALL: [Self; 4] = [Self::ZeroOrOne, Self::One, Self::Any, Self::OneOrMore];

    /// As it is written in a composite.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ZeroOrOne => "0..1",
            Self::One => "1..1",
            Self::Any => "0..n",
            Self::OneOrMore => "1..n",
        }
    }

    /// The multiplicity that is written so.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }

    /// True if at least one target is required.
    pub const fn is_required(self) -> bool {
        matches!(self, Self::One | Self::OneOrMore)
    }

    /// True if more than one target is allowed.
    pub const fn is_many(self) -> bool {
        matches!(self, Self::Any | Self::OneOrMore)
    }

    /// True if it is `other`, or allows fewer numbers of targets than it.
    pub const fn narrows(self, other: Self) -> bool {
        (self.is_required() || !other.is_required()) && (!self.is_many() || other.is_many())
    }
}

/// An interface of a service or a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct InterfaceElement {
    /// The origin in its file.
    pub origin: Origin,
    /// The kind of the interface.
    pub kind: InterfaceKind,
    /// `interface`: the name of the interface in its language.
    pub interface: Option<Text>,
}

/// A kind of interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum InterfaceKind {
    /// `interface.java`
    Java,
    /// `interface.rust`, in the SCA namespace or in that of SAOMS.
    Rust,
    /// Another one of SCA.
    Sca,
    /// One of another namespace.
    Other,
}

/// A binding of a service, a reference or a callback.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// The origin in its file.
    pub origin: Origin,
    /// The kind: the text behind `binding.`, as `ws`.
    pub kind: SmolStr,
    /// True if its element is of an SCA namespace.
    pub is_sca: bool,
    /// True if its element is of the namespace of SAOMS.
    pub is_own: bool,
    /// `name`.
    pub name: Option<Text>,
    /// `uri`.
    pub uri: Option<Text>,
}

impl Binding {
    /// True if it leads from or to the web: `binding.rest` of SCA or of SAOMS. Those of other runtimes mean what these
    /// say, such as servers of their own.
    pub fn is_rest(&self) -> bool {
        self.kind == "rest" && (self.is_sca || self.is_own)
    }
}

/// The callback of a service or a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Callback {
    /// The origin in its file.
    pub origin: Origin,
    /// Its bindings in order.
    pub bindings: Vec<Binding>,
}

parts!(ServiceElement, ReferenceElement, InterfaceElement, Binding, Callback);
