//! The way of an order: it is checked when it comes, waits for its instant, and takes effect before the executions that
//! are due then.

use std::sync::Arc;

use saoms_api::host::Invocation;
use saoms_api::{CallError, Cause, Failure, Level, Time};
use saoms_lang::assembly::ComponentSpec;
use serde_json::Value;

use super::call::JsonCall;
use super::pending::{InCode, OrderInCode, Pending, PendingOrder, Work};
use super::remote::RemoteCall;
use super::ticket::{Answering, OrderTicket, ticket};
use super::{Order, OrderError};
use crate::observe::Occurrence;
use crate::schedule::change::{self, LEAVING, SetError};
use crate::schedule::component::body::Body;
use crate::schedule::engine::Engine;
use crate::schedule::engine::lifecycle::Request;
use crate::schedule::engine::memory::{SetForm, value_hash};
use crate::schedule::engine::slot::NEVER;
use crate::schedule::inject::{self, InjectedContent, Injection, OUTSIDE_NAME};
use crate::schedule::settings::nanos;
use crate::schedule::shared::Shared;
use crate::schedule::stop::STOPPED;

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
    if engine.is_closed() {
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
    engine.add_order(shared.clock.now(), at, PendingOrder { order, answering, part_of: None });
    shared.release(engine);
    Ok(ticket)
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

    /// Has a component told of itself by a live property: that it is stopped, or is to leave, or that this is over.
    pub(in crate::schedule) fn queue_told(&mut self, index: u32, property: &str, value: bool, cause: Cause) {
        let component = self.slots[index as usize].name.to_string();
        let order = Order::Set { component, property: property.to_owned(), value: value.to_string() };
        let pending = PendingOrder { order, answering: None, part_of: Some(cause) };
        self.orders.waiting.push_back((index, Pending::Order(Box::new(pending))));
    }

    /// Has a component serve a call of another program, between two executions.
    pub(in crate::schedule) fn queue_call(&mut self, index: u32, call: RemoteCall) {
        self.orders.waiting.push_back((index, Pending::Call(Box::new(call))));
        self.look_at = 0;
        self.wake |= self.roles.asleep_until != 0;
    }

    /// Has a component take the values of an earlier specification back, before its next execution.
    pub(in crate::schedule) fn queue_take_back(&mut self, index: u32, before: Arc<ComponentSpec>) {
        self.orders.waiting.push_front((index, Pending::TakeBack(before)));
        self.look_at = 0;
        self.wake |= self.roles.asleep_until != 0;
    }

    /// Forgets that a component has to take values back: another change has given it others.
    pub(in crate::schedule) fn forget_take_back(&mut self, index: u32) {
        let is_over = |pending: &Pending| matches!(pending, Pending::TakeBack(_));
        self.orders.waiting.retain(|(waiting, pending)| *waiting != index || !is_over(pending));
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
        let slot = &self.slots[number as usize];
        let spec = &slot.spec;
        match order {
            Order::Set { component, property, value } => match service {
                None => {
                    let changed = change::changed(spec, property, value).map_err(OrderError::Set)?;
                    match slot.ends_emergency_stop(property, &changed) {
                        Some(why) => Err(OrderError::Set(SetError::NotNow { component: component.clone(), why })),
                        None => Ok(Work::Set(Box::new(changed))),
                    }
                }
                Some(_) => Err(OrderError::Component(self.unknown(component))),
            },
            Order::Call { operation, arguments, .. } => {
                JsonCall::new(spec, service, operation, arguments).map(|call| Work::Call(Box::new(call)))
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
        // One that was withdrawn has no effect, and one that has an effect is not withdrawn.
        if pending.answering.as_ref().is_some_and(|answering| !answering.begin()) {
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

    /// Answers the orders that wait for components when the run ends: none of them begins any more.
    pub(in crate::schedule) fn end_orders(&mut self) {
        self.orders.waiting.retain_mut(|(_, pending)| {
            let Pending::Order(pending) = pending else { return true };
            let Some(answering) = pending.answering.take() else { return true };
            // Whoever gave it may have withdrawn it, or gone.
            let _ = answering.give(Err(OrderError::Ending));
            false
        });
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
                    Pending::TakeBack(_) => {
                        // Its next instance has them.
                        let slot = &mut self.slots[index as usize];
                        if let Some(body) = &mut slot.body {
                            body.part.spec = Arc::clone(&slot.spec);
                        }
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
            Pending::TakeBack(before) => {
                body.part.order = Some(Box::new(InCode::TakeBack(before, None)));
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
            // It was withdrawn this moment.
            Ok(_) if answering.as_ref().is_some_and(|answering| !answering.begin()) => {}
            Ok(work) => {
                let is_told = part_of.is_some();
                let cause = part_of.unwrap_or_else(|| self.record_outside(now, OUTSIDE_NAME, order.to_string()));
                let order = OrderInCode { order, answering, is_told, cause, work: Some(work), answer: None };
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
            Some(InCode::TakeBack(_, refusal)) => return self.note_taken_back(&body.part, refusal, now),
            None => return,
        };
        let slot = &mut self.slots[index as usize];
        let answer = match (order.answer, failure) {
            (Some(answer), _) => answer,
            (None, Some(failure)) => Err(OrderError::Call(format!("component `{}` failed: {failure}", slot.name))),
            (None, None) => Ok(Value::Null),
        };
        let set = match (&order.order, &answer) {
            (Order::Set { property, value, .. }, answer) if property == LEAVING && order.is_told => {
                slot.leaving.answer(value, answer.as_ref().err());
                None
            }
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
            self.slots[index as usize].is_wanted = None;
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
        _ => OrderError::NotRunning(format!("component `{component}` does not run")),
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
            Some(InCode::TakeBack(before, _)) => {
                let refusal = self.take_back(shared, Arc::clone(&before)).err();
                self.part.order = Some(Box::new(InCode::TakeBack(before, refusal)));
                return Ok(());
            }
            None => return Ok(()),
        };
        let answer = match order.work.take() {
            Some(Work::Set(changed)) => Ok(self.update(shared, *changed).map_err(OrderError::Set)),
            Some(Work::Call(call)) => self.answer(shared, *call, order.cause),
            None => Ok(Ok(Value::Null)),
        };
        let result = answer.map(|answer| order.answer = Some(answer));
        self.part.order = Some(Box::new(InCode::Order(order)));
        result
    }

    /// Gives the component new values of its properties.
    fn update(&mut self, shared: &Shared, changed: ComponentSpec) -> Result<Value, SetError> {
        let taken = self.take_values(shared, Arc::new(changed));
        taken.map_err(|failure| SetError::Refused { component: self.part.name.to_string(), failure })?;
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
        Ok(served.map(|()| call.into_reply()).map_err(|error| match error {
            CallError::Busy { .. } => OrderError::Busy(error.to_string()),
            error => OrderError::Call(error.to_string()),
        }))
    }
}
