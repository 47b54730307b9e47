//! What a registry refuses.

use std::fmt;

/// Why a class cannot be registered. The fault is the program's or the plugin's, not that of a composite.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RegistryError {
    /// The declaration is no JSON of the right shape, or contradicts itself.
    Malformed {
        /// The class, or the start of the declaration where it has no readable name.
        class: String,
        /// What is wrong.
        message: String,
    },
    /// The declaration of a loop is no JSON of the right shape, contradicts itself, or its name is taken.
    MalformedLoop {
        /// The loop, or the start of the declaration where it has no readable name.
        name: String,
        /// What is wrong.
        message: String,
    },
    /// The declaration is of another version of the contract.
    Contract {
        /// The class, or the loop.
        class: String,
        /// The version of the declaration.
        found: u32,
    },
    /// A rule has the code of another one.
    CodeTaken {
        /// The code.
        code: &'static str,
        /// The name of the rule.
        rule: &'static str,
    },
    /// A name stands for another class already.
    NameTaken {
        /// The name.
        name: String,
        /// The class that has it.
        first: String,
        /// The class that was to get it.
        second: String,
    },
}

/// The version of the contract that this registry reads.
pub(super) const CONTRACT: u32 = 1;

impl fmt::Display for RegistryError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed { class, message } => {
                write!(out, "the declaration of class `{class}` is malformed: {message}")
            }
            Self::MalformedLoop { name, message } => {
                write!(out, "the declaration of loop `{name}` is malformed: {message}")
            }
            Self::Contract { class, found } => write!(
                out,
                "class `{class}` was built for contract {found}, this program has contract {CONTRACT}: build both from one version"
            ),
            Self::CodeTaken { code, rule } => {
                write!(out, "the code {code} of rule `{rule}` stands for another diagnostic already")
            }
            Self::NameTaken { name, first, second } if first == second => {
                write!(out, "class `{name}` is registered twice")
            }
            Self::NameTaken { name, first, second } => {
                write!(out, "the class name `{name}` of class `{second}` stands for class `{first}` already")
            }
        }
    }
}

impl std::error::Error for RegistryError {}
