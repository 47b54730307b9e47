//! Orders and calls that wait for the components which carry them out.

use std::collections::VecDeque;
use std::sync::Arc;

use saoms_api::{Cause, Failure};
use saoms_lang::assembly::ComponentSpec;
use serde_json::Value;

use super::call::JsonCall;
use super::remote::RemoteCall;
use super::ticket::Answering;
use super::{Order, OrderError};

/// An order that was accepted.
#[derive(Debug)]
pub(crate) struct PendingOrder {
    pub(super) order: Order,
    /// Where the answer goes; `None` if it was given.
    pub(super) answering: Option<Answering>,
    /// The record in the journal of the order of which this is a part.
    pub(super) part_of: Option<Cause>,
}

/// Orders that wait for a component whose code runs, in the order in which they came.
#[derive(Debug, Default)]
pub(crate) struct PendingOrders {
    pub(super) waiting: VecDeque<(u32, Pending)>,
}

impl PendingOrders {
    /// The orders that were answered when they were accepted: whoever gave them does not give them again.
    pub(in crate::schedule) fn accepted(&self) -> impl Iterator<Item = &PendingOrder> {
        self.waiting.iter().filter_map(|(_, pending)| match pending {
            Pending::Order(order) if order.answering.is_none() && order.part_of.is_none() => Some(&**order),
            _ => None,
        })
    }
}

/// What waits for a component.
#[derive(Debug)]
pub(super) enum Pending {
    Order(Box<PendingOrder>),
    /// A call of another program.
    Call(Box<RemoteCall>),
    /// The end of a change that is undone: the component takes the values of this specification back.
    TakeBack(Arc<ComponentSpec>),
}

impl Pending {
    /// True if nobody wants it any more.
    pub(super) fn is_cancelled(&self, now: u64) -> bool {
        match self {
            Pending::Order(order) => order.is_cancelled(),
            Pending::Call(call) => call.is_late(now),
            Pending::TakeBack(_) => false,
        }
    }
}

/// What a component carries out itself.
pub(crate) enum InCode {
    Order(OrderInCode),
    /// A call of another program, and the record that it follows from.
    Call(RemoteCall, Cause),
    /// The values that it takes back, and why it refuses that.
    TakeBack(Arc<ComponentSpec>, Option<Failure>),
}

/// An order that a component carries out itself: what its code gets, and its answer.
pub(crate) struct OrderInCode {
    pub(super) order: Order,
    pub(super) answering: Option<Answering>,
    /// True if it is from the engine itself, which tells a component something.
    pub(super) is_told: bool,
    /// Its record in the journal.
    pub(super) cause: Cause,
    /// `None` once it has begun.
    pub(super) work: Option<Work>,
    pub(super) answer: Option<Result<Value, OrderError>>,
}

/// What an order has a component do.
pub(super) enum Work {
    /// The specification with the new value.
    Set(Box<ComponentSpec>),
    Call(Box<JsonCall>),
}

impl PendingOrder {
    /// An order that was accepted by an earlier program, and has no answer any more.
    pub(in crate::schedule) fn recalled(order: Order) -> PendingOrder {
        PendingOrder { order, answering: None, part_of: None }
    }

    /// Its line.
    pub(in crate::schedule) fn line(&self) -> String {
        self.order.to_string()
    }

    fn is_cancelled(&self) -> bool {
        self.answering.as_ref().is_some_and(Answering::is_cancelled)
    }
}
