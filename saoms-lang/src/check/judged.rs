//! The one way in which the data of a check say that a part has a fault already.

/// The mark of a fault that is reported. Who reports the fault of a part sets it; what follows from it is not reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Faulty;

/// What is found out about a part, or the mark of its fault.
pub(crate) type Judged<T> = Result<T, Faulty>;
