use saoms_api::Time;

use super::{Faults, MessageFault, MessageFaultKind, TaskFault, TaskFaultKind};

#[test]
fn messages_are_affected_on_their_topic_and_in_their_time() {
    let (from, until) = (Time::from_nanos(10), Time::from_nanos(20));
    let fault = MessageFault { topic: "TALK".to_owned(), from, until, kind: MessageFaultKind::Lost };
    let duplicated = MessageFault { kind: MessageFaultKind::Duplicated, ..fault.clone() };
    let faults = Faults { messages: vec![fault, duplicated], ..Faults::default() };
    let found = [9, 10, 19, 20].map(|time| faults.of_message("TALK", Time::from_nanos(time)));
    assert_eq!(found, [None, Some(MessageFaultKind::Lost), Some(MessageFaultKind::Lost), None]);
    assert_eq!(faults.of_message("TABLE", from), None);
}

#[test]
fn each_fault_of_a_component_comes_once() {
    let fault = |at, kind| TaskFault { component: "A".to_owned(), at: Time::from_nanos(at), kind };
    let tasks = vec![fault(10, TaskFaultKind::Fails), fault(10, TaskFaultKind::Panics)];
    let mut faults = Faults { tasks, ..Faults::default() };
    let mut found = |component, time| faults.take_of_execution(component, Time::from_nanos(time));
    assert_eq!(found("A", 9), None);
    assert_eq!(found("B", 10), None);
    assert_eq!(found("A", 12), Some(TaskFaultKind::Fails));
    assert_eq!(found("A", 12), Some(TaskFaultKind::Panics));
    assert_eq!(found("A", 12), None);
    assert!(faults.is_empty());
}
