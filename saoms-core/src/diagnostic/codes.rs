//! The table of every kind of diagnostic.
//!
//! A code never changes its meaning and is never used again. `S0` is files and XML, `S1` the SCA vocabulary, `S2`
//! names and wiring, `S3` classes and properties, `S4` tasks and topics.

use super::Severity::{self, Error, Warning};

/// A kind of diagnostic.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// The stable code, as `S0101`.
    pub id: &'static str,
    /// A stable name, as `unknown-attribute`.
    pub name: &'static str,
    /// What it means, in a sentence.
    pub meaning: &'static str,
    /// How bad it is unless something says otherwise.
    pub severity: Severity,
    /// The rule of the SCA specification it enforces, when there is just one.
    pub rule: Option<&'static str>,
}

macro_rules! codes {
    ($($constant:ident = $id:literal $severity:ident $name:literal $(($rule:literal))? : $meaning:literal;)*) => {
        $(
            #[doc = $meaning]
            pub static $constant: Code = Code {
                id: $id,
                name: $name,
                meaning: $meaning,
                severity: $severity,
                rule: codes!(@rule $($rule)?),
            };
        )*

        /// Every code, in the order of the table.
        pub static ALL: &[&Code] = &[$(&$constant),*];
    };
    (@rule) => { None };
    (@rule $rule:literal) => { Some($rule) };
}

codes! {
    // S00: files.
    FILE_NOT_FOUND = "S0001" Error "file-not-found": "There is no file of this name.";
    FILE_IS_DIRECTORY = "S0002" Error "file-is-directory": "A file was expected and a directory found.";
    FILE_UNREADABLE = "S0003" Error "file-unreadable": "The file exists and cannot be read.";
    FILE_TOO_LARGE = "S0004" Error "file-too-large": "The file is past the size limit.";
    FILE_EMPTY = "S0005" Error "file-empty": "The file holds nothing, or nothing but white space.";
    FILE_BINARY = "S0006" Error "file-binary": "The file is no text.";
    FILE_ENCODING = "S0007" Error "file-encoding": "The file is not in UTF-8.";
    TOO_MANY = "S0008" Warning "too-many": "Further diagnostics of one kind in one file are counted, not shown.";
    // S01: XML 1.0 and its namespaces. The first of a file ends the reading of it.
    XML_SYNTAX = "S0101" Error "xml-syntax": "The file is not well-formed XML.";
    XML_TAG_MISMATCH = "S0102" Error "xml-tag-mismatch": "An end tag closes another element than the one that is open.";
    XML_UNCLOSED = "S0103" Error "xml-unclosed": "An element, a comment, a tag or a quote is never closed.";
    XML_OUTSIDE_ROOT = "S0104" Error "xml-outside-root": "Something stands beside the one element that a file has to be.";
    XML_ATTRIBUTE = "S0105" Error "xml-attribute": "An attribute is written wrongly.";
    XML_DUPLICATE_ATTRIBUTE = "S0106" Error "xml-duplicate-attribute": "An element has one attribute twice.";
    XML_NAME = "S0107" Error "xml-name": "The name of an element, an attribute or an instruction is no XML name.";
    XML_CHARACTER = "S0108" Error "xml-character": "A character that XML does not allow.";
    XML_ENTITY = "S0109" Error "xml-entity": "A reference is malformed, or to something other than a character or one of the five predefined entities.";
    XML_DOCTYPE = "S0110" Error "xml-doctype": "Document type declarations are refused.";
    XML_DECLARATION = "S0111" Error "xml-declaration": "The XML declaration is malformed or not at the very start.";
    XML_PREFIX = "S0112" Error "xml-prefix": "A prefix is bound to no namespace, or a binding is not allowed.";
    // S10: the vocabulary of SCA.
    ROOT = "S1001" Error "root": "The root element is no composite.";
    NAMESPACE = "S1002" Error "namespace" ("ASM13001"): "The root element is in none of the namespaces of SCA.";
    OTHER_VERSION = "S1003" Error "other-version" ("ASM13001"): "An element is of another version of SCA than the composite it is in.";
    UNKNOWN_ELEMENT = "S1004" Error "unknown-element" ("ASM13001"): "An element of SCA, or of SAOMS, that does not exist.";
    MISPLACED_ELEMENT = "S1005" Error "misplaced-element" ("ASM13001"): "An element that cannot stand where it stands.";
    REPEATED_ELEMENT = "S1006" Error "repeated-element" ("ASM13001"): "An element that can be given once is given again.";
    UNKNOWN_ATTRIBUTE = "S1007" Error "unknown-attribute" ("ASM13001"): "An attribute that the element does not have.";
    MISSING_ATTRIBUTE = "S1008" Error "missing-attribute" ("ASM13001"): "An attribute that the element has to have is not given.";
    MISSING_TARGET_NAMESPACE = "S1009" Error "missing-target-namespace" ("ASM13001"): "A composite has no target namespace.";
    MISSING_IMPLEMENTATION = "S1010" Error "missing-implementation" ("ASM13001"): "A component has no implementation.";
    ATTRIBUTE_VALUE = "S1011" Error "attribute-value" ("ASM13001"): "The value of an attribute is of the wrong form.";
    MISPLACED_TEXT = "S1012" Error "misplaced-text" ("ASM13001"): "There is text where none belongs.";
}
