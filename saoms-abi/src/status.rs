/// The outcome of a call. Every value but `OK` comes with a text in the call's sink for errors.
#[repr(transparent)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Status(pub u32);

impl Status {
    /// It is done.
    pub const OK: Status = Status(0);
    /// A failure.
    pub const FAILED: Status = Status(1);
    /// The code of the callee panicked.
    pub const PANICKED: Status = Status(2);
    /// The reference is not wired; the text is its name.
    pub const NOT_WIRED: Status = Status(3);
    /// The provider is in the middle of something; the text is its name. A component may answer with it, too: its
    /// execution is skipped, its initialization and shutdown are tried again.
    pub const BUSY: Status = Status(4);
    /// The provider is not running; the text is its name.
    pub const NOT_RUNNING: Status = Status(5);
    /// The provider knows no such service, operation or arguments.
    pub const MISMATCH: Status = Status(6);
    /// The provider failed; the text is its name, a zero byte, and its words.
    pub const PROVIDER_FAILED: Status = Status(7);
    /// A transport or the program has no room for a message now. No text comes with it.
    pub const FULL: Status = Status(8);
    /// Nobody answers at the url of a network now.
    pub const UNREACHABLE: Status = Status(9);
}
