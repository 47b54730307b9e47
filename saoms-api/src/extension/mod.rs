//! Extensions that a crate of components adds to the program beside classes, loops and rules.
//!
//! A crate knows its domain; the program does not. The crate registers its knowledge of the domain with [`submit!`],
//! and the program shows it:
//!
//! - [`RunSummary`]: the counts of a report and their meaning, in reports and on the console,
//! - [`RunPicture`]: a picture of a run (`saoms run --paths`),
//! - [`CurvesRegistration`]: figures of a run over time (`saoms run --timeline`), and which of them is its work,
//! - [`DashboardView`]: what the page for browsers shows of the domain (`saoms run --serve`),
//! - [`DrawingRegistration`]: what a recording shows of a run to other programs (`saoms run --record`),
//! - [`HistoryRegistration`]: tables of the history that a run leaves (`saoms run --history`),
//! - [`InvariantsRegistration`]: what has to hold in each run, whatever is done to the fleet (`saoms simulate`),
//! - [`PropertyLanguage`]: the language of a property's text, for the checker and editors,
//! - [`EventLanguage`]: the language of events from outside a running fleet (`saoms run --events`),
//! - [`RouterClass`]: a class whose components are routers of networks,
//! - [`RemoteProxy`]: how services of an interface are called in other programs without waiting,
//! - [`ServiceEffects`]: which operations of an interface have effects outside of the program,
//! - [`ChangeLimit`]: what may not change in a fleet while it runs (`saoms apply`),
//! - [`ChangeConsequence`]: what follows of such a change beside its components (`saoms plan`),
//! - [`FailureNotice`]: what a fleet is told of a component that failed and lost what it knew.
//!
//! Extensions are linked in, together with the classes they belong to. The libraries of plugins cannot bring any.

mod changes;
mod curves;
mod dashboard;
mod drawing;
mod effects;
mod events;
mod failures;
mod history;
mod invariants;
mod language;
mod picture;
mod remote;
mod routers;
mod summary;

pub use inventory::submit;

pub use crate::time::DURATION_UNITS;
pub use changes::{ChangeConsequence, ChangeLimit, ChangeObjection};
pub use curves::{Curve, CurvesRegistration, RunCurves};
pub use dashboard::{DashboardLine, DashboardPlot, DashboardState, DashboardView, Summary};
pub use drawing::{DrawingRegistration, DrawnMessage, RunDrawing};
pub use effects::ServiceEffects;
pub use events::{EventContent, EventLanguage, EventReader, EventSource, LineFault, TimedMessage};
pub use failures::{FailureNotice, Outage};
pub use history::{
    HistoryColumn, HistoryKind, HistoryRegistration, HistoryRow, HistoryTable, HistoryValue, RunHistory,
};
pub use invariants::{
    ConcernedComponent, ConcernedTopic, InvariantsRegistration, Measure, RunEnd, RunInvariants, Violation,
};
pub use language::{
    Completion, CompletionKind, Explanation, JudgedTexts, PropertyLanguage, PropertyText, PropertyTexts, RaisedEvent,
    RaisedFault,
};
pub use picture::{PictureRegistration, RunPicture};
pub use remote::{CallLine, CallOutcome, CallProxy, RemoteProxy};
pub use routers::{Access, Router, RouterClass, TlsPaths, Topics};
pub use summary::{Counts, RunSummary};
