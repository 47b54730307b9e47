//! Tokens: the pieces that a text is cut into.

/// The kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// A byte order mark at the start of the text.
    Mark,
    /// `<a ...>`
    StartTag,
    /// `<a .../>`
    EmptyTag,
    /// `</a>`
    EndTag,
    /// White space alone.
    Space,
    /// Character data that is more than white space.
    Text,
    /// `<![CDATA[...]]>`
    Section,
    /// `<!-- ... -->`
    Comment,
    /// `<?...?>`, the XML declaration included.
    Instruction,
    /// `<!DOCTYPE ...>`
    Doctype,
    /// Markup that is none: a `<` by itself, or an end tag that ends nothing.
    Error,
    /// Nothing, behind the last byte.
    End,
}

/// A token; it ends where the next one starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Token {
    pub(super) start: u32,
    pub(super) kind: TokenKind,
    /// Of a start tag, the flags of its element.
    pub(super) flags: u8,
}

/// Text other than white space is directly inside.
pub(super) const HAS_TEXT: u8 = 1;
/// The end tag was found, or none is needed.
pub(super) const CLOSED: u8 = 2;
/// Attributes may be missing, or may be meant otherwise.
pub(super) const DAMAGED_TAG: u8 = 4;
/// Elements or texts directly inside may be missing, or may belong elsewhere.
pub(super) const DAMAGED_CONTENT: u8 = 8;
/// Nobody knows what the text means: that of a token, or that directly inside an element.
pub(super) const UNSURE_TEXT: u8 = 16;
/// The start tag has no `>`.
pub(super) const BROKEN_OFF: u8 = 32;
/// The name of the element, or of an attribute, has a prefix, or a namespace is declared.
pub(super) const PREFIXED: u8 = 64;
/// The prefix of the element's name is bound to no namespace, or its name is none.
pub(super) const UNNAMED: u8 = 128;

impl Token {
    pub(super) fn is_start(self) -> bool {
        matches!(self.kind, TokenKind::StartTag | TokenKind::EmptyTag)
    }
}
