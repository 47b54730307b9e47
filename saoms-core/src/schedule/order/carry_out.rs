//! The way of an order: it is checked when it comes, waits for its instant, and takes effect before the executions that
//! are due then.

use std::collections::VecDeque;
use std::sync::Arc;

use saoms_api::host::Invocation;
use saoms_api::host::contain::contained;
use saoms_api::{CallError, Cause, Failure, Level, Time};
use saoms_lang::assembly::ComponentSpec;
use serde_json::Value;

use super::call::JsonCall;
use super::remote::RemoteCall;
use super::ticket::{Answering, OrderTicket, ticket};
use super::{Order, OrderError};
use crate::observe::Occurrence;
use crate::schedule::change::{self, SetError};
use crate::schedule::component::body::Body;
use crate::schedule::engine::lifecycle::Request;
use crate::schedule::engine::memory::{SetForm, value_hash};
use crate::schedule::engine::slot::NEVER;
use crate::schedule::engine::{Engine, RunPhase};
use crate::schedule::inject::{self, InjectedContent, Injection, OUTSIDE_NAME};
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;
use crate::schedule::stop::STOPPED;

/// An order that was accepted.
#[derive(Debug)]
pub(crate) struct PendingOrder {
    order: Order,
    /// Where the answer goes; `None` if it was given.
    answering: Option<Answering>,
    /// The record in the journal of the order of which this is a part.
    part_of: Option<Cause>,
}

