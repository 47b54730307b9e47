/// A region of blocks, from one corner to the other, both included.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RegionView {
    /// Column and row of the least corner.
    pub least: [i32; 2],
    /// Column and row of the greatest corner.
    pub most: [i32; 2],
}

/// The message of a state topic that is not in the region of a subscription any more.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DepartedView {
    /// The key of the message; 0 where it has none.
    pub key: u64,
    /// The index of its sender.
    pub sender: u32,
}
