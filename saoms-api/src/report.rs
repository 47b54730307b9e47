/// A value in the run's report.
#[derive(Clone, Debug, PartialEq)]
pub enum ReportValue {
    /// Not known.
    Null,
    /// True or false.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Float(f64),
    /// Text.
    Text(String),
    /// A list.
    List(Vec<ReportValue>),
    /// Named values.
    Map(Vec<(String, ReportValue)>),
}

macro_rules! from {
    ($($type:ty => $variant:ident),* $(,)?) => {
        $(impl From<$type> for ReportValue {
            fn from(value: $type) -> ReportValue {
                ReportValue::$variant(value.into())
            }
        })*
    };
}

from!(bool => Bool, i64 => Integer, i32 => Integer, u32 => Integer, f64 => Float, &str => Text, String => Text);

/// Vote of a component about the work that is left, for [`Context::vote`](crate::Context::vote).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// There is work left.
    Open,
    /// As far as this component sees, the work is done.
    Done,
    /// Some work was given up for good. The run is incomplete then, whatever ends it. This is independent of the work
    /// that is left: `Open` or `Done` does, before or after it.
    GivenUp,
}