/// Orders that wait for a component whose code runs, in the order in which they came.
#[derive(Debug, Default)]
pub(crate) struct PendingOrders {
    waiting: VecDeque<(u32, Pending)>,
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
enum Pending {
    Order(Box<PendingOrder>),
    /// A call of another program.
    Call(Box<RemoteCall>),
}

impl Pending {
    /// True if nobody wants it any more.
    fn is_cancelled(&self, now: u64) -> bool {
        match self {
            Pending::Order(order) => order.is_cancelled(),
            Pending::Call(call) => call.is_late(now),
        }
    }
}

/// What a component carries out itself.
pub(crate) enum InCode {
    Order(OrderInCode),
    /// A call of another program, and the record that it follows from.
    Call(RemoteCall, Cause),
}

/// An order that a component carries out itself: what its code gets, and its answer.
pub(crate) struct OrderInCode {
    order: Order,
    answering: Option<Answering>,
    /// Its record in the journal.
    cause: Cause,
    /// `None` once it has begun.
    work: Option<Work>,
    answer: Option<Result<Value, OrderError>>,
}

enum Work {
    /// The specification with the new value.
    Set(Box<ComponentSpec>),
    Call(JsonCall),
}

/// Checks an order and queues it for its time, or for the next instant.
///
/// # Errors
/// It is refused.
pub(in crate::schedule) fn accept(shared: &Shared, order: Order, at: Option<Time>) -> Result<OrderTicket, OrderError> {
    let (ticket, answering) = ticket();
    if let Order::Publish { topic, message } = &order {
        let (topic, content) = (topic.clone(), InjectedContent::Fields(message.clone()));
        let injection = Injection { topic, content, at, text: order.to_string() };
        inject::inject(shared, injection).map_err(OrderError::Message)?;
        let _ = answering.give(Ok(Value::Null));
        return Ok(ticket);
    }
    let mut engine = shared.lock();
    if matches!(engine.phase, RunPhase::Stopping | RunPhase::Ended) {
        return Err(OrderError::Ending);
    }
    engine.judge(&order)?;
    let answering = match engine.begin_stop_order(&order, at) {
        Some(names) => {
            let _ = answering.give(Ok(names));
            None
        }
        None => Some(answering),
    };
    shared.release(engine);
    inject::add_order(shared, at, PendingOrder { order, answering, part_of: None });
    Ok(ticket)
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

impl Engine {
    /// Checks an order as far as it can be checked before it takes effect.
    fn judge(&self, order: &Order) -> Result<(), OrderError> {
        match order {
            Order::Start { component, .. } | Order::Stop { component } => {
                self.periodic(component).map(drop).map_err(OrderError::Component)
            }
            Order::Set { component, .. } | Order::Call { component, .. } => {
                let (number, service) = self.provider(component)?;
                self.work(order, number, service).map(drop)
            }
            Order::EmergencyStop { components, .. } => {
                self.to_stop(components).map(drop).map_err(OrderError::Component)
            }
            Order::Release { components, .. } => self.to_release(components).map(drop).map_err(OrderError::Component),
            Order::Publish { .. } => Ok(()),
        }
    }

    /// The components of an emergency stop, or of a release, that takes effect at the next instant. A stop waits for
    /// nothing: its components are stopped already.
    fn begin_stop_order(&mut self, order: &Order, at: Option<Time>) -> Option<Value> {
        let components = match order {
            _ if at.is_some() => return None,
            Order::EmergencyStop { components, .. } => {
                let components = self.to_stop(components).ok()?;
                self.stop_at_once(&components);
                components
            }
            Order::Release { components, .. } => self.to_release(components).ok()?,
            _ => return None,
        };
        Some(components.iter().map(|index| Value::from(&*self.slots[*index as usize].name)).collect())
    }

    /// Lets an emergency stop or a release take effect.
    fn carry_out_stop(&mut self, when: u64, order: &Order) -> Result<(), OrderError> {
        let (components, is_stopped, by) = match order {
            Order::EmergencyStop { components, by } => (self.to_stop(components), true, by),
            Order::Release { components, by } => (self.to_release(components), false, by),
            _ => return Ok(()),
        };
        let components = components.map_err(OrderError::Component)?;
        let cause = self.record_outside(when, OUTSIDE_NAME, order.to_string());
        if self.memory.is_on() {
            self.want_cut(when);
        }
        if is_stopped {
            let begun = |index: &u32| self.slots[*index as usize].is_stopped();
            let new: Vec<u32> = components.iter().copied().filter(|index| !begun(index)).collect();
            self.stop_at_once(&new);
        }
        self.tell_stopped(&components, is_stopped, cause, when);
        self.log_stopped(&components, is_stopped, by.as_deref(), when);
        Ok(())
    }

    /// Has a component told that it is stopped, or released.
    pub(in crate::schedule) fn queue_stopped(&mut self, index: u32, is_stopped: bool, cause: Cause) {
        let component = self.slots[index as usize].name.to_string();
        let order = Order::Set { component, property: STOPPED.to_owned(), value: is_stopped.to_string() };
        let pending = PendingOrder { order, answering: None, part_of: Some(cause) };
        self.orders.waiting.push_back((index, Pending::Order(Box::new(pending))));
    }

    /// Has a component serve a call of another program, between two executions.
    pub(in crate::schedule) fn queue_call(&mut self, index: u32, call: RemoteCall) {
        self.orders.waiting.push_back((index, Pending::Call(Box::new(call))));
        self.look_at = 0;
        self.wake |= self.roles.asleep_until != 0;
    }

    /// The component of this path, which may have the name of a service behind it.
    fn provider<'o>(&self, path: &'o str) -> Result<(u32, Option<&'o str>), OrderError> {
        let member = |path: &str| {
            let number = self.numbers.get(path).copied();
            number.filter(|number| self.slots[*number as usize].is_member())
        };
        if let Some(number) = member(path) {
            return Ok((number, None));
        }
        let of_service = path.rsplit_once('/').and_then(|(owner, service)| Some((member(owner)?, Some(service))));
        of_service.ok_or_else(|| OrderError::Component(self.unknown(path)))
    }

    /// What the code of a component has to do for an order.
    fn work(&self, order: &Order, number: u32, service: Option<&str>) -> Result<Work, OrderError> {
        let spec = &self.slots[number as usize].spec;
        match order {
            Order::Set { component, property, value } => match service {
                None => change::changed(spec, property, value)
                    .map(|changed| Work::Set(Box::new(changed)))
                    .map_err(OrderError::Set),
                Some(_) => Err(OrderError::Component(self.unknown(component))),
            },
            Order::Call { operation, arguments, .. } => {
                JsonCall::new(spec, service, operation, arguments).map(Work::Call)
            }
            _ => Err(OrderError::Ending),
        }
    }

    /// Lets an order take effect.
    pub(in crate::schedule) fn carry_out(&mut self, when: u64, pending: PendingOrder) {
        let request = match &pending.order {
            Order::Start { component, lasting } => {
                (component, Request::Schedule { lasting: lasting.map_or(NEVER, nanos) })
            }
            Order::Stop { component } => (component, Request::Unschedule),
            Order::Set { component, .. } | Order::Call { component, .. } => {
                match self.provider(component) {
                    Ok((number, _)) => self.orders.waiting.push_back((number, Pending::Order(Box::new(pending)))),
                    Err(error) => self.answer(when, &pending.order, pending.answering, Err(error)),
                }
                return;
            }
            Order::EmergencyStop { .. } | Order::Release { .. } => {
                let result = self.carry_out_stop(when, &pending.order).map(|()| Value::Null);
                return self.answer(when, &pending.order, pending.answering, result);
            }
            Order::Publish { .. } => return,
        };
        if pending.is_cancelled() {
            return;
        }
        let answer = match self.periodic(request.0) {
            Ok(number) => {
                self.record_outside(when, OUTSIDE_NAME, pending.order.to_string());
                self.request(number, request.1, when);
                Ok(Value::Null)
            }
            Err(error) => Err(OrderError::Component(error)),
        };
        self.answer(when, &pending.order, pending.answering, answer);
    }

    /// Answers an order. A refusal that nobody waits for is logged.
    fn answer(&mut self, now: u64, order: &Order, answering: Option<Answering>, answer: Result<Value, OrderError>) {
        let untold = match answering {
            Some(answering) => answering.give(answer),
            None => answer.err(),
        };
        if let Some(error) = untold {
            let text = format!("the order `{order}` is refused: {error}");
            self.note(now, Occurrence::Note { level: Level::Warning, text });
        }
    }

    /// True if an order waits for this component, which runs on a worker thread.
    pub(in crate::schedule) fn has_order_for(&self, index: u32, now: u64) -> bool {
        self.has_orders()
            && self.slots[index as usize].carries_out()
            && self.orders.waiting.iter().any(|(waiting, pending)| *waiting == index && !pending.is_cancelled(now))
    }

    /// True if an order waits for a component.
    #[inline]
    pub(in crate::schedule) fn has_orders(&self) -> bool {
        !self.orders.waiting.is_empty()
    }

    /// The first component that can carry out an order now. Orders to components that do not run are refused.
    #[inline]
    pub(in crate::schedule) fn next_order(&mut self, now: u64) -> Option<u32> {
        if self.has_orders() { self.ready_order(now) } else { None }
    }

    #[cold]
    fn ready_order(&mut self, now: u64) -> Option<u32> {
        let mut place = 0;
        while let Some((index, pending)) = self.orders.waiting.get(place) {
            let (index, slot) = (*index, &self.slots[*index as usize]);
            let is_over = pending.is_cancelled(now);
            if !is_over && (slot.body.is_none() || slot.held || slot.queued) {
                place += 1;
                continue;
            }
            if slot.carries_out() && !is_over {
                return Some(index);
            }
            if let Some((_, pending)) = self.orders.waiting.remove(place) {
                if is_over {
                    // It was withdrawn, and whoever gave it knows that.
                    if let Pending::Call(call) = pending {
                        self.leave_unserved(&call);
                    }
                    continue;
                }
                let pending = match pending {
                    Pending::Order(pending) => *pending,
                    Pending::Call(call) => {
                        let provider = self.slots[index as usize].name.to_string();
                        self.reply_to(&call, Err(CallError::NotRunning { provider }));
                        continue;
                    }
                };
                if let (Some(_), Order::Set { property, value, .. }) = (pending.part_of, &pending.order) {
                    self.set_at_rest(index, property, value);
                    continue;
                }
                let refusal = not_running(&self.slots[index as usize].name, &pending.order);
                self.answer(now, &pending.order, pending.answering, Err(refusal));
            }
        }
        None
    }

    /// Gives a component's body the order that it carries out.
    pub(in crate::schedule) fn begin_order(&mut self, index: u32, body: &mut Body, now: u64) {
        let is_wanted = |(waiting, pending): &(u32, Pending)| *waiting == index && !pending.is_cancelled(now);
        let Some(place) = self.orders.waiting.iter().position(is_wanted) else { return };
        let Some((_, pending)) = self.orders.waiting.remove(place) else { return };
        let PendingOrder { order, answering, part_of } = match pending {
            Pending::Order(pending) => *pending,
            Pending::Call(call) => {
                let cause = self.cause_of(&call);
                body.part.order = Some(Box::new(InCode::Call(*call, cause)));
                return;
            }
        };
        let work = match &order {
            Order::Set { component, .. } | Order::Call { component, .. } => {
                self.provider(component).and_then(|(number, service)| self.work(&order, number, service))
            }
            _ => return,
        };
        match work {
            Ok(work) => {
                let cause = part_of.unwrap_or_else(|| self.record_outside(now, OUTSIDE_NAME, order.to_string()));
                let order = OrderInCode { order, answering, cause, work: Some(work), answer: None };
                body.part.order = Some(Box::new(InCode::Order(order)));
            }
            Err(error) => self.answer(now, &order, answering, Err(error)),
        }
    }

    /// Answers an order after the code of its component has returned, or has failed.
    pub(in crate::schedule) fn finish_order(
        &mut self,
        index: u32,
        body: &mut Body,
        failure: Option<&Failure>,
        now: u64,
    ) {
        let order = match body.part.order.take().map(|order| *order) {
            Some(InCode::Order(order)) => order,
            Some(InCode::Call(call, _)) => return self.finish_remote_call(index, call, failure),
            None => return,
        };
        let slot = &mut self.slots[index as usize];
        let answer = match (order.answer, failure) {
            (Some(answer), _) => answer,
            (None, Some(failure)) => Err(OrderError::Call(format!("component `{}` failed: {failure}", slot.name))),
            (None, None) => Ok(Value::Null),
        };
        let set = match (&order.order, &answer) {
            (Order::Set { property, value, .. }, Ok(_)) if property != STOPPED => {
                let (property, value) = (property.clone(), value.clone());
                Some(SetForm { instead_of: value_hash(&slot.spec, &property), property, value })
            }
            _ => None,
        };
        // It may have another value of a property.
        slot.spec = Arc::clone(&body.part.spec);
        if !body.part.lasting.saves_at_once {
            body.part.lasting.touch();
        }
        if let Some(set) = set {
            self.note_set(index, set, now);
        }
        let OrderInCode { order, answering, .. } = order;
        self.answer(now, &order, answering, answer);
    }
}

/// The error of an order to a component that does not run.
fn not_running(component: &str, order: &Order) -> OrderError {
    match order {
        Order::Set { .. } => {
            OrderError::Set(SetError::NotNow { component: component.to_owned(), why: "it does not run".to_owned() })
        }
        _ => OrderError::Call(format!("component `{component}` does not run")),
    }
}

impl Body {
    /// Carries out the order that it was given.
    ///
    /// # Errors
    /// The component panicked in a call.
    pub(in crate::schedule) fn carry_out(&mut self, shared: &Arc<Shared>) -> Result<(), Failure> {
        let mut order = match self.part.order.take().map(|order| *order) {
            Some(InCode::Order(order)) => order,
            Some(InCode::Call(mut call, cause)) => {
                let served = self.serve_remote(shared, &mut call, cause);
                self.part.order = Some(Box::new(InCode::Call(call, cause)));
                return served;
            }
            None => return Ok(()),
        };
        let answer = match order.work.take() {
            Some(Work::Set(changed)) => Ok(self.update(*changed).map_err(OrderError::Set)),
            Some(Work::Call(call)) => self.answer(shared, call, order.cause),
            None => Ok(Ok(Value::Null)),
        };
        let result = answer.map(|answer| order.answer = Some(answer));
        self.part.order = Some(Box::new(InCode::Order(order)));
        result
    }

    /// Gives the component new values of its properties.
    fn update(&mut self, changed: ComponentSpec) -> Result<Value, SetError> {
        let updated = match &mut self.instance {
            Some(instance) => contained(|| instance.update(&changed.values)).and_then(|updated| updated),
            None => Err(Failure::new("it has just ended")),
        };
        let refused = |failure| SetError::Refused { component: self.part.name.to_string(), failure };
        updated.map_err(refused)?;
        self.part.spec = Arc::new(changed);
        if self.part.lasting.saves_at_once {
            self.part.lasting.touch();
            // What it cannot save now, it saves after the next execution, or fails then.
            let _ = self.save_for_later();
        }
        Ok(Value::Null)
    }

    /// Answers a call. The outer error is a panic.
    fn answer(
        &mut self,
        shared: &Arc<Shared>,
        mut call: JsonCall,
        cause: Cause,
    ) -> Result<Result<Value, OrderError>, Failure> {
        let service = call.service.clone();
        let served = self.serve(shared, &mut Invocation { service: &service, call: &mut call }, cause)?;
        Ok(served.map(|()| call.into_reply()).map_err(|error| OrderError::Call(error.to_string())))
    }
}
