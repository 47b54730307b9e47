//! The versions of SCA, told apart by their namespaces.

/// The namespace of what SAOMS adds to SCA.
pub const SAOMS_NAMESPACE: &str = "urn:saoms:1";

/// A version of SCA.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Version {
    /// SCA 1.0, by OSOA.
    Osoa10,
    /// The committee draft of SCA 1.1, by OASIS.
    Oasis200903,
    /// SCA 1.1, by OASIS.
    Oasis200912,
}

impl Version {
    /// All, the newest first.
    pub const ALL: [Self; 3] = [Self::Oasis200912, Self::Oasis200903, Self::Osoa10];

    /// The namespace of its vocabulary.
    pub const fn namespace(self) -> &'static str {
        match self {
            Self::Osoa10 => "http://www.osoa.org/xmlns/sca/1.0",
            Self::Oasis200903 => "http://docs.oasis-open.org/ns/opencsa/sca/200903",
            Self::Oasis200912 => "http://docs.oasis-open.org/ns/opencsa/sca/200912",
        }
    }

    /// The version that a namespace stands for.
    pub fn from_namespace(namespace: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|version| version.namespace() == namespace)
    }

    /// True if it is 1.1, as a draft or as published.
    pub const fn is_1_1(self) -> bool {
        !matches!(self, Self::Osoa10)
    }

    /// The name that users know.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Osoa10 => "SCA 1.0",
            Self::Oasis200903 => "SCA 1.1 (draft)",
            Self::Oasis200912 => "SCA 1.1",
        }
    }
}
