use std::collections::BTreeMap;

/// What a component kept that has ended, or got a new instance. See
/// [`Context::kept_by_others`](crate::Context::kept_by_others).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KeptByOther<'a> {
    /// The bytes, by the numbers that it chose.
    pub kept: BTreeMap<u64, &'a [u8]>,
    /// True if an earlier program left them, and the component has kept nothing since.
    pub by_earlier_program: bool,
}
