//! Diagrams for Mermaid, as Markdown viewers draw them.

use std::fmt::Write as _;

use saoms_api::host::one_line;

use super::diagram::{Diagram, DiagramEnd, LinkKind, State};
use super::picture::{Picture, Sink};
use super::text::left_out;

/// Draws a diagram as a flowchart of Mermaid.
pub fn mermaid(diagram: &Diagram) -> Picture<'_> {
    Picture { diagram, draw }
}

fn draw(diagram: &Diagram, out: &mut Sink<'_>) {
    out.push_str("flowchart LR\n");
    composite(diagram, "", "composite", &escaped(&diagram.name), out);
    if let Some(note) = left_out(diagram) {
        let _ = writeln!(out, "  %% {note}");
    }
    out.push_str("  classDef component fill:#d8e6f5,stroke:#46617e\n");
    out.push_str("  classDef unknown fill:#d8e6f5,stroke:#c0392b,stroke-dasharray:5 3\n");
    out.push_str("  classDef missing fill:#fff,stroke:#c0392b,stroke-dasharray:5 3\n");
    out.push_str("  classDef service fill:#86c067,stroke:#3d7a22\n");
    out.push_str("  classDef reference fill:#b59ad6,stroke:#62399a\n");
}

/// Draws a composite as the group `id`; the names of all nodes in it start with `prefix`.
fn composite(diagram: &Diagram, prefix: &str, id: &str, label: &str, out: &mut Sink<'_>) {
    let _ = writeln!(out, "  subgraph {id} [\"{}\"]", if label.is_empty() { "?" } else { label });
    for (place, component) in diagram.components.iter().enumerate() {
        let mut label = escaped(&component.label());
        if !component.class.is_empty() {
            label.push_str(&format!("<br/>{}", escaped(&component.class)));
        }
        let class = match component.state {
            State::Known => "component",
            State::NotFound => "unknown",
            State::Missing => "missing",
        };
        let id = format!("{prefix}c{place}");
        match &component.inside {
            Some(inside) => composite(inside, &format!("{id}_"), &id, &label, out),
            None => _ = writeln!(out, "    {id}(\"{label}\"):::{class}"),
        }
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        let _ = writeln!(out, "    {prefix}t{place}([{}])", quoted(&topic.name));
    }
    // Inside another composite they stand with the others: a group has no border to put them on.
    let is_inside = !prefix.is_empty();
    if !is_inside {
        out.push_str("  end\n");
    }
    for (id, class, ports) in [("s", "service", &diagram.services), ("r", "reference", &diagram.references)] {
        for (place, port) in ports.iter().enumerate() {
            let _ = writeln!(out, "  {prefix}{id}{place}>{}]:::{class}", quoted(&port.name));
        }
    }
    if is_inside {
        out.push_str("  end\n");
    }
    edges(diagram, prefix, out);
}

fn edges(diagram: &Diagram, prefix: &str, out: &mut Sink<'_>) {
    for link in &diagram.links {
        let (from, source) = match link.from {
            DiagramEnd::Component { component, port } => {
                let port = &diagram.components[component].references[port];
                let inside = port.inside.map_or(String::new(), |place| format!("_r{place}"));
                (format!("c{component}{inside}"), &*port.name)
            }
            DiagramEnd::Composite(place) => (format!("s{place}"), ""),
        };
        let (to, target) = match link.to {
            DiagramEnd::Component { component, port } => {
                let port = &diagram.components[component].services[port];
                let inside = port.inside.map_or(String::new(), |place| format!("_s{place}"));
                (format!("c{component}{inside}"), &*port.name)
            }
            DiagramEnd::Composite(place) => (format!("r{place}"), ""),
        };
        let arrow = match link.kind {
            LinkKind::Wire => "-->",
            LinkKind::Promotion => "-.->",
        };
        let names: Vec<&str> = [source, target].into_iter().filter(|name| !name.is_empty()).collect();
        let label = if names.is_empty() { String::new() } else { format!("|{}|", quoted(&names.join(" → "))) };
        let _ = writeln!(out, "  {prefix}{from} {arrow}{label} {prefix}{to}");
    }
    for (place, topic) in diagram.topics.iter().enumerate() {
        for component in &topic.publishers {
            let both = topic.subscribers.binary_search(component).is_ok();
            let arrow = if both { "<-.->" } else { "-.->" };
            let _ = writeln!(out, "  {prefix}c{component} {arrow} {prefix}t{place}");
        }
        for component in &topic.subscribers {
            if topic.publishers.binary_search(component).is_err() {
                let _ = writeln!(out, "  {prefix}t{place} -.-> {prefix}c{component}");
            }
        }
    }
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", if text.is_empty() { "?".to_owned() } else { escaped(text) })
}

/// A text inside quotes: what Mermaid or HTML would take for something else by its number.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for one in one_line(text).chars() {
        match one {
            '"' | '#' | '&' | '<' | '>' | '`' | ';' | '|' | '\\' => {
                let _ = write!(out, "#{};", u32::from(one));
            }
            _ => out.push(one),
        }
    }
    out
}
