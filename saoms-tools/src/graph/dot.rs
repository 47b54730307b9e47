//! Diagrams for Graphviz.

use std::fmt::Write as _;

use saoms_api::host::one_line;

use super::diagram::{Diagram, DiagramComponent, DiagramEnd, LinkKind, Port, State};
use super::picture::{Picture, Sink};
use super::text::left_out;

/// Draws a diagram in the language of Graphviz: components are records with services on the left and references on the
/// right, topics ellipses, composites clusters.
pub fn dot(diagram: &Diagram) -> Picture<'_> {
    Picture { diagram, draw }
}

fn draw(diagram: &Diagram, out: &mut Sink<'_>) {
    let _ = writeln!(out, "digraph {} {{\n  rankdir=LR;", quoted(&diagram.name));
    out.push_str("  node [fontname=\"Helvetica\", fontsize=11];\n  edge [fontname=\"Helvetica\", fontsize=9];\n");
    open("composite", &diagram.name, out);
    composite(diagram, "", out);
    if let Some(note) = left_out(diagram) {
        let _ = writeln!(out, "  // {note}");
    }
    out.push_str("}\n");
}

/// Starts the cluster `id`.
fn open(id: &str, label: &str, out: &mut Sink<'_>) {
    let _ = writeln!(out, "  subgraph cluster_{id} {{\n    label={};", quoted(label));
    out.push_str("    style=rounded; color=\"#46617e\"; fontname=\"Helvetica\";\n");
}

/// Draws a composite in the cluster that is open, and ends that; the names of all nodes in it start with `prefix`.
fn composite(diagram: &Diagram, prefix: &str, out: &mut Sink<'_>) {
    for (place, component) in diagram.components.iter().enumerate() {
        let style = match component.state {
            State::Known => "style=\"rounded,filled\", fillcolor=\"#d8e6f5\", color=\"#46617e\"",
            State::NotFound => "style=\"rounded,filled,dashed\", fillcolor=\"#d8e6f5\", color=\"#c0392b\"",
            State::Missing => "style=\"rounded,dashed\", color=\"#c0392b\"",
        };
        let label = record(component);
        let id = format!("{prefix}c{place}");
        let node = format!("    {id} [shape=record, {style}, label=\"{label}\"];\n");
        let Some(inside) = &component.inside else {
            out.push_str(&node);
            continue;
        };
        let about = [component.label(), component.class.clone()];
        open(&id, about.join(" ").trim_end(), out);
        // Wires lead to what the composite inside promotes; for the rest there is a node.
        if component.services.iter().chain(&component.references).any(|port| port.inside.is_none()) {
            out.push_str(&node);
        }
        composite(inside, &format!("{id}_"), out);
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        let (name, tooltip) =
            (quoted(&topic.name), quoted(&format!("{} topic of {}", topic.kind.name(), topic.message)));
        let _ = writeln!(out, "    {prefix}t{place} [shape=ellipse, label={name}, tooltip={tooltip}];");
    }
    let is_inside = !prefix.is_empty();
    if !is_inside {
        out.push_str("  }\n");
    }
    let ports = [("s", &diagram.services, "#86c067"), ("r", &diagram.references, "#b59ad6")];
    for (id, ports, color) in ports {
        for (place, port) in ports.iter().enumerate() {
            let name = quoted(&port.name);
            let _ =
                writeln!(out, "  {prefix}{id}{place} [shape=cds, style=filled, fillcolor=\"{color}\", label={name}];");
        }
    }
    if is_inside {
        out.push_str("  }\n");
    }
    edges(diagram, prefix, out);
}

fn edges(diagram: &Diagram, prefix: &str, out: &mut Sink<'_>) {
    for link in &diagram.links {
        let from = match link.from {
            DiagramEnd::Component { component, port } => match diagram.components[component].references[port].inside {
                Some(place) => format!("{prefix}c{component}_r{place}"),
                None => format!("{prefix}c{component}:r{port}:e"),
            },
            DiagramEnd::Composite(place) => format!("{prefix}s{place}"),
        };
        let to = match link.to {
            DiagramEnd::Component { component, port } => match diagram.components[component].services[port].inside {
                Some(place) => format!("{prefix}c{component}_s{place}"),
                None => format!("{prefix}c{component}:s{port}:w"),
            },
            DiagramEnd::Composite(place) => format!("{prefix}r{place}"),
        };
        let style = if link.kind == LinkKind::Promotion { " [style=dashed]" } else { "" };
        let _ = writeln!(out, "  {from} -> {to}{style};");
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        for component in &topic.publishers {
            let both = if topic.subscribers.binary_search(component).is_ok() { ", dir=both" } else { "" };
            let _ = writeln!(out, "  {prefix}c{component} -> {prefix}t{place} [style=dotted{both}];");
        }
        for component in &topic.subscribers {
            if topic.publishers.binary_search(component).is_err() {
                let _ = writeln!(out, "  {prefix}t{place} -> {prefix}c{component} [style=dotted];");
            }
        }
    }
}

fn record(component: &DiagramComponent) -> String {
    let column = |id: &str, ports: &[Port]| {
        let fields = ports.iter().enumerate().map(|(place, port)| format!("<{id}{place}> {}", field(&port.name)));
        fields.collect::<Vec<_>>().join("|")
    };
    let mut middle = field(&component.label());
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
    for one in one_line(text).chars() {
        match one {
            '"' | '\\' | '{' | '}' | '|' | '<' | '>' => out.extend(['\\', one]),
            _ => out.push(one),
        }
    }
    out
}

fn quoted(text: &str) -> String {
    let text = one_line(text);
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
