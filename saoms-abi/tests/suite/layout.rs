//! The layout of the boundary to plugins, as libraries that were built before expect it, is written down in
//! `docs/abi.txt`.

use std::any::type_name;
use std::fmt::Write as _;
use std::mem::{align_of, offset_of, size_of};
use std::path::Path;
use std::{env, fs};

use saoms_abi::*;

/// The type of a field, without the modules that its names are in.
fn type_of<S, T>(_: fn(&S) -> &T) -> String {
    short(type_name::<T>())
}

fn short(name: &str) -> String {
    let mut text = String::new();
    let mut word = String::new();
    for c in name.chars() {
        match c {
            'a'..='z' | 'A'..='Z' | '0'..='9' | '_' => word.push(c),
            // What comes before is a module, unless a name of an argument does.
            ':' => word.clear(),
            _ => {
                text.push_str(&word);
                word.clear();
                text.push(c);
            }
        }
    }
    text + &word
}

macro_rules! layout {
    ($text:ident, $($table:ident { $($field:ident),* $(,)? })*) => {$(
        // Does not compile when there is a field that the list does not have.
        let _ = |table: $table| { let $table { $($field: _),* } = table; };
        let (size, align) = (size_of::<$table>(), align_of::<$table>());
        let _ = writeln!($text, "\n{}: {size} bytes, aligned to {align}", stringify!($table));
        $(
            let of = type_of(|table: &$table| &table.$field);
            let _ = writeln!($text, "{:6} {}: {of}", offset_of!($table, $field), stringify!($field));
        )*
    )*};
}

fn layout() -> String {
    let mut text = format!(
        "The boundary to plugins, version {VERSION}, on machines with 64 bits: each structure with the offsets and types of its members.\n\
         Written by `cargo test -p saoms-abi --test suite layout`; what to do when it changes is in docs/versions.md.\n"
    );
    layout! { text,
        Bytes { data, length }
        Sink { state, put }
        PropertyView { name, kind, text, children, child_count }
        MessageView { bytes, sent, cause, key, sender, has_key }
        Inbox { messages, count }
        ValueView { kind, bits, word }
        RecordView { id, text, names, values, count }
        HostHandle { state, functions, inboxes, inbox_count }
        TopicView { name, message, schema, kind }
        HostFunctions { size, name, sender, name_of, now, date, due, execution, period, cancelled, chance, next_random, publish, subscribe, send, reference, is_wired, targets, call, listens, log, report, count, vote, chosen_loops, chosen_loop, name_loop, enter_loop, because, cause, journal, changed, register_stop, keep, kept, set_region, departed, goes_on, raise, alert, publishers, speaker }
        EntriesHandle { state, functions }
        EntryView { name, of, effector }
        EntriesFunctions { size, declaration, count, describe, get, set, get_bytes, set_bytes, destroy }
        PlaceView { component, property, has_part, value, start, end }
        LabelView { place, text }
        FindingView { place, message, helps, help_count, instead, labels, label_count, severity }
        FindingSink { state, put }
        ReportView { name, kind, bits, text, children, child_count }
        ComponentTable { size, initialize, execute, shutdown, serve, destroy, save, restore, waits_for, react, update, status }
        LoopClassTable { size, construct, looping }
        LoopTable { size, effect, entries, initialize, monitor, adapt, shutdown, destroy }
        LoopInstance { instance, table }
        ClassTable { size, construct, component }
        ImplementationTable { size, declare, construct, component }
        PluginTable { size, version, metadata, classes, class_count, loops, loop_count, rules, rule_count, implementations }
        RegionView { least, most }
        DepartedView { key, sender }
        StopView { size, state, stop, heartbeat, release }
        TransportTable { size, version, metadata, open, judge, put, subscribe, unsubscribe, close }
        TransportEvents { size, state, deliver, link }
        TopicTransportTable { size, version, metadata, open, judge, advertise, publish, subscribe, close }
        RuleTable { size, state, check }
        FleetList { components, component_count, missing, missing_count }
        TextList { texts, count }
        MemberView { path, class_name, declaration, extends, values, value_count, period, has_broker, publishes, loops, wires, wire_count, renamed, renamed_count, starts }
        RenamedView { declared, on_bus }
        WireView { reference, target }
    }
    let functions = [
        ("Entry", type_name::<EntryPoint>()),
        ("Construct", type_name::<Construct>()),
        ("TransportEntry", type_name::<TransportEntry>()),
        ("TopicTransportEntry", type_name::<TopicTransportEntry>()),
        ("LoopVisitor", type_name::<LoopVisitor>()),
        ("PublisherVisitor", type_name::<PublisherVisitor>()),
    ];
    let _ = writeln!(text, "\nStatus: {} bytes", size_of::<Status>());
    for (name, of) in functions {
        let _ = writeln!(text, "{name}: {}", short(of));
    }
    let _ = writeln!(text, "SECTION: {SECTION}\nTRANSPORT_SECTION: {TRANSPORT_SECTION}\nMAX_BYTES: {MAX_BYTES}");
    text
}

#[test]
fn the_layout_is_the_one_that_is_written_down() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/abi.txt");
    let (now, before) = (layout(), fs::read_to_string(&path).unwrap_or_default());
    if env::var_os("UPDATE_EXPECT").is_some() {
        fs::write(path, now).unwrap();
        return;
    }
    if now == before {
        return;
    }
    let mut changes = String::new();
    for line in before.lines().filter(|line| !now.contains(line)) {
        let _ = writeln!(changes, "- {line}");
    }
    for line in now.lines().filter(|line| !before.contains(line)) {
        let _ = writeln!(changes, "+ {line}");
    }
    panic!(
        "the boundary to plugins is not the one in docs/abi.txt:\n{changes}\n\
         Members that are new at the end of a table of functions, and may be null or are asked for by their size, break no library.\n\
         Anything else does: raise `saoms_abi::VERSION` and `\"abi\"` in `plugin!`, unless that version was never released.\n\
         Then write the file anew: UPDATE_EXPECT=1 cargo test -p saoms-abi --test suite layout"
    );
}
