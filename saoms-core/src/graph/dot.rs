//! Diagrams for Graphviz.

use std::fmt::Write as _;

use super::diagram::{Component, Diagram, End, LinkKind, Port, State};

/// Draws a diagram in the language of Graphviz: components are records with services on the left and references on the
/// right, topics ellipses.
pub fn dot(diagram: &Diagram) -> String {
    let mut out = format!("digraph {} {{\n  rankdir=LR;\n", quoted(&diagram.name));
    out.push_str(
        "  node [fontname=\"Helvetica\", fontsize=11];\n  edge [fontname=\"Helvetica\", fontsize=9];\n",
    );
    let _ = writeln!(out, "  subgraph cluster_composite {{\n    label={};", quoted(&diagram.name));
    out.push_str("    style=rounded; color=\"#46617e\"; fontname=\"Helvetica\";\n");
    for (place, component) in diagram.components.iter().enumerate() {
        let style = match component.state {
            State::Known => "style=\"rounded,filled\", fillcolor=\"#d8e6f5\", color=\"#46617e\"",
            State::UnknownClass => {
                "style=\"rounded,filled,dashed\", fillcolor=\"#d8e6f5\", color=\"#c0392b\""
            }
            State::Missing => "style=\"rounded,dashed\", color=\"#c0392b\"",
        };
        let label = record(component);
        let _ = writeln!(out, "    c{place} [shape=record, {style}, label=\"{label}\"];");
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        let tooltip = quoted(&format!("{} topic of {}", topic.kind.name(), topic.message));
        let _ =
            writeln!(out, "    t{place} [shape=ellipse, label={}, tooltip={tooltip}];", quoted(&topic.name));
    }
    out.push_str("  }\n");
    let ports = [("s", &diagram.services, "#86c067"), ("r", &diagram.references, "#b59ad6")];
    for (id, ports, color) in ports {
        for (place, port) in ports.iter().enumerate() {
            let name = quoted(&port.name);
            let _ = writeln!(
                out,
                "  {id}{place} [shape=cds, style=filled, fillcolor=\"{color}\", label={name}];"
            );
        }
    }
    for link in &diagram.links {
        let from = match link.from {
            End::Component { component, port } => format!("c{component}:r{port}:e"),
            End::Composite(place) => format!("s{place}"),
        };
        let to = match link.to {
            End::Component { component, port } => format!("c{component}:s{port}:w"),
            End::Composite(place) => format!("r{place}"),
        };
        let style = if link.kind == LinkKind::Promotion { " [style=dashed]" } else { "" };
        let _ = writeln!(out, "  {from} -> {to}{style};");
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        for component in &topic.publishers {
            let both = if topic.subscribers.binary_search(component).is_ok() { ", dir=both" } else { "" };
            let _ = writeln!(out, "  c{component} -> t{place} [style=dotted{both}];");
        }
        for component in
            topic.subscribers.iter().filter(|reader| topic.publishers.binary_search(reader).is_err())
        {
            let _ = writeln!(out, "  t{place} -> c{component} [style=dotted];");
        }
    }
    out.push_str("}\n");
    out
}

fn record(component: &Component) -> String {
    let column = |id: &str, ports: &[Port]| {
        let fields =
            ports.iter().enumerate().map(|(place, port)| format!("<{id}{place}> {}", field(&port.name)));
        fields.collect::<Vec<_>>().join("|")
    };
    let mut middle = field(&component.name);
    if !component.class.is_empty() {
        middle.push_str(&format!("\\n{}", field(&component.class)));
    }
    let mut columns = vec![middle];
    if !component.services.is_empty() {
        columns.insert(0, format!("{{{}}}", column("s", &component.services)));
    }
    if !component.references.is_empty() {
        columns.push(format!("{{{}}}", column("r", &component.references)));
    }
    columns.join("|")
}

/// A text in a field of a record.
fn field(text: &str) -> String {
    let mut out = String::new();
    for one in text.chars() {
        match one {
            '"' | '\\' | '{' | '}' | '|' | '<' | '>' => out.extend(['\\', one]),
            _ if one.is_control() => out.push(' '),
            _ => out.push(one),
        }
    }
    out
}

fn quoted(text: &str) -> String {
    let text: String = text.chars().map(|one| if one.is_control() { ' ' } else { one }).collect();
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
